// Images in, metric poses out: the odometry without the program.
// usage: odometry_from_images SEQUENCE CAMERA.yaml
#include <cstdio>

#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/sequence.hpp"
#include "groundscale/odometry/pairwise.hpp"

int main(int argc, char** argv) {
  using namespace groundscale;
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s SEQUENCE CAMERA.yaml\n", argv[0]);
    return 2;
  }
  SequenceRequest request;
  request.source = argv[1];
  auto sequence = open_sequence(request, /*decode_ahead=*/true);
  if (!sequence) {
    std::fprintf(stderr, "%s\n", sequence.error().message.c_str());
    return 2;
  }
  const auto setup = read_camera_file(argv[2], (*sequence)->width(), (*sequence)->height());
  if (!setup || !setup->height_m) {
    std::fprintf(stderr, "%s\n", setup ? "height_m is missing in the camera file" : setup.error().message.c_str());
    return 2;
  }
  auto odometry = PairwiseOdometry::create(*setup, {});
  if (!odometry) {
    std::fprintf(stderr, "%s\n", odometry.error().message.c_str());
    return 2;
  }
  while (const auto frame = (*sequence)->next()) odometry->advance(*frame);
  odometry->finish();
  for (const RigidTransform& world_from_cam : odometry->final_poses()) {
    const Eigen::Vector3d& centre = world_from_cam.translation;
    std::printf("%.3f %.3f %.3f\n", centre.x(), centre.y(), centre.z());
  }
  return 0;
}
