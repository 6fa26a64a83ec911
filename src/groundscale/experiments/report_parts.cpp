#include "groundscale/experiments/report_parts.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "groundscale/report/markdown.hpp"

namespace groundscale {

bool write_figures(const std::string& output, std::vector<Plot>& plots, std::vector<std::string>& problems) {
  plots.erase(std::remove_if(plots.begin(), plots.end(), [](const Plot& plot) { return !has_points(plot); }),
              plots.end());
  const std::string folder = (std::filesystem::path(output) / "figures").string();
  const bool draw = gnuplot_is_there();
  if (!draw) {
    problems.push_back(
        fmt::format("the figures are not drawn, because gnuplot can't be run: once it is installed "
                    "(Debian: gnuplot-nox), the same command draws them"));
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  bool drawn = draw;
  for (const Plot& plot : plots) {
    const auto written = write_plot(folder, plot, draw);
    if (written) continue;
    problems.push_back(written.error().message);
    drawn = false;
  }
  return drawn;
}

std::string figures_section(const std::vector<Plot>& plots, bool drawn) {
  if (plots.empty()) return {};
  std::string text = "## Figures\n\nEach has its data (`.csv`) and script (`.gp`) beside it in `figures`.\n\n";
  for (const Plot& plot : plots) {
    text += drawn ? fmt::format("![{0}](figures/{1}.svg)\n\n", plot.title, plot.name)
                  : fmt::format("- {}: not drawn, `figures/{}.gp`\n", plot.title, plot.name);
  }
  return drawn ? text : text + "\n";
}

Result<void> write_report(const std::string& path, const std::string& markdown) {
  return write_markdown_report(path, markdown);
}

std::string bullet_list(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += fmt::format("- {}\n", item);
  return text.empty() ? text : text + "\n";
}

std::string distinct(const std::vector<std::string>& items) {
  std::vector<std::string> once;
  for (const std::string& item : items) {
    if (std::find(once.begin(), once.end(), item) == once.end()) once.push_back(item);
  }
  return fmt::format("{}", fmt::join(once, "; "));
}

}  // namespace groundscale
