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
  float distance_m = 0.0F;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< Unit, towards where the ray came from.
  Eigen::Vector2f uv = Eigen::Vector2f::Zero();
  int material = 0;
  int mesh = 0;
};

/// Eight rays that are traced at once; those that aren't `valid` meet nothing.
struct RayPacket {
  static constexpr std::size_t kRays = 8;

  std::array<Eigen::Vector3f, kRays> origin;
  std::array<Eigen::Vector3f, kRays> direction;  ///< Unit vectors.
  std::array<bool, kRays> valid{};
};
using RayHits = std::array<std::optional<RayHit>, RayPacket::kRays>;
using RayFlags = std::array<bool, RayPacket::kRays>;

/// What rays meet, by Embree. Hits are the same whatever the number of threads that ask. Embree is held to AVX2 where
/// the processor has it, else to SSE 4.2.
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

  /// The same for a packet, in a fraction of the time where its rays lie close together.
  RayHits hit(const RayPacket& rays) const;
  RayFlags blocked(const RayPacket& rays) const;

  /// The instruction set that Embree uses on this processor, which decides the last bits: "avx2", "sse4.2".
  static const char* instruction_set();

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace groundscale
