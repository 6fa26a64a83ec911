#include "groundscale/io/sequence.hpp"

#include <filesystem>
#include <utility>

#include "groundscale/io/decode_ahead_internal.hpp"
#include "groundscale/io/image_folder_internal.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {

Result<std::unique_ptr<Sequence>> open_sequence(const SequenceRequest& request, bool decode_ahead) {
  std::error_code reason;
  const std::filesystem::file_status status = std::filesystem::status(request.source, reason);
  if (!std::filesystem::exists(status)) {
    return internal::bad_input(request.source + ": no such folder or file");
  }
  if (!std::filesystem::is_directory(status)) {
    return internal::bad_input(request.source + ": videos are not read yet");
  }
  Result<std::unique_ptr<Sequence>> sequence = internal::open_image_folder(request);
  if (!sequence || !decode_ahead) return sequence;
  return internal::decode_ahead(std::move(*sequence));
}

}  // namespace groundscale
