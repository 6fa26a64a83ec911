#include "groundscale/road/ground_methods.hpp"

#include <algorithm>
#include <iterator>
#include <vector>

#include "groundscale/road/dense.hpp"
#include "groundscale/road/fused.hpp"

namespace groundscale {

std::span<const PlaneMethod> ground_methods() {
  static const std::vector<PlaneMethod> kMethods = [] {
    const std::span<const PlaneMethod> of_points = plane_methods();
    std::vector<PlaneMethod> methods(of_points.begin(), of_points.end());
    methods.push_back({"dense", "alignment of the road's pixels, motion given (Song, Chandraker 2014)",
                       make_memoryless<estimate_plane_dense>});
    methods.push_back({"joint_dense", "the same with the motion free too (Zhou, Dai, Li 2019, eq. 5)",
                       make_memoryless<estimate_plane_joint_dense>});
    methods.push_back({"fixed_plane", "motion from the road's pixels, pitch, roll and height given (Lovegrove 2011)",
                       make_memoryless<estimate_fixed_plane>, true});
    methods.push_back({"fused", "several methods, weighted by what each knows by itself", make_fused});
    return methods;
  }();
  return kMethods;
}

const PlaneMethod* find_ground_method(std::string_view name) {
  const std::span<const PlaneMethod> methods = ground_methods();
  const auto found =
      std::find_if(methods.begin(), methods.end(), [name](const PlaneMethod& method) { return method.name == name; });
  return found == methods.end() ? nullptr : &*found;
}

std::string ground_method_names() {
  std::string names;
  for (const PlaneMethod& method : ground_methods()) names += (names.empty() ? "" : ", ") + std::string(method.name);
  return names;
}

}  // namespace groundscale
