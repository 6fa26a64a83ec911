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
  rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);
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
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const TriangleMesh& mesh = embree_->meshes[query.hit.geomID];
  const auto& face = mesh.faces[query.hit.primID];
  RayHit hit;
  hit.distance_m = query.ray.tfar;
  hit.normal = Eigen::Vector3d(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized();
  if (hit.normal.dot(direction) > 0.0) hit.normal = -hit.normal;
  const float u = query.hit.u;
  const float v = query.hit.v;
  hit.uv = ((1.0F - u - v) * mesh.uv[face[0]] + u * mesh.uv[face[1]] + v * mesh.uv[face[2]]).cast<double>();
  hit.material = mesh.material;
  hit.mesh = static_cast<int>(query.hit.geomID);
  return hit;
}

bool RayScene::blocked(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  RTCRay ray{};
  aim(ray, origin, direction);
  RTCIntersectContext context{};
  rtcInitIntersectContext(&context);
  rtcOccluded1(embree_->scene, &context, &ray);
  return ray.tfar < 0.0F;
}

}  // namespace groundscale
