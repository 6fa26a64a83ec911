#include "groundscale/io/sequence.hpp"

#include <filesystem>
#include <utility>

#include "groundscale/io/decode_ahead_internal.hpp"
#include "groundscale/io/image_folder_internal.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/video_internal.hpp"

namespace groundscale {

Result<std::unique_ptr<Sequence>> open_sequence(const SequenceRequest& request, bool decode_ahead) {
  std::error_code reason;
  const std::filesystem::file_status status = std::filesystem::status(request.source, reason);
  if (!std::filesystem::exists(status)) {
    return internal::bad_input(request.source + ": no such folder or file");
  }
  Result<std::unique_ptr<Sequence>> sequence =
      std::filesystem::is_directory(status) ? internal::open_image_folder(request) : internal::open_video(request);
  if (!sequence || !decode_ahead) return sequence;
  return internal::decode_ahead(std::move(*sequence));
}

}  // namespace groundscale
