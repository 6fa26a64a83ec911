#include <opencv2/imgproc.hpp>

#include "groundscale/tracking/stereoscan_internal.hpp"

namespace groundscale::internal {

std::vector<char> supported(const std::vector<Eigen::Vector2f>& points, const std::vector<Eigen::Vector2f>& flows,
                            const Image& first, const StereoScanOptions& options) {
  std::vector<char> kept(points.size(), 0);
  if (points.empty()) return kept;
  cv::Subdiv2D triangulation(cv::Rect(0, 0, first.width(), first.height()));
  // Features of two kinds may lie on one pixel and be one vertex then.
  std::vector<int> vertices(points.size());
  std::vector<int> point_of;  // by vertex; those of the outermost triangle have none
  for (std::size_t i = 0; i < points.size(); ++i) {
    vertices[i] = triangulation.insert(cv::Point2f(points[i].x(), points[i].y()));
    const auto vertex = static_cast<std::size_t>(vertices[i]);
    if (point_of.size() <= vertex) point_of.resize(vertex + 1, -1);
    if (point_of[vertex] < 0) point_of[vertex] = static_cast<int>(i);
  }
  const auto limit = static_cast<float>(options.max_flow_change_px * options.max_flow_change_px);
  for (std::size_t i = 0; i < points.size(); ++i) {
    int first_edge = 0;
    triangulation.getVertex(vertices[i], &first_edge);
    int support = 0;
    int edge = first_edge;
    do {
      const auto end = static_cast<std::size_t>(triangulation.edgeDst(edge));
      const int other = end < point_of.size() ? point_of[end] : -1;
      if (other >= 0 && (flows[static_cast<std::size_t>(other)] - flows[i]).squaredNorm() < limit) ++support;
      edge = triangulation.getEdge(edge, cv::Subdiv2D::NEXT_AROUND_ORG);
    } while (edge != first_edge && support < options.min_support);
    kept[i] = support >= options.min_support ? 1 : 0;
  }
  return kept;
}

}  // namespace groundscale::internal
