// Draws what environment_error wrote: error against the number of cells, a panel per map, both axes logarithmic.
//   environment_plot SHININESS < errors.csv > error.svg
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace {

constexpr int kPanelWidth = 380, kPanelHeight = 260, kMargin = 56;
constexpr double kLeastCells = 8, kMostCells = 1024;

struct Style {
  const char *model, *label, *color, *dash;
};
constexpr Style kStyles[] = {{"monte carlo", "importance-sampled lights", "#888888", "4 3"},
                             {"one sample", "one sample a cell", "#d08020", ""},
                             {"paper", "paper's blend", "#c03030", ""},
                             {"vmf", "vMF lobe", "#8050b0", ""},
                             {"fast spread", "spread, fast path", "#3070c0", "4 3"},
                             {"spread", "spread", "#3070c0", ""},
                             {"sky", "sky nodes and suns", "#208040", "8 4"}};

struct Axis {
  double least, most, from, to;
  double operator()(double v) const {
    return from + (std::log(std::clamp(v, least, most)) - std::log(least)) / (std::log(most) - std::log(least)) * (to - from);
  }
};

}  // namespace

int main(int argc, char** argv) {
  const std::string shininess = argc > 1 ? argv[1] : "100";
  std::vector<std::string> maps;
  std::map<std::string, std::map<std::string, std::vector<std::pair<double, double>>>> curves;  // map, model: cells, error
  double lowest = 1, highest = 1e-3;
  std::string line;
  std::getline(std::cin, line);
  while (std::getline(std::cin, line)) {
    std::vector<std::string> field;
    std::istringstream in(line);
    for (std::string f; std::getline(in, f, ',');) field.push_back(f);
    if (field.size() < 6 || field[2] != shininess) continue;
    if (std::find(maps.begin(), maps.end(), field[0]) == maps.end()) maps.push_back(field[0]);
    const double error = std::stod(field[5]);
    curves[field[0]][field[1]].push_back({std::stod(field[3]), error});
    if (error > 0) lowest = std::min(lowest, error), highest = std::max(highest, error);
  }
  lowest = std::pow(10, std::floor(std::log10(lowest)));
  highest = std::pow(10, std::ceil(std::log10(highest)));
  const int columns = 2, rows = int(maps.size() + 1) / columns, legend = 40;
  const int width = columns * kPanelWidth, height = rows * kPanelHeight + legend;
  std::printf(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" font-family=\"sans-serif\" "
      "font-size=\"11\">\n",
      width, height, width, height);
  std::printf("<rect width=\"%d\" height=\"%d\" fill=\"white\"/>\n", width, height);
  for (size_t m = 0; m < maps.size(); ++m) {
    const double left = double(m % columns) * kPanelWidth + kMargin, top = double(m / columns) * kPanelHeight + 24;
    const double right = left + kPanelWidth - kMargin - 12, bottom = top + kPanelHeight - kMargin - 8;
    const Axis x{kLeastCells, kMostCells, left, right}, y{lowest, highest, bottom, top};
    std::printf("<text x=\"%.0f\" y=\"%.0f\" font-weight=\"bold\">%s, n = %s</text>\n", left, top - 8, maps[m].c_str(), shininess.c_str());
    for (double cells = kLeastCells; cells <= kMostCells; cells *= 2)
      std::printf(
          "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"#eee\"/><text x=\"%.1f\" y=\"%.1f\" "
          "text-anchor=\"middle\">%g</text>\n",
          x(cells), top, x(cells), bottom, x(cells), bottom + 14, cells);
    for (double error = lowest; error <= highest * 1.01; error *= 10)
      std::printf(
          "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"#ddd\"/><text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">%g "
          "%%</text>\n",
          left, y(error), right, y(error), left - 5, y(error) + 4, error * 100);
    for (const Style& style : kStyles) {
      auto points = curves[maps[m]][style.model];
      if (points.empty()) continue;
      if (points.size() == 1) points = {{kLeastCells, points[0].second}, {kMostCells, points[0].second}};  // does not depend on the cells
      std::printf("<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"1.8\" stroke-dasharray=\"%s\" points=\"", style.color, style.dash);
      for (const auto& [cells, error] : points) std::printf("%.1f,%.1f ", x(cells), y(error));
      std::printf("\"/>\n");
    }
  }
  double at = 20;
  for (const Style& style : kStyles) {
    std::printf(
        "<line x1=\"%.0f\" y1=\"%d\" x2=\"%.0f\" y2=\"%d\" stroke=\"%s\" stroke-width=\"2\" stroke-dasharray=\"%s\"/><text x=\"%.0f\" "
        "y=\"%d\">%s</text>\n",
        at, height - 20, at + 18, height - 20, style.color, style.dash, at + 22, height - 16, style.label);
    at += 32 + 6.0 * double(std::string(style.label).size());
  }
  std::printf("</svg>\n");
}
