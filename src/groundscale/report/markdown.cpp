#include "groundscale/report/markdown.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/report/markup_internal.hpp"
#include "groundscale/report/page_internal.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::escape_html;
using internal::trimmed;

std::string_view type_of(const fs::path& picture) {
  const std::string ending = picture.extension().string();
  if (ending == ".svg") return "image/svg+xml";
  if (ending == ".png") return "image/png";
  if (ending == ".jpg" || ending == ".jpeg") return "image/jpeg";
  return "";
}

/// The picture within the page, or words in its place.
std::string picture_html(std::string_view words, const std::string& address, const std::string& folder) {
  const fs::path path = fs::path(address).lexically_normal();
  const bool within = path.is_relative() && !path.empty() && *path.begin() != "..";
  const std::string_view type = type_of(path);
  const auto bytes = within && !type.empty() ? read_text((fs::path(folder) / path).string())
                                             : Result<std::string>(Error{ErrorCode::kBadInput, ""});
  if (!bytes)
    return fmt::format("<span class=\"note\">Not there: {}, {}</span>", escape_html(words), escape_html(address));
  return fmt::format("<img alt=\"{}\" src=\"{}\"/>", escape_html(words), internal::data_address(type, *bytes));
}

/// [words](address) from its bracket on.
struct Link {
  std::string_view words, address;
  std::size_t length = 0;
};

std::optional<Link> link_at(std::string_view text) {
  if (!text.starts_with('[')) return std::nullopt;
  const std::size_t middle = text.find("](");
  if (middle == std::string_view::npos) return std::nullopt;
  const std::size_t end = text.find(')', middle);
  if (end == std::string_view::npos) return std::nullopt;
  return Link{text.substr(1, middle - 1), text.substr(middle + 2, end - middle - 2), end + 1};
}

/// Marks within a line.
class InlineWriter {
 public:
  explicit InlineWriter(const std::string& folder) : folder_(folder) {}

  std::string write(std::string_view text) const {
    std::string html;
    std::string plain;
    const auto flush = [&html, &plain] {
      html += escape_html(plain);
      plain.clear();
    };
    for (std::size_t k = 0; k < text.size();) {
      const auto marked = mark_at(text.substr(k));
      if (marked) {
        flush();
        html += marked->html;
        k += marked->length;
      } else if (text[k] == '\\' && k + 1 < text.size() && std::ispunct(static_cast<unsigned char>(text[k + 1])) != 0) {
        plain += text[k + 1];
        k += 2;
      } else {
        plain += text[k++];
      }
    }
    flush();
    return html;
  }

 private:
  struct Marked {
    std::string html;
    std::size_t length = 0;
  };

  std::optional<Marked> mark_at(std::string_view text) const {
    if (text.starts_with('`')) {
      const std::size_t end = text.find('`', 1);
      if (end == std::string_view::npos) return std::nullopt;
      return Marked{"<code>" + escape_html(text.substr(1, end - 1)) + "</code>", end + 1};
    }
    if (text.starts_with("**")) {
      const std::size_t end = text.find("**", 2);
      if (end == std::string_view::npos || end == 2) return std::nullopt;
      return Marked{"<b>" + write(text.substr(2, end - 2)) + "</b>", end + 2};
    }
    if (text.starts_with("![")) {
      const auto link = link_at(text.substr(1));
      if (!link) return std::nullopt;
      return Marked{picture_html(link->words, std::string(link->address), folder_), link->length + 1};
    }
    const auto link = link_at(text);
    if (!link) return std::nullopt;
    return Marked{fmt::format("{} ({})", write(link->words), escape_html(link->address)), link->length};
  }

  const std::string& folder_;
};

/// Cells between bars; a backslash before a bar makes it part of its cell, but not within code.
std::vector<std::string> cells_of(std::string_view row) {
  row = trimmed(row);
  if (row.starts_with('|')) row.remove_prefix(1);
  std::vector<std::string> cells(1);
  for (std::size_t k = 0; k < row.size(); ++k) {
    if (row[k] == '\\' && k + 1 < row.size() && row[k + 1] == '|') {
      cells.back() += row[++k];
    } else if (row[k] == '|') {
      cells.emplace_back();
    } else {
      cells.back() += row[k];
    }
  }
  if (cells.size() > 1 && trimmed(cells.back()).empty()) cells.pop_back();
  for (std::string& cell : cells) cell = std::string(trimmed(cell));
  return cells;
}

bool is_rule(std::string_view line) {
  line = trimmed(line);
  return line.starts_with('|') && line.find('-') != std::string_view::npos &&
         line.find_first_not_of("|-: ") == std::string_view::npos;
}

/// Where a list's item begins in a line; nothing where it is none.
std::optional<std::size_t> item_begin(std::string_view line) {
  if (line.starts_with("- ") || line.starts_with("* ")) return 2;
  const std::size_t digits = std::min(line.find_first_not_of("0123456789"), line.size());
  if (digits > 0 && line.substr(digits).starts_with(". ")) return digits + 2;
  return std::nullopt;
}

class BlockWriter {
 public:
  BlockWriter(std::string_view markdown, const std::string& folder) : inline_(folder) {
    for (const internal::Line& line : internal::split_lines(markdown)) lines_.push_back(line.text);
  }

  std::string title = "Report";

