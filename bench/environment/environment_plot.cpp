// The pictures of docs/environment.md, from what the other programs wrote.
//   environment_plot error ERRORS.csv [SHADOW.csv] > error.svg         environment_error, shadow_reference: error over the number of cells
//   environment_plot reflectivity REFLECTIVITY.csv > reflectivity.svg   environment_reflectivity: figures 5 and 6 of Barsi et al.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

#include "bench/environment/svg_chart.h"

namespace {

using namespace lightwell::bench;
using Points = std::vector<std::pair<double, double>>;

constexpr double kLeastCells = 8, kMostCells = 1024;

struct Model {
  const char* name;
  CurveStyle style;
};
const Model kModels[] = {{"monte carlo", {"importance-sampled lights", "#888888", "4 3"}},
                         {"one sample", {"one sample a cell", "#d08020", ""}},
                         {"paper", {"paper's blend", "#c03030", ""}},
                         {"vmf", {"vMF lobe", "#8050b0", ""}},
                         {"fast spread", {"spread, fast path", "#3070c0", "4 3"}},
                         {"spread", {"spread", "#3070c0", ""}},
                         {"sky", {"sky nodes and suns", "#208040", "8 4"}}};
const CurveStyle kOpenGlStyle{"shadowed, OpenGL", "#101010", ""}, kRaysStyle{"shadowed, rays", "#101010", "2 3"};

std::vector<std::map<std::string, std::string>> readCsv(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file);
  const auto split = [](const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream text(line);
    for (std::string field; std::getline(text, field, ',');) fields.push_back(field);
    return fields;
  };
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> names = split(line);
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(in, line)) {
    const std::vector<std::string> fields = split(line);
    auto& row = rows.emplace_back();
    for (size_t i = 0; i < std::min(names.size(), fields.size()); ++i) row[names[i]] = fields[i];
  }
  return rows;
}

/// Of a line fitted to the logarithms, from 16 cells on.
double slopeOf(const Points& points) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const auto& [cells, error] : points) {
    if (cells < 16 || !(error > 0)) continue;
    const double a = std::log(cells), b = std::log(error);
    n += 1, x += a, y += b, xx += a * a, xy += a * b;
  }
  return n > 1 ? (n * xy - x * y) / (n * xx - x * x) : 0;
}

std::string note(const char* label, double slope) {
  char text[64];
  std::snprintf(text, sizeof text, "%s N^%.2f", label, slope);
  return text;
}

/// One axis for all panels of a column.
void shareDecades(std::vector<Panel*> panels) {
  double least = 1, most = 1e-3;
  for (const Panel* panel : panels)
    for (const Curve& curve : panel->curves)
      for (const auto& [x, error] : curve.points)
        if (error > 0) least = std::min(least, error), most = std::max(most, error);
  for (Panel* panel : panels) panel->y = decadesInPercent(least, most);
}

