#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace groundscale {

/// Triangles of one material. `uv` are two coordinates of the material's own, in metres, given at the vertices.
struct TriangleMesh {
  int material = 0;
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector2f> uv;  ///< As long as vertices.
  std::vector<std::array<std::uint32_t, 3>> faces;

  std::uint32_t add_vertex(const Eigen::Vector3d& position, const Eigen::Vector2d& at);
  /// Two triangles; corners in order around.
  void add_quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);
};

struct RayHit {
  double distance_m = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< Unit, towards where the ray came from.
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();
  int material = 0;
  int mesh = 0;
};

/// Four rays; those that aren't `valid` meet nothing.
struct RayPacket {
  std::array<Eigen::Vector3d, 4> origin;
  std::array<Eigen::Vector3d, 4> direction;  ///< Unit vectors.
  std::array<bool, 4> valid{};
};

/// What rays meet, by Embree. Hits are the same whatever the number of threads that ask and the processor's instruction
/// sets: SSE 4.2 is used everywhere.
class RayScene {
 public:
  explicit RayScene(std::vector<TriangleMesh> meshes);
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  /// @param direction  Unit vector.
  std::optional<RayHit> hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  /// Whether anything lies in that direction.
  bool blocked(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  /// The same for four rays at once, in half of the time where they lie close together.
  std::array<std::optional<RayHit>, 4> hit(const RayPacket& rays) const;
  std::array<bool, 4> blocked(const RayPacket& rays) const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace groundscale
