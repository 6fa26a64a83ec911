#include "groundscale/simulation/ray_scene.hpp"

#include <limits>
#include <string>
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

/// Fills Embree's own packet, of 4 or 8 rays, from ours, beginning at `first`.
template <std::size_t Count, class Rays>
void aim_packet(Rays& rays, int (&valid)[Count], const RayPacket& packet, std::size_t first) {
  for (std::size_t k = 0; k < Count; ++k) {
    const Eigen::Vector3f& origin = packet.origin[first + k];
    const Eigen::Vector3f& direction = packet.direction[first + k];
    valid[k] = packet.valid[first + k] ? -1 : 0;
    rays.org_x[k] = origin.x();
    rays.org_y[k] = origin.y();
    rays.org_z[k] = origin.z();
    rays.dir_x[k] = direction.x();
    rays.dir_y[k] = direction.y();
    rays.dir_z[k] = direction.z();
    rays.tnear[k] = kOffsetM;
    rays.tfar[k] = std::numeric_limits<float>::infinity();
    rays.time[k] = 0.0F;
    rays.mask[k] = ~0U;
    rays.id[k] = 0;
    rays.flags[k] = 0;
  }
}

RTCIntersectContext coherent_context() {
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

/// What Embree says of a ray's hit.
struct Found {
  unsigned geometry = RTC_INVALID_GEOMETRY_ID;
  unsigned primitive = 0;
  float u = 0.0F;
  float v = 0.0F;
  float distance = 0.0F;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
};

std::optional<RayHit> hit_of(const std::vector<TriangleMesh>& meshes, const Found& found,
                             const Eigen::Vector3f& direction) {
  if (found.geometry == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const TriangleMesh& mesh = meshes[found.geometry];
  const auto& face = mesh.faces[found.primitive];
  RayHit hit;
  hit.distance_m = found.distance;
  hit.normal = found.normal.normalized();
  if (hit.normal.dot(direction) > 0.0F) hit.normal = -hit.normal;
  const float rest = 1.0F - found.u - found.v;
  hit.uv = rest * mesh.uv[face[0]] + found.u * mesh.uv[face[1]] + found.v * mesh.uv[face[2]];
  hit.material = mesh.material;
  hit.mesh = static_cast<int>(found.geometry);
  return hit;
}

}  // namespace

struct RayScene::Embree {
  std::vector<TriangleMesh> meshes;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  bool eight_at_once = false;  ///< Whether Embree has packets of eight rays.

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
  embree_->device = rtcNewDevice((std::string("isa=") + instruction_set() + ",threads=1").c_str());
  GS_CHECK(embree_->device != nullptr, "Embree has a device");
  embree_->eight_at_once = rtcGetDeviceProperty(embree_->device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0;
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

const char* RayScene::instruction_set() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return "avx2";
#endif
  return "sse4.2";
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
                 Eigen::Vector3f(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z)},
                direction.cast<float>());
}

bool RayScene::blocked(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  RTCRay ray{};
  aim(ray, origin, direction);
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  rtcOccluded1(embree_->scene, &context, &ray);
  return ray.tfar < 0.0F;
}

namespace {

/// One packet of Embree's: `Count` of our rays from `first` on.
template <std::size_t Count, class Query, class Intersect>
void hit_packet(RTCScene scene, const std::vector<TriangleMesh>& meshes, const RayPacket& rays, std::size_t first,
                Intersect intersect, RayHits& hits) {
  alignas(32) int valid[Count];
  alignas(32) Query query{};
  aim_packet(query.ray, valid, rays, first);
  for (std::size_t k = 0; k < Count; ++k) {
    query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context = coherent_context();
  intersect(valid, scene, &context, &query);
  for (std::size_t k = 0; k < Count; ++k) {
    if (!rays.valid[first + k]) continue;
    hits[first + k] =
        hit_of(meshes,
               {query.hit.geomID[k], query.hit.primID[k], query.hit.u[k], query.hit.v[k], query.ray.tfar[k],
                Eigen::Vector3f(query.hit.Ng_x[k], query.hit.Ng_y[k], query.hit.Ng_z[k])},
               rays.direction[first + k]);
  }
}

template <std::size_t Count, class Query, class Occluded>
void block_packet(RTCScene scene, const RayPacket& rays, std::size_t first, Occluded occluded, RayFlags& blocked) {
  alignas(32) int valid[Count];
  alignas(32) Query query{};
  aim_packet(query, valid, rays, first);
  RTCIntersectContext context = coherent_context();
  occluded(valid, scene, &context, &query);
  for (std::size_t k = 0; k < Count; ++k) blocked[first + k] = rays.valid[first + k] && query.tfar[k] < 0.0F;
}

}  // namespace

RayHits RayScene::hit(const RayPacket& rays) const {
  RayHits hits;
  if (embree_->eight_at_once) {
    hit_packet<8, RTCRayHit8>(embree_->scene, embree_->meshes, rays, 0, rtcIntersect8, hits);
  } else {
    for (const std::size_t first : {0U, 4U}) {
      hit_packet<4, RTCRayHit4>(embree_->scene, embree_->meshes, rays, first, rtcIntersect4, hits);
    }
  }
  return hits;
}

RayFlags RayScene::blocked(const RayPacket& rays) const {
  RayFlags blocked{};
  if (embree_->eight_at_once) {
    block_packet<8, RTCRay8>(embree_->scene, rays, 0, rtcOccluded8, blocked);
  } else {
    for (const std::size_t first : {0U, 4U}) {
      block_packet<4, RTCRay4>(embree_->scene, rays, first, rtcOccluded4, blocked);
    }
  }
  return blocked;
}

}  // namespace groundscale
