#pragma once

#include <functional>
#include <string_view>

namespace groundscale {

/// Where the library's warnings go. Empty by default: a library does not print unless it is told to.
using LogSink = std::function<void(std::string_view message)>;

/// Sets the sink for the whole process; call it before work starts, it is not guarded against threads.
void set_log_sink(LogSink sink);
void log_warning(std::string_view message);

}  // namespace groundscale
