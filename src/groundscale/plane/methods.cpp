#include "groundscale/plane/methods.hpp"

#include <array>

namespace groundscale {

template <>
std::vector<std::string_view> names_of<PlaneRefinement>() {
  return {"levenberg_marquardt", "nelder_mead"};
}

template <>
std::vector<std::string_view> names_of<PlaneStart>() {
  return {"homography", "predicted"};
}

std::span<const PlaneMethod> plane_methods() {
  static constexpr std::array kMethods{
      PlaneMethod{"sparse", "symmetric homography transfer error of sparse matches (Zhou, Dai, Li 2019)",
                  make_memoryless<estimate_plane_sparse>},
      PlaneMethod{"triangulation", "height that most triangulated points have, normal given (Geiger et al. 2011)",
                  make_memoryless<estimate_plane_triangulation>, true},
      PlaneMethod{"triangulation_ransac", "plane through triangulated points by RANSAC (Graeter et al. 2015)",
                  make_memoryless<estimate_plane_triangulation_ransac>},
      PlaneMethod{"decomposition", "homography decomposed into R, t and plane (Malis, Vargas 2007)",
                  make_memoryless<estimate_plane_decomposition>, true},
      PlaneMethod{"joint", "R, t and plane together by the transfer error (Zhou, Dai, Li 2019, eq. 5)",
                  make_memoryless<estimate_plane_joint>},
      PlaneMethod{"delaunay", "low flat triangles of the image's points, mode over frames (Wang et al. 2018)",
                  make_delaunay_method, true},
  };
  return kMethods;
}

void visit_fields(PlaneOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "max_epipolar_px",
                 .unit = "px",
                 .help = "road matches must agree with R and t this well",
                 .min = 0.05,
                 .max = 20},
                options.max_epipolar_px);
  visitor.field({.key = "max_error_px",
                 .unit = "px",
                 .help = "symmetric transfer error of a match on the plane, each way",
                 .min = 0.05,
                 .max = 20},
                options.max_error_px);
  visitor.field({.key = "huber_px", .unit = "px", .help = "bound r0 of the Huber loss", .min = 0.01, .max = 20},
                options.huber_px);
  visitor.field({.key = "normal_prior_deg",
                 .unit = "deg",
                 .help = "sd of the plane's normal about the mean of the drive, 0: free",
                 .min = 0,
                 .max = 45},
                options.normal_prior_deg);
  visitor.field({.key = "direction_prior_deg",
                 .unit = "deg",
                 .help = "sd of the angle between the plane and the direction of motion, 0: not used",
                 .min = 0,
                 .max = 45},
                options.direction_prior_deg);
  visitor.field({.key = "point_sd_px",
                 .unit = "px",
                 .help = "what a road point is worth against these priors, since roads aren't planes",
                 .min = 0.01,
                 .max = 20},
                options.point_sd_px);
  visitor.field({.key = "min_inliers",
                 .unit = "",
                 .help = "fewer road matches on the plane refuse the measurement",
                 .min = 4,
                 .max = 10000},
                options.min_inliers);
  visitor.field({.key = "refinement", .unit = "", .help = "how the plane is refined"}, options.refinement);
  visitor.field({.key = "start",
                 .unit = "",
                 .help = "of sparse: the plane of the homography, or the predicted one where there is one"},
                options.start);
  visitor.group("ransac", options.ransac);
  visitor.group("triangulation", options.triangulation);
  visitor.group("triangulation_ransac", options.triangulation_ransac);
  visitor.group("decomposition", options.decomposition);
  visitor.group("delaunay", options.delaunay);
  visitor.group("dense", options.dense);
  visitor.group("fixed_plane", options.fixed_plane);
  visitor.group("fused", options.fused);
}

}  // namespace groundscale
