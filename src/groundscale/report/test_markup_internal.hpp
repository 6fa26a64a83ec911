#pragma once

#include <cctype>
#include <string>
#include <string_view>
#include <vector>

namespace groundscale::internal {

/// For tests: a page read as strictly as XML would be.
class MarkupCheck {
 public:
  /// The first thing wrong with a page's tags; empty where each is closed in its order, attributes are in quotes and
  /// there once, and text has neither < nor a bare &.
  static std::string what_is_wrong(std::string_view page) {
    const std::string_view doctype = "<!DOCTYPE html>\n";
    if (!page.starts_with(doctype)) return "no doctype";
    MarkupCheck check(page.substr(doctype.size()));
    return check.run();
  }

 private:
  explicit MarkupCheck(std::string_view rest) : rest_(rest) {}

  std::string run() {
    while (!rest_.empty()) {
      const std::size_t end = rest_.find('<');
      const std::string_view text = rest_.substr(0, end);
      if (!style_open() && !is_text(text)) return "text: " + std::string(text.substr(0, 80));
      if (open_.empty() && text.find_first_not_of(" \n") != std::string_view::npos) return "text outside";
      if (end == std::string_view::npos) break;
      rest_.remove_prefix(end);
      const std::string problem = take_tag();
      if (!problem.empty()) return problem;
    }
    return open_.empty() ? "" : "left open: " + open_.back();
  }

  bool style_open() const { return !open_.empty() && open_.back() == "style"; }

  static bool is_text(std::string_view text) {
    for (std::size_t at = text.find_first_of("&>"); at != std::string_view::npos;
         at = text.find_first_of("&>", at + 1)) {
      if (text[at] == '>') return false;
      bool known = false;
      for (const std::string_view entity : {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"}) {
        known = known || text.substr(at).starts_with(entity);
      }
      if (!known) return false;
    }
    return true;
  }

  std::string_view take_name() {
    std::size_t length = 0;
    while (length < rest_.size() &&
           (std::isalnum(static_cast<unsigned char>(rest_[length])) != 0 || rest_[length] == '-')) {
      ++length;
    }
    const std::string_view name = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return name;
  }

  std::string take_tag() {
    rest_.remove_prefix(1);
    if (rest_.starts_with('/')) {
      rest_.remove_prefix(1);
      const std::string name(take_name());
      if (!rest_.starts_with('>')) return "no end of the tag that closes " + name;
      rest_.remove_prefix(1);
      if (open_.empty() || open_.back() != name) return "closed out of order: " + name;
      open_.pop_back();
      return "";
    }
    const std::string name(take_name());
    if (name.empty()) return "a < that begins no tag";
    std::vector<std::string_view> attributes;
    while (rest_.starts_with(' ')) {
      rest_.remove_prefix(1);
      const std::string_view attribute = take_name();
      for (const std::string_view other : attributes) {
        if (other == attribute) return "twice in " + name + ": " + std::string(attribute);
      }
      attributes.push_back(attribute);
      if (attribute.empty() || !rest_.starts_with("=\"")) return "an attribute of " + name + " without value in quotes";
      rest_.remove_prefix(2);
      const std::size_t end = rest_.find('"');
      if (end == std::string_view::npos) return "an attribute of " + name + " that doesn't end";
      const std::string_view value = rest_.substr(0, end);
      if (value.find('<') != std::string_view::npos || !is_text(value)) return "value: " + std::string(value);
      rest_.remove_prefix(end + 1);
    }
    const bool closed = rest_.starts_with('/');
    if (closed) rest_.remove_prefix(1);
    if (!rest_.starts_with('>')) return "no end of the tag " + name;
    rest_.remove_prefix(1);
    if (!closed) open_.push_back(name);
    return "";
  }

  std::string_view rest_;
  std::vector<std::string> open_;
};

inline std::string what_is_wrong(std::string_view page) { return MarkupCheck::what_is_wrong(page); }

inline int occurrences(std::string_view text, std::string_view part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

}  // namespace groundscale::internal
