#pragma once

#include <functional>
#include <string>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// A piece of an experiment's work whose result is kept: a folder of its own, and beside it `FOLDER.key`, which says
/// whether the result is whole and what it depends on. What is done isn't done again while its key stays the same; what
/// was interrupted, or made under another key, is made anew in an empty folder.
class WorkUnit {
 public:
  /// @param folder  For the result and nothing else.
  /// @param key     Everything that the result depends on, as text to be read: versions, arguments, digests of files.
  WorkUnit(std::string folder, std::string key);

  const std::string& folder() const { return folder_; }
  const std::string& key() const { return key_; }
  /// Whether a whole result of this key lies there.
  bool done() const;

  /// Does the work unless it is done; `anew`: in any case.
  /// @param work  Makes the folder (which isn't there then) and fills it.
  /// @return what `work` returns; kIo; kBadInput where the folder holds something that is no result of a unit.
  Result<void> complete(bool anew, const std::function<Result<void>()>& work) const;

 private:
  std::string key_file() const { return folder_ + ".key"; }
  Result<void> clear() const;

  std::string folder_;
  std::string key_;
};

/// 16 hexadecimal digits that are others for another content (FNV-1a, 64 bits; against change, not against malice).
/// @return the errors of read_text.
Result<std::string> file_digest(const std::string& path);

}  // namespace groundscale