void plotErrors(const std::string& errors_file, const std::string& shadow_file) {
  std::vector<std::string> maps;
  std::map<std::string, std::map<std::string, std::map<std::string, Points>>> curves;  // map, shininess, model
  for (auto& row : readCsv(errors_file)) {
    if (std::find(maps.begin(), maps.end(), row["map"]) == maps.end()) maps.push_back(row["map"]);
    curves[row["map"]][row["shininess"]][row["model"]].push_back({std::stod(row["cells"]), std::stod(row["error"])});
  }
  std::map<std::string, std::map<std::string, Points>> shadowed;  // map, evaluator
  if (!shadow_file.empty())
    for (auto& row : readCsv(shadow_file))
      if (row["component"] == "direct") shadowed[row["map"]][row["evaluator"]].push_back({std::stod(row["cells"]), std::stod(row["relrmse"])});
  const Axis cells{kLeastCells, kMostCells, true, {8, 16, 32, 64, 128, 256, 512, 1024}, "", 1};
  const std::pair<const char*, const char*> columns[] = {{"1", "diffuse"}, {"10", "n = 10"}, {"100", "n = 100"}, {"1000", "n = 1,000"}};
  const int column_count = int(std::size(columns)) + (shadowed.empty() ? 0 : 1);
  std::vector<Panel> panels;
  for (const std::string& map : maps) {
    for (const auto& [shininess, title] : columns) {
      Panel panel{map + ", " + title, cells, {}, {}, {}};
      for (const Model& model : kModels) {
        Points points = curves[map][shininess][model.name];
        if (points.empty()) continue;
        const bool fits = points.size() > 2;
        if (points.size() == 1) points = {{kLeastCells, points[0].second}, {kMostCells, points[0].second}};  // does not depend on the cells
        panel.curves.push_back({model.style, points});
        for (const char* shown : {"monte carlo", "paper", "spread"})
          if (fits && model.name == std::string(shown)) panel.notes.push_back({note(model.style.label.c_str(), slopeOf(points)), model.style.color});
      }
      panels.push_back(panel);
    }
    if (shadowed.empty()) continue;
    Panel panel{map + ", shadowed", cells, {}, {}, {}};
    for (const auto& [evaluator, style] : {std::pair{"cpu", kRaysStyle}, {"gl", kOpenGlStyle}}) {
      const Points& points = shadowed[map][evaluator];
      if (points.empty()) continue;
      panel.curves.push_back({style, points});
      panel.notes.push_back({note(style.label.c_str(), slopeOf(points)), style.color});
    }
    panels.push_back(panel);
  }
  for (int column = 0; column < column_count; ++column) {
    std::vector<Panel*> shared;
    for (size_t p = size_t(column); p < panels.size(); p += size_t(column_count)) shared.push_back(&panels[p]);
    shareDecades(shared);
  }
  std::vector<CurveStyle> legend;
  for (const Model& model : kModels) legend.push_back(model.style);
  if (!shadowed.empty()) legend.insert(legend.end(), {kOpenGlStyle, kRaysStyle});
  printChart(panels, column_count, legend, "number of cells");
}

/// The formula over quadrature, on the axes of the paper's figures.
void plotReflectivity(const std::string& file) {
  const Model* const shown[] = {&kModels[1], &kModels[2], &kModels[3], &kModels[5]};
  std::vector<Panel> panels;
  std::map<std::pair<std::string, std::string>, std::map<std::string, Points>> ratios;  // figure and shininess; model
  for (auto& row : readCsv(file))
    for (const Model* model : shown) {
      const double x = std::stod(row[row["figure"] == "5" ? "radius_rad" : "psi_rad"]), exact = std::stod(row["exact"]);
      ratios[{row["figure"], row["shininess"]}][model->name].push_back({x, exact > 0 ? std::stod(row[model->name]) / exact : 0});
    }
  for (const std::string figure : {"5", "6"})
    for (const std::string shininess : {"1", "5", "10", "100", "1000"}) {
      Panel panel{"figure " + figure + ", n = " + shininess,
                  figure == "5" ? Axis{0, 1.5708, false, {0, 0.5, 1, 1.5}, "", 1} : Axis{0, 0.3927, false, {0, 0.1, 0.2, 0.3}, "", 1},
                  {0.25, 4, true, {0.25, 0.5, 1, 2, 4}, "", 1}, {}, {}};
      for (const Model* model : shown) {
        Points visible;  // a curve ends where it leaves the panel
        for (const auto& point : ratios[{figure, shininess}][model->name])
          if (point.second >= panel.y.least && point.second <= panel.y.most) visible.push_back(point);
        panel.curves.push_back({model->style, visible});
      }
      panels.push_back(panel);
    }
  std::vector<CurveStyle> legend;
  for (const Model* model : shown) legend.push_back(model->style);
  printChart(panels, 5, legend, "figure 5: angular radius r of the cell, mirror direction at its centre; figure 6: angle of the mirror direction from the centre, r = \xcf\x80/8 (radians)");
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string what = argc > 2 ? argv[1] : "";
    if (what == "error" && argc <= 4) plotErrors(argv[2], argc == 4 ? argv[3] : "");
    else if (what == "reflectivity" && argc == 3) plotReflectivity(argv[2]);
    else throw std::invalid_argument("usage: environment_plot error ERRORS.csv [SHADOW.csv] | reflectivity REFLECTIVITY.csv");
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "environment_plot: %s\n", error.what());
    return 2;
  }
}
