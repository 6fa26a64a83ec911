#pragma once

#include <memory>

#include "groundscale/scale/ground_filter.hpp"

namespace groundscale {

std::unique_ptr<GroundFilter> make_model_filter(const GroundFilterOptions& options);
std::unique_ptr<GroundFilter> make_paper_filter(const GroundFilterOptions& options, double camera_height_m);

}  // namespace groundscale
