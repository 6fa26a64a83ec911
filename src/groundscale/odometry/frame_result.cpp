#include "groundscale/odometry/frame_result.hpp"

namespace groundscale {

std::string_view name_of(FrameState state) {
  switch (state) {
    case FrameState::kMoving:
      return "moving";
    case FrameState::kStill:
      return "still";
    case FrameState::kRotating:
      return "rotating";
    case FrameState::kBridged:
      return "bridged";
    case FrameState::kLost:
      return "lost";
  }
  return "lost";
}

}  // namespace groundscale