  std::string write() {
    std::string html;
    while (at_ < lines_.size()) {
      if (trimmed(lines_[at_]).empty()) {
        ++at_;
      } else {
        html += block();
      }
    }
    return html;
  }

 private:
  std::string block() {
    const std::string_view line = lines_[at_];
    if (line.starts_with("```")) return fenced();
    if (line.starts_with("    ")) return set_in();
    const std::size_t level = std::min(line.find_first_not_of('#'), line.size());
    if (level >= 1 && level <= 4 && line.substr(level).starts_with(' ')) return heading(level);
    if (line.starts_with('|') && at_ + 1 < lines_.size() && is_rule(lines_[at_ + 1])) return table();
    if (item_begin(line)) return list();
    return paragraph();
  }

  std::string heading(std::size_t level) {
    const std::string_view words = trimmed(lines_[at_++].substr(level));
    if (level > 1 || named_)
      return fmt::format("<h{0}>{1}</h{0}>\n", std::max<std::size_t>(2, level), inline_.write(words));
    named_ = true;
    title.clear();
    for (const char c : words) {
      if (c != '`' && c != '*') title += c;
    }
    return "";  // the page's own heading
  }

  std::string fenced() {
    std::string code;
    for (++at_; at_ < lines_.size() && !lines_[at_].starts_with("```"); ++at_) {
      code.append(lines_[at_]).append("\n");
    }
    if (at_ < lines_.size()) ++at_;
    return "<pre>" + escape_html(code) + "</pre>\n";
  }

  std::string set_in() {
    std::string code;
    for (; at_ < lines_.size() && lines_[at_].starts_with("    "); ++at_) {
      code.append(lines_[at_].substr(4)).append("\n");
    }
    return "<pre>" + escape_html(code) + "</pre>\n";
  }

  std::string table() {
    const std::vector<std::string> heading = cells_of(lines_[at_]);
    std::vector<bool> numbers;
    for (const std::string& cell : cells_of(lines_[at_ + 1])) numbers.push_back(cell.ends_with(':'));
    numbers.resize(heading.size(), false);
    const auto row = [&](const std::vector<std::string>& cells, std::string_view element) {
      std::string html = "<tr>";
      for (std::size_t k = 0; k < heading.size(); ++k) {
        const std::string cell = k < cells.size() ? inline_.write(cells[k]) : "";
        html += fmt::format("<{0}{1}>{2}</{0}>", element, numbers[k] ? "" : " class=\"text\"", cell);
      }
      return html + "</tr>\n";
    };
    std::string html = "<div class=\"wide\">\n<table>\n<thead>" + row(heading, "th") + "</thead>\n<tbody>\n";
    for (at_ += 2; at_ < lines_.size() && lines_[at_].starts_with('|'); ++at_) html += row(cells_of(lines_[at_]), "td");
    return html + "</tbody>\n</table>\n</div>\n";
  }

  std::string list() {
    const bool numbered = std::isdigit(static_cast<unsigned char>(lines_[at_].front())) != 0;
    std::string html = numbered ? "<ol>\n" : "<ul>\n";
    while (at_ < lines_.size()) {
      const auto begin = item_begin(lines_[at_]);
      if (!begin) break;
      std::string item(trimmed(lines_[at_++].substr(*begin)));
      // Lines that are set in belong to the item.
      for (; at_ < lines_.size() && lines_[at_].starts_with("  ") && !trimmed(lines_[at_]).empty(); ++at_) {
        item.append(" ").append(trimmed(lines_[at_]));
      }
      html += "<li>" + inline_.write(item) + "</li>\n";
    }
    return html + (numbered ? "</ol>\n" : "</ul>\n");
  }

  std::string paragraph() {
    std::string text;
    while (at_ < lines_.size() && !trimmed(lines_[at_]).empty()) {
      const std::string_view line = lines_[at_];
      const bool begins_other = line.starts_with("```") || line.starts_with('#') || item_begin(line) ||
                                (line.starts_with('|') && at_ + 1 < lines_.size() && is_rule(lines_[at_ + 1]));
      if (!text.empty() && begins_other) break;
      text.append(text.empty() ? "" : " ").append(trimmed(line));
      ++at_;
    }
    return picture_alone(text).value_or("<p>" + inline_.write(text) + "</p>\n");
  }

  /// A paragraph that is nothing but a picture becomes a figure.
  std::optional<std::string> picture_alone(std::string_view text) const {
    if (!text.starts_with("![")) return std::nullopt;
    const auto link = link_at(text.substr(1));
    if (!link || link->length + 1 != text.size()) return std::nullopt;
    return fmt::format("<figure class=\"drawn\">\n<figcaption>{}</figcaption>\n{}\n</figure>\n",
                       escape_html(link->words), inline_.write(text));
  }

  InlineWriter inline_;
  std::vector<std::string_view> lines_;
  std::size_t at_ = 0;
  bool named_ = false;
};

}  // namespace

std::string markdown_page(std::string_view markdown, const std::string& folder) {
  BlockWriter writer(markdown, folder);
  const std::string body = writer.write();
  return internal::page(writer.title, body);
}

Result<void> write_markdown_report(const std::string& markdown_path, std::string_view markdown) {
  if (const auto written = write_text(markdown_path, markdown); !written) return written;
  const fs::path folder = fs::path(markdown_path).parent_path();
  return write_text((folder / "report.html").string(), markdown_page(markdown, folder.string()));
}

}  // namespace groundscale
