// Plots as SVG: curves over logarithmic axes with labels beside them, and stacked bars. Nothing but text and paths; prints in black and white, too.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace lightwell::report {

struct ChartPoint {
  double x = 0, y = 0;
  std::string label;              // shown beside it where there is room, and under the pointer
  double low = 0, high = 0;       // interval of y; none where high is 0
};
struct ChartCurve {
  std::string label, color;
  bool dashed = false;            // dashed, with hollow points
  bool joined = true;             // else points alone
  std::vector<ChartPoint> points; // in order; those that are not finite and positive are left out
};
/// A level to compare with, straight across.
struct ChartLevel {
  double y = 0;
  std::string label;
};
struct Chart {
  std::string title, x_title, y_title;
  bool y_percent = true;          // numbers are shares
  std::vector<ChartCurve> curves;
  std::vector<ChartLevel> levels;
};

/// Double logarithmic. Every curve is labelled at its end, in a margin where labels cannot meet. A chart without a point says so.
std::string chartSvg(const Chart& chart);

struct BarPart {
  std::string name;
  double value = 0;
};
struct Bar {
  std::string label;
  std::vector<BarPart> parts;
  std::string note;               // after the bar
};
/// Horizontal stacked bars, each as long as its sum and cut by the shares; `unit` of values.
std::string barsSvg(const std::string& title, const std::string& x_title, const std::vector<Bar>& bars);

/// &, <, >, " and control characters as XML 1.0 and HTML want them in text and attributes.
std::string escaped(const std::string& text);
/// "0.5", "20", "3,000", "2 M", "1e-05": as few digits as tell a tick's value.
std::string tickLabel(double value);

struct LogAxis {
  double least = 1, most = 10;    // of the axis
  std::vector<double> ticks;      // with a number
  std::vector<double> lines;      // without
};
/// The axis for values from `least` to `most`, both > 0: at least 3 ticks, at most 9.
LogAxis logAxis(double least, double most);

}  // namespace lightwell::report
