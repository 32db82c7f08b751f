// Panels of curves over logarithmic or linear axes, as SVG on stdout.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace lightwell::bench {

struct Axis {
  double least, most;
  bool logarithmic;
  std::vector<double> ticks;
  std::string suffix;   // of the ticks' labels
  double factor = 1;    // of the numbers on them
};
/// Decades from the one below `least` to the one above `most`, labelled in percent.
Axis decadesInPercent(double least, double most);

struct CurveStyle {
  std::string label, color, dash;
  double width = 1.8;
};
struct Curve {
  CurveStyle style;
  std::vector<std::pair<double, double>> points;
};
struct Panel {
  std::string title;
  Axis x, y;
  std::vector<Curve> curves;
  std::vector<std::pair<std::string, std::string>> notes;  // text and colour, from the bottom left upwards
};

/// Panels in rows of `columns`, a legend below.
void printChart(const std::vector<Panel>& panels, int columns, const std::vector<CurveStyle>& legend, const std::string& x_label);

}  // namespace lightwell::bench
