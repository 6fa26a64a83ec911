#pragma once

#include <memory>

#include "groundscale/io/sequence.hpp"

namespace groundscale::internal {

/// The same sequence, read by a thread of its own that stays a few frames ahead. Frames, their order and the warnings
/// at each of them are the same. The thread ends with the object.
std::unique_ptr<Sequence> decode_ahead(std::unique_ptr<Sequence> sequence);

}  // namespace groundscale::internal
