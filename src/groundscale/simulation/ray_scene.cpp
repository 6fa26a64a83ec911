#include "groundscale/simulation/ray_scene.hpp"

#include <limits>
#include <utility>

#include <Eigen/Geometry>
#include <embree3/rtcore.h>

#include "groundscale/core/check.hpp"

namespace groundscale {
namespace {

/// Rays start and end a little off the surface that they left.
constexpr float kOffsetM = 1e-3F;

template <class Ray>
void aim(Ray& ray, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  ray.org_x = static_cast<float>(origin.x());
  ray.org_y = static_cast<float>(origin.y());
  ray.org_z = static_cast<float>(origin.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tnear = kOffsetM;
  ray.tfar = std::numeric_limits<float>::infinity();
  ray.time = 0.0F;
  ray.mask = ~0U;
  ray.id = 0;
  ray.flags = 0;
}

template <class Rays>
void aim4(Rays& rays, int (&valid)[4], const RayPacket& packet) {
  for (std::size_t k = 0; k < 4; ++k) {
    valid[k] = packet.valid[k] ? -1 : 0;
    rays.org_x[k] = static_cast<float>(packet.origin[k].x());
    rays.org_y[k] = static_cast<float>(packet.origin[k].y());
    rays.org_z[k] = static_cast<float>(packet.origin[k].z());
    rays.dir_x[k] = static_cast<float>(packet.direction[k].x());
    rays.dir_y[k] = static_cast<float>(packet.direction[k].y());
    rays.dir_z[k] = static_cast<float>(packet.direction[k].z());
    rays.tnear[k] = kOffsetM;
    rays.tfar[k] = std::numeric_limits<float>::infinity();
    rays.time[k] = 0.0F;
    rays.mask[k] = ~0U;
    rays.id[k] = 0;
    rays.flags[k] = 0;
  }
}

/// What Embree says of a ray's hit.
struct Found {
  unsigned geometry = RTC_INVALID_GEOMETRY_ID;
  unsigned primitive = 0;
  float u = 0.0F;
  float v = 0.0F;
  float distance = 0.0F;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

std::optional<RayHit> hit_of(const std::vector<TriangleMesh>& meshes, const Found& found,
                             const Eigen::Vector3d& direction) {
  if (found.geometry == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const TriangleMesh& mesh = meshes[found.geometry];
  const auto& face = mesh.faces[found.primitive];
  RayHit hit;
  hit.distance_m = found.distance;
  hit.normal = found.normal.normalized();
  if (hit.normal.dot(direction) > 0.0) hit.normal = -hit.normal;
  const float rest = 1.0F - found.u - found.v;
  hit.uv = (rest * mesh.uv[face[0]] + found.u * mesh.uv[face[1]] + found.v * mesh.uv[face[2]]).cast<double>();
  hit.material = mesh.material;
  hit.mesh = static_cast<int>(found.geometry);
  return hit;
}

}  // namespace

struct RayScene::Embree {
  std::vector<TriangleMesh> meshes;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  Embree() = default;
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

std::uint32_t TriangleMesh::add_vertex(const Eigen::Vector3d& position, const Eigen::Vector2d& at) {
  vertices.emplace_back(position.cast<float>());
  uv.emplace_back(at.cast<float>());
  return static_cast<std::uint32_t>(vertices.size() - 1);
}

void TriangleMesh::add_quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  faces.push_back({a, b, c});
  faces.push_back({a, c, d});
}

RayScene::RayScene(std::vector<TriangleMesh> meshes) : embree_(std::make_unique<Embree>()) {
  embree_->meshes = std::move(meshes);
  embree_->device = rtcNewDevice("isa=sse4.2,threads=1");
  GS_CHECK(embree_->device != nullptr, "Embree has a device");
  embree_->scene = rtcNewScene(embree_->device);
  rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_NONE);
  rtcSetSceneBuildQuality(embree_->scene, RTC_BUILD_QUALITY_HIGH);
  for (std::size_t k = 0; k < embree_->meshes.size(); ++k) {
    const TriangleMesh& mesh = embree_->meshes[k];
    GS_CHECK(mesh.uv.size() == mesh.vertices.size(), "uv at each vertex");
    if (mesh.faces.empty()) continue;
    RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.vertices.size()));
    auto* faces = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.faces.size()));
    GS_CHECK(vertices != nullptr && faces != nullptr, "Embree has memory");
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      for (int i = 0; i < 3; ++i) *vertices++ = vertex[i];
    }
    for (const auto& face : mesh.faces) {
      for (const std::uint32_t corner : face) *faces++ = corner;
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(embree_->scene, geometry, static_cast<unsigned>(k));
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(embree_->scene);
}

RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

std::optional<RayHit> RayScene::hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  RTCRayHit query{};
  aim(query.ray, origin, direction);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  rtcIntersect1(embree_->scene, &context, &query);
  return hit_of(embree_->meshes,
                {query.hit.geomID, query.hit.primID, query.hit.u, query.hit.v, query.ray.tfar,
                 Eigen::Vector3d(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z)},
                direction);
}

bool RayScene::blocked(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  RTCRay ray{};
  aim(ray, origin, direction);
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  rtcOccluded1(embree_->scene, &context, &ray);
  return ray.tfar < 0.0F;
}

std::array<std::optional<RayHit>, 4> RayScene::hit(const RayPacket& rays) const {
  alignas(16) int valid[4];
  RTCRayHit4 query{};
  aim4(query.ray, valid, rays);
  for (std::size_t k = 0; k < 4; ++k) {
    query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect4(valid, embree_->scene, &context, &query);
  std::array<std::optional<RayHit>, 4> hits;
  for (std::size_t k = 0; k < 4; ++k) {
    if (!rays.valid[k]) continue;
    hits[k] = hit_of(embree_->meshes,
                     {query.hit.geomID[k], query.hit.primID[k], query.hit.u[k], query.hit.v[k], query.ray.tfar[k],
                      Eigen::Vector3d(query.hit.Ng_x[k], query.hit.Ng_y[k], query.hit.Ng_z[k])},
                     rays.direction[k]);
  }
  return hits;
}

std::array<bool, 4> RayScene::blocked(const RayPacket& rays) const {
  alignas(16) int valid[4];
  RTCRay4 query{};
  aim4(query, valid, rays);
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded4(valid, embree_->scene, &context, &query);
  std::array<bool, 4> blocked{};
  for (std::size_t k = 0; k < 4; ++k) blocked[k] = rays.valid[k] && query.tfar[k] < 0.0F;
  return blocked;
}

}  // namespace groundscale
