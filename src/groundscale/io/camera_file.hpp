#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/camera/mounting.hpp"
#include "groundscale/camera/parameters.hpp"
#include "groundscale/core/image.hpp"
#include "groundscale/core/result.hpp"

namespace groundscale {

/// A camera higher than this is likely one whose height was not given in metres: worth a warning, but no error.
inline constexpr double kUnlikelyHeightM = 20.0;

/// A camera and how it sits on the vehicle, as a camera file says. What the file leaves out is empty.
struct CameraSetup {
  CameraPtr camera;
  std::optional<double> height_m;     ///< Above the road, perpendicular to it.
  std::optional<double> height_sd_m;  ///< How well it is known.
  std::optional<double> pitch_rad;    ///< Empty: the program finds it in the first seconds.
  std::optional<double> roll_rad;
  std::optional<double> yaw_rad;
  /// How well numbers of the camera are known, each in its own unit, above 0; those that aren't there are as given.
  std::map<CameraParameter, double> parameter_sds;
  Image vehicle_mask;  ///< 255 where the own vehicle is in view; empty where it isn't.
};

/// Reads `camera.yaml` (docs/formats.md). Image size may be missing in the file and is then taken from `image_*`; where
/// both are there they must agree. `image_*` of 0: not known, the file must say it. A file that
/// begins with a number is OCamCalib's `calib_results.txt`: model `ocam`, height and angles empty.
/// @return kBadInput with file, line, key and bound.
Result<CameraSetup> read_camera_file(const std::string& path, int image_width, int image_height);

/// Pinhole of row P<image> of KITTI's `calib.txt`: fx, fy, cx, cy of the 3x4 matrix; its last column, the place of the
/// camera beside camera 0, is of no use here. Height and angles stay empty.
/// @return kBadInput with file, line and value; also where the principal point lies outside the image, which is a
///         calibration of other images.
Result<CameraSetup> read_kitti_calibration(const std::string& path, int image, int image_width, int image_height);

/// Text of a camera.yaml. `mask_name`: file of the vehicle mask, which lies beside; "": the text says nothing of one.
/// `comment`, lines of text, goes before all else.
std::string camera_file_text(const CameraSetup& setup, const std::string& mask_name, const std::string& comment = "");

/// Writes a camera.yaml that read_camera_file reads back to the same values (angles, which the file has in degrees, to
/// the last bit): camera_file_text. A vehicle mask goes into a PNG beside it, `<name>_vehicle_mask.png`. @return kIo.
Result<void> write_camera_file(const std::string& path, const CameraSetup& setup, const std::string& comment = "");
/// Where write_camera_file puts a vehicle mask.
std::string vehicle_mask_path(const std::string& camera_file);

}  // namespace groundscale
