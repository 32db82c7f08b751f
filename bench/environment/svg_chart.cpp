#include "bench/environment/svg_chart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lightwell::bench {
namespace {

constexpr int kPanelWidth = 250, kPanelHeight = 210, kLeft = 48, kTop = 24, kRight = 10, kBottom = 24, kLegendHeight = 46;

double place(const Axis& axis, double value, double from, double to) {
  const auto scaled = [&](double v) { return axis.logarithmic ? std::log(v) : v; };
  const double clamped = std::clamp(value, axis.least, axis.most);
  return from + (scaled(clamped) - scaled(axis.least)) / (scaled(axis.most) - scaled(axis.least)) * (to - from);
}

void printPanel(const Panel& panel, double left, double top) {
  const double right = left + kPanelWidth - kLeft - kRight, bottom = top + kPanelHeight - kTop - kBottom;
  std::printf("<text x=\"%.0f\" y=\"%.0f\" font-weight=\"bold\">%s</text>\n", left, top - 7, panel.title.c_str());
  for (const double tick : panel.x.ticks) {
    const double x = place(panel.x, tick, left, right);
    std::printf("<path d=\"M%.1f %.1fV%.1f\" stroke=\"#eee\"/><text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%g%s</text>\n", x, top, bottom, x,
                bottom + 13, tick * panel.x.factor, panel.x.suffix.c_str());
  }
  for (const double tick : panel.y.ticks) {
    const double y = place(panel.y, tick, bottom, top);
    std::printf("<path d=\"M%.1f %.1fH%.1f\" stroke=\"#ddd\"/><text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">%g%s</text>\n", left, y, right, left - 4,
                y + 4, tick * panel.y.factor, panel.y.suffix.c_str());
  }
  for (const Curve& curve : panel.curves) {
    std::printf("<polyline fill=\"none\" stroke=\"%s\" stroke-width=\"%g\" stroke-dasharray=\"%s\" points=\"", curve.style.color.c_str(),
                curve.style.width, curve.style.dash.c_str());
    for (const auto& [x, y] : curve.points) std::printf("%.1f,%.1f ", place(panel.x, x, left, right), place(panel.y, y, bottom, top));
    std::printf("\"/>\n");
  }
  double y = bottom - 5;
  for (const auto& [text, color] : panel.notes) {
    std::printf("<text x=\"%.0f\" y=\"%.0f\" font-size=\"9.5\" fill=\"%s\" stroke=\"white\" stroke-width=\"3\" paint-order=\"stroke\">%s</text>\n",
                left + 4, y, color.c_str(), text.c_str());
    y -= 11;
  }
}

}  // namespace

Axis decadesInPercent(double least, double most) {
  const auto decade = [](double power) { return std::pow(10.0, power); };
  Axis axis{decade(std::floor(std::log10(least))), decade(std::ceil(std::log10(most))), true, {}, " %", 100};
  for (double tick = axis.least; tick <= axis.most * 1.01; tick *= 10) axis.ticks.push_back(tick);
  return axis;
}

void printChart(const std::vector<Panel>& panels, int columns, const std::vector<CurveStyle>& legend, const std::string& x_label) {
  const int rows = (int(panels.size()) + columns - 1) / columns, width = columns * kPanelWidth, height = rows * kPanelHeight + kLegendHeight;
  std::printf(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" font-family=\"sans-serif\" "
      "font-size=\"10.5\">\n<rect width=\"%d\" height=\"%d\" fill=\"white\"/>\n",
      width, height, width, height, width, height);
  for (size_t p = 0; p < panels.size(); ++p)
    printPanel(panels[p], double(p % size_t(columns)) * kPanelWidth + kLeft, double(p / size_t(columns)) * kPanelHeight + kTop);
  std::printf("<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">%s</text>\n", width / 2, height - 32, x_label.c_str());
  double at = 16;
  for (const CurveStyle& style : legend) {
    std::printf("<path d=\"M%.0f %dh20\" stroke=\"%s\" stroke-width=\"%g\" stroke-dasharray=\"%s\"/><text x=\"%.0f\" y=\"%d\">%s</text>\n", at,
                height - 12, style.color.c_str(), style.width, style.dash.c_str(), at + 25, height - 8, style.label.c_str());
    at += 42 + 5.6 * double(style.label.size());
  }
  std::printf("</svg>\n");
}

}  // namespace lightwell::bench
