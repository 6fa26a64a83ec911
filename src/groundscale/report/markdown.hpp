#pragma once

#include <string>
#include <string_view>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// The Markdown that experiments write, as one HTML page that needs nothing else.
///
/// Blocks: headings (# to ####; the first # names the page), paragraphs, flat lists (-, *, or 1.), tables with a rule
/// (|---|---:|), code that is fenced or set in by four blanks. Within a line: `code`, **strong**, [text](address),
/// which becomes text and address, ![words](picture), and a backslash before what is to be no mark. Everything else is
/// text, HTML too. Pictures (.svg, .png, .jpg) are taken into the page; what isn't there is said in its place.
/// @param folder  That the pictures' paths begin in; those that lead out of it are not read.
std::string markdown_page(std::string_view markdown, const std::string& folder);

/// Writes a report as Markdown and, as `report.html` beside it, as a page. @return kIo, as write_text.
Result<void> write_markdown_report(const std::string& markdown_path, std::string_view markdown);

}  // namespace groundscale
