#include <cstdint>

#include <fmt/format.h>

#include "groundscale/report/markup_internal.hpp"
#include "groundscale/report/page_internal.hpp"

namespace groundscale::internal {
namespace {

// Letters of a figure grow where it is narrow, since the figure as a whole shrinks. Curves differ in colour and in
// dashes or breadth, so that they tell in grey too. Tables take the page's width, text and figures no more than is read
// with ease.
constexpr std::string_view kStyle = R"(
:root { color-scheme: light; }
body { margin: 0 auto; max-width: 68rem; padding: 1rem; background: #ffffff; color: #1c1c1c;
  font: 16px/1.5 system-ui, "DejaVu Sans", "Liberation Sans", Arial, sans-serif; }
h1 { font-size: 1.5rem; line-height: 1.25; margin: 0.5rem 0 1rem; overflow-wrap: anywhere; }
h2 { font-size: 1.15rem; margin: 2rem 0 0.5rem; border-bottom: 1px solid #c8c8c8; }
h3 { font-size: 1rem; margin: 1rem 0 0.25rem; overflow-wrap: anywhere; }
p { margin: 0.5rem 0; }
p, ul, ol, dl, pre, figure { max-width: 52rem; }
h4 { font-size: 0.95rem; margin: 0.75rem 0 0.25rem; overflow-wrap: anywhere; }
.verdict { border-left: 0.4rem solid #b45309; background: #fdf4e7; padding: 0.6rem 0.9rem; font-weight: 600; }
.verdict.adopted, .verdict.good { border-color: #15803d; background: #eef8f0; }
.verdict.bad { border-color: #b91c1c; background: #fdeeee; }
ul.findings { margin: 0.5rem 0; padding-left: 1.25rem; }
.note { border: 1px solid #8a8a8a; padding: 0.4rem 0.7rem; }
.wide { overflow-x: auto; }
.wide + .wide { margin-top: 1rem; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: right; white-space: nowrap; padding: 0.3rem 0.4rem; vertical-align: top; border-top: 1px solid #dcdcdc; }
thead th { border-top: none; }
tr.groups th { text-align: center; }
th:first-child, td.reason { text-align: left; white-space: normal; }
tbody th, td.reason { overflow-wrap: anywhere; }
table.text th, table.text td, th.text, td.text { text-align: left; white-space: normal; overflow-wrap: anywhere; }
.wide thead th { white-space: normal; vertical-align: bottom; }
.wide tbody th, .wide th.text, .wide td.text { overflow-wrap: break-word; min-width: 4.5rem; }
table.text td { min-width: 4.5rem; }
table.figures th, table.figures td { text-align: left; white-space: nowrap; }
table.figures td:last-child { white-space: normal; min-width: 9rem; }
td.reason { border-top: none; padding-top: 0; color: #7a3b05; }
.unit { font-weight: 400; color: #555555; }
dl { display: grid; grid-template-columns: minmax(7rem, max-content) 1fr; gap: 0.25rem 1rem; margin: 0; }
dt { color: #555555; }
dd { margin: 0; overflow-wrap: anywhere; }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 20rem), 1fr)); gap: 0 1rem; }
.pair > * { min-width: 0; }
figure { margin: 0.75rem 0; container-type: inline-size; }
figcaption { font-weight: 600; }
ul.keys { list-style: none; margin: 0.5rem 0; padding: 0; display: flex; flex-wrap: wrap; gap: 0.15rem 1.25rem; }
svg.plot { display: block; width: 100%; height: auto; }
svg.plot text { font-size: 15px; fill: #333333; }
figure.drawn { overflow-x: auto; }
figure.drawn img { width: 100%; min-width: 42rem; }
svg.key { height: 0.9em; width: auto; vertical-align: -0.08em; margin-right: 0.3em; }
.frame { fill: none; stroke: #333333; stroke-width: 1.5; }
.tick { stroke: #333333; }
.grid { stroke: #e4e4e4; }
.zero { stroke: #333333; stroke-dasharray: 2 4; }
.event { stroke: #1c1c1c; stroke-width: 1.3; stroke-dasharray: 6 4; }
.band { fill: #9dbfe3; fill-opacity: 0.55; stroke: none; }
.bar { fill: #6f97c4; stroke: #1c3d63; stroke-width: 0.8; }
.curve { fill: none; stroke-width: 2; stroke-linejoin: round; }
.points { fill: none; stroke-width: 1.2; }
.points.dot { stroke-width: 4.5; stroke-linecap: round; }
.s0 { stroke: #1f5fa8; }
.s1 { stroke: #c2600a; }
.s2 { stroke: #15803d; }
.s3 { stroke: #7c3aed; }
.s4 { stroke: #b91c1c; }
.s5 { stroke: #0e7490; }
.s6 { stroke: #3f3f46; }
.s7 { stroke: #8a6d0a; }
.s8 { stroke: #be185d; }
.s9 { stroke: #111111; }
.curve.s1 { stroke-dasharray: 9 3; }
.curve.s2 { stroke-dasharray: 2.5 2.5; }
.curve.s3 { stroke-dasharray: 12 3 3 3; }
.curve.s4 { stroke-dasharray: 5 7; }
.curve.s5 { stroke-dasharray: 22 5; }
.curve.s6 { stroke-dasharray: 10 3 2 3 2 3; }
.curve.s7 { stroke-dasharray: 0.1 6; stroke-width: 3.2; stroke-linecap: round; }
.curve.s8 { stroke-dasharray: 2 7; stroke-width: 5; }
.curve.s9 { stroke-width: 0.8; }
.curve.truth { stroke: #b0b0b0; stroke-width: 7; }
.arrow { fill: #1c1c1c; stroke: #1c1c1c; stroke-width: 1.4; stroke-linejoin: round; pointer-events: none; }
.before { fill: none; stroke: #c2600a; }
.after { fill: #2563a8; }
.before-line { fill: none; stroke: #c2600a; stroke-width: 2.5; stroke-dasharray: 9 5; }
.after-line { fill: none; stroke: #2563a8; stroke-width: 2.5; }
pre { margin: 0.25rem 0; padding: 0.6rem; background: #f6f6f6; border: 1px solid #dcdcdc; font-size: 0.8rem;
  line-height: 1.4; white-space: pre-wrap; overflow-wrap: anywhere; }
pre mark { background: #fde9a9; color: inherit; font-weight: 700; }
code { font-size: 0.9em; overflow-wrap: anywhere; }
details { margin: 0.5rem 0; }
summary { cursor: pointer; }
.samples { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 22rem), 1fr)); gap: 0.5rem 1rem; }
.samples figure { margin: 0; min-width: 0; }
.samples figcaption { font-size: 0.85rem; font-weight: 400; overflow-wrap: anywhere; }
img { display: block; max-width: 100%; height: auto; }
@page { margin: 15mm; }
@media print {
  body { max-width: none; padding: 0; font-size: 10.5pt; print-color-adjust: exact;
    -webkit-print-color-adjust: exact; }
  .wide { overflow: visible; }
  .wide table { font-size: 0.8rem; }
  .wide th, .wide td { padding: 0.2rem 0.25rem; }
  .wide table.many { font-size: 0.62rem; }
  img { max-height: 150mm; }
  figure.drawn img { width: auto; min-width: 0; }
  p, ul, ol, dl, pre, figure { max-width: none; }
  .samples { grid-template-columns: 1fr 1fr; }
  figure, p, li, tr, dt, dd { break-inside: avoid; }
  h2, h3, thead, section > p { break-after: avoid; }
  svg.plot { max-height: 72mm; }
  svg.plot text { font-size: 17px; }
}
@media (max-width: 480px) { table { font-size: 0.8rem; } th, td { padding: 0.3rem 0.2rem; } }
@container (max-width: 560px) { svg.plot text { font-size: 24px; } }
)";

/// Names may be broken behind a '_'.
std::string breakable(const std::string& markup) {
  std::string html;
  for (const char c : markup) {
    html += c;
    if (c == '_') html += "<wbr/>";
  }
  return html;
}

constexpr std::size_t kMany = 9;  // columns, from which on letters are smaller on paper

std::string base64(std::string_view bytes) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      group = group << 8 | (k + j < bytes.size() ? static_cast<unsigned char>(bytes[k + j]) : 0U);
    }
    for (std::size_t j = 0; j < 4; ++j) {
      text += k + j > bytes.size() ? '=' : kLetters[group >> (18 - 6 * j) & 63U];
    }
  }
  return text;
}

}  // namespace

std::string page(std::string_view title, const std::string& body) {
  const std::string escaped = escape_html(title);
  return fmt::format(
             "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
             "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
             "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n<h1>{}</h1>\n",
             escaped, kStyle, escaped) +
         body + "</body>\n</html>\n";
}

std::string section(std::string_view heading, const std::string& content) {
  if (content.empty()) return "";
  return fmt::format("<section>\n<h2>{}</h2>\n{}</section>\n", heading, content);
}

std::string paragraph(std::string_view text) {
  return text.empty() ? "" : fmt::format("<p>{}</p>\n", escape_html(text));
}

std::string details(std::string_view summary, const std::string& content, bool open) {
  if (content.empty()) return "";
  return fmt::format("<details{}>\n<summary>{}</summary>\n{}</details>\n", open ? " open=\"open\"" : "",
                     escape_html(summary), content);
}

std::string definitions(const std::vector<std::pair<std::string, std::string>>& pairs) {
  if (pairs.empty()) return "";
  std::string html = "<dl>\n";
  for (const auto& [name, value] : pairs) {
    html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escape_html(name), escape_html(value));
  }
  return html + "</dl>\n";
}

std::string table_html(const TextTable& table) {
  if (table.rows.empty()) return "";
  const std::string_view kind = table.cells == Cells::kWords     ? " class=\"text\""
                                : table.cells == Cells::kFigures ? " class=\"figures\""
                                : table.heading.size() > kMany   ? " class=\"many\""
                                                                 : "";
  std::string html = fmt::format("<div class=\"wide\">\n<table{}>\n", kind);
  if (!table.heading.empty()) {
    html += "<thead>";
    if (!table.groups.empty()) html += "<tr class=\"groups\">";
    for (const auto& [name, columns] : table.groups) {
      html += fmt::format("<th colspan=\"{}\">{}</th>", columns, escape_html(name));
    }
    html += table.groups.empty() ? "<tr>" : "</tr>\n<tr>";
    for (const std::string& cell : table.heading) html += "<th>" + breakable(escape_html(cell)) + "</th>";
    html += "</tr></thead>\n";
  }
  html += "<tbody>\n";
  for (std::size_t number = 0; number < table.rows.size(); ++number) {
    const auto& row = table.rows[number];
    html += "<tr>";
    for (std::size_t k = 0; k < row.size(); ++k) {
      std::string cell = escape_html(row[k]);
      if (k == 0 && number < table.addresses.size()) {
        cell = fmt::format("<a href=\"{}\">{}</a>", escape_html(table.addresses[number]), cell);
      }
      html += k == 0 ? "<th>" + cell + "</th>" : "<td>" + cell + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table>\n</div>\n";
}

std::string list_html(const std::vector<std::string>& items) {
  if (items.empty()) return "";
  std::string html = "<ul>\n";
  for (const std::string& item : items) html += fmt::format("<li>{}</li>\n", escape_html(item));
  return html + "</ul>\n";
}

std::string data_address(std::string_view type, std::string_view bytes) {
  return fmt::format("data:{};base64,{}", type, base64(bytes));
}

}  // namespace groundscale::internal
