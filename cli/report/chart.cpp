#include "cli/report/chart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lightwell::report {
namespace {

constexpr double kWidth = 760, kHeight = 430, kLeft = 70, kRight = 210, kTop = 36, kBottom = 54;
constexpr double kFont = 12, kSmall = 10.5, kLine = 15;
constexpr const char* kInk = "#222", *kSoft = "#666", *kGrid = "#e4e4e4";

template <class... Args>
std::string format(const char* text, Args... arguments) {
  char buffer[1024];
  std::snprintf(buffer, sizeof buffer, text, arguments...);
  return buffer;
}

bool usable(const ChartPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y) && p.x > 0 && p.y > 0; }

/// About what a proportional font takes; UTF-8 continuation bytes take nothing.
double widthOf(const std::string& text, double size) {
  double characters = 0;
  for (const char c : text) characters += (c & 0xc0) != 0x80;
  return characters * size * 0.56;
}

std::string textAt(double x, double y, const std::string& text, const char* anchor = "start", double size = kFont, const std::string& color = kInk, const char* more = "") {
  return format("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" font-size=\"%g\" fill=\"%s\"%s>", x, y, anchor, size, color.c_str(), more) + escaped(text) + "</text>\n";
}

std::string header(double width, double height, const std::string& title) {
  return format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f %.0f\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\" role=\"img\">\n", width,
                height, width, height) +
         "<title>" + escaped(title) + "</title>\n" + format("<rect width=\"%.0f\" height=\"%.0f\" fill=\"white\"/>\n", width, height);
}

struct Box {
  double left, top, right, bottom;
  bool meets(const Box& other) const { return left < other.right && other.left < right && top < other.bottom && other.top < bottom; }
};

class Plot {
 public:
  explicit Plot(const Chart& chart) : chart_(chart) {}

  std::string draw() {
    std::string svg = header(kWidth, kHeight, chart_.title) + textAt(kLeft, 20, chart_.title, "start", 14, kInk, " font-weight=\"bold\"");
    if (!findRange()) return svg + textAt(kWidth / 2, kHeight / 2, "nothing was measured for this plot", "middle", kFont, kSoft) + "</svg>\n";
    svg += axes() + levels();
    // Points keep labels off themselves, their own and others'.
    for (const ChartCurve& curve : chart_.curves)
      for (const ChartPoint& p : curve.points)
        if (usable(p)) taken_.push_back({x(p.x) - 5, y(p.y) - 5, x(p.x) + 5, y(p.y) + 5});
    for (const ChartCurve& curve : chart_.curves) svg += line(curve);
    for (const ChartCurve& curve : chart_.curves) svg += markers(curve);
    for (const ChartCurve& curve : chart_.curves) svg += pointLabels(curve);
    return svg + curveLabels() + "</svg>\n";
  }

 private:
  double x(double value) const { return kLeft + (std::log(value) - std::log(x_.least)) / (std::log(x_.most) - std::log(x_.least)) * (kWidth - kLeft - kRight); }
  double y(double value) const { return kHeight - kBottom - (std::log(std::clamp(value, y_.least, y_.most)) - std::log(y_.least)) / (std::log(y_.most) - std::log(y_.least)) * (kHeight - kTop - kBottom); }

  bool findRange() {
    double x_low = INFINITY, x_high = 0, y_low = INFINITY, y_high = 0;
    for (const ChartCurve& curve : chart_.curves)
      for (const ChartPoint& p : curve.points)
        if (usable(p)) x_low = std::min(x_low, p.x), x_high = std::max(x_high, p.x), y_low = std::min(y_low, p.y), y_high = std::max(y_high, p.y);
    if (!(x_high > 0)) return false;
    for (const ChartLevel& level : chart_.levels)
      if (level.y > y_low / 20 && level.y > 0) y_low = std::min(y_low, level.y), y_high = std::max(y_high, level.y);
    x_ = logAxis(x_low, x_high), y_ = logAxis(y_low, y_high);
    return true;
  }

  std::string axes() const {
    std::string svg;
    const double bottom = kHeight - kBottom, right = kWidth - kRight;
    for (const double tick : x_.lines) svg += format("<path d=\"M%.1f %.1fV%.1f\" stroke=\"%s\" stroke-width=\"0.5\"/>\n", x(tick), kTop, bottom, kGrid);
    for (const double tick : y_.lines) svg += format("<path d=\"M%.1f %.1fH%.1f\" stroke=\"%s\" stroke-width=\"0.5\"/>\n", kLeft, y(tick), right, kGrid);
    for (const double tick : x_.ticks) {
      svg += format("<path d=\"M%.1f %.1fV%.1f\" stroke=\"#ccc\"/>\n", x(tick), kTop, bottom);
      svg += textAt(x(tick), bottom + 16, tickLabel(tick), "middle", 11);
    }
    for (const double tick : y_.ticks) {
      svg += format("<path d=\"M%.1f %.1fH%.1f\" stroke=\"#ccc\"/>\n", kLeft, y(tick), right);
      svg += textAt(kLeft - 6, y(tick) + 4, tickLabel(chart_.y_percent ? 100 * tick : tick) + (chart_.y_percent ? " %" : ""), "end", 11);
    }
    svg += format("<path d=\"M%.1f %.1fV%.1fH%.1f\" fill=\"none\" stroke=\"#888\"/>\n", kLeft, kTop, bottom, right);
    svg += textAt((kLeft + right) / 2, kHeight - 14, chart_.x_title, "middle");
    const double middle = (kTop + bottom) / 2;
    return svg + format("<text transform=\"translate(16 %.1f) rotate(-90)\" text-anchor=\"middle\" font-size=\"%g\" fill=\"%s\">", middle, kFont, kInk) + escaped(chart_.y_title) + "</text>\n";
  }

  std::string levels() {
    std::string svg;
    for (const ChartLevel& level : chart_.levels) {
      if (!(level.y >= y_.least && level.y <= y_.most)) continue;
      svg += format("<path d=\"M%.1f %.1fH%.1f\" stroke=\"#444\" stroke-width=\"1.2\" stroke-dasharray=\"2 3\"/>\n", kLeft, y(level.y), kWidth - kRight);
      ends_.push_back({y(level.y), kWidth - kRight, level.label, kSoft});
    }
    return svg;
  }

  std::string line(const ChartCurve& curve) {
    std::string path;
    const ChartPoint* last = nullptr;
    for (const ChartPoint& p : curve.points) {
      if (!usable(p)) continue;
      path += format("%s%.1f %.1f", path.empty() ? "M" : "L", x(p.x), y(p.y));
      if (!last || p.x >= last->x) last = &p;
    }
    if (!last) return "";
    ends_.push_back({y(last->y), x(last->x), curve.label, curve.color});
    if (!curve.joined) return "";
    return "<path d=\"" + path + "\" fill=\"none\" stroke=\"" + curve.color + "\" stroke-width=\"2\"" + (curve.dashed ? " stroke-dasharray=\"6 4\"" : "") + "/>\n";
  }

  std::string markers(const ChartCurve& curve) const {
    std::string svg;
    for (const ChartPoint& p : curve.points) {
      if (!usable(p)) continue;
      if (p.high > 0) {
        const double low = std::max(p.low, y_.least), high = std::min(p.high, y_.most);
        svg += format("<path d=\"M%.1f %.1fV%.1f\" stroke=\"%s\" stroke-width=\"1\" opacity=\"0.6\"/>\n", x(p.x), y(low), y(high), curve.color.c_str());
      }
      svg += format("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3.6\" fill=\"%s\" stroke=\"%s\" stroke-width=\"1.6\"><title>", x(p.x), y(p.y), curve.dashed ? "white" : curve.color.c_str(), curve.color.c_str());
      svg += escaped(curve.label + (p.label.empty() ? "" : ", " + p.label)) + "</title></circle>\n";
    }
    return svg;
  }

  /// Beside, above or below its point, where nothing else stands; nowhere when all is taken.
  std::string pointLabels(const ChartCurve& curve) {
    std::string svg;
    for (const ChartPoint& p : curve.points) {
      if (!usable(p) || p.label.empty()) continue;
      const double width = widthOf(p.label, kSmall), px = x(p.x), py = y(p.y);
      const std::pair<double, double> places[] = {{px + 7, py - 5}, {px + 7, py + 13}, {px - width - 7, py - 5}, {px - width - 7, py + 13}, {px - width / 2, py - 9}, {px - width / 2, py + 17}};
      for (const auto& [left, base] : places) {
        const Box box{left - 1, base - kSmall, left + width + 1, base + 3};
        if (box.left < kLeft + 1 || box.right > kWidth - kRight - 1 || box.top < kTop || box.bottom > kHeight - kBottom) continue;
        if (std::any_of(taken_.begin(), taken_.end(), [&](const Box& other) { return box.meets(other); })) continue;
        taken_.push_back(box);
        svg += textAt(left, base, p.label, "start", kSmall, curve.color, " stroke=\"white\" stroke-width=\"3\" paint-order=\"stroke\"");
        break;
      }
    }
    return svg;
  }

  /// Names in the right margin, pushed apart, with a thin line to where they belong.
  std::string curveLabels() {
    std::sort(ends_.begin(), ends_.end(), [](const End& a, const End& b) { return a.y < b.y; });
    std::vector<std::vector<std::string>> lines;
    std::vector<double> middle, half;
    for (const End& end : ends_) {
      lines.push_back(wrapped(end.label));
      half.push_back(0.5 * kLine * double(lines.back().size()) + 2);
      middle.push_back(end.y);
    }
    for (int round = 0; round < 200; ++round)  // relaxation: few labels
      for (size_t i = 0; i < middle.size(); ++i) {
        if (i + 1 < middle.size())
          if (const double overlap = middle[i] + half[i] + half[i + 1] - middle[i + 1]; overlap > 0) middle[i] -= overlap / 2, middle[i + 1] += overlap / 2;
        middle[i] = std::clamp(middle[i], kTop + half[i], kHeight - 6 - half[i]);
      }
    std::string svg;
    const double left = kWidth - kRight + 24;
    for (size_t i = 0; i < ends_.size(); ++i) {
      svg += format("<path d=\"M%.1f %.1fL%.1f %.1f\" stroke=\"%s\" stroke-width=\"0.7\" opacity=\"0.55\"/>\n", ends_[i].x + 5, ends_[i].y, left - 4, middle[i], ends_[i].color.c_str());
      for (size_t k = 0; k < lines[i].size(); ++k) svg += textAt(left, middle[i] - half[i] + kLine * double(k) + 13, lines[i][k], "start", kFont, ends_[i].color);
    }
    return svg;
  }

  static std::vector<std::string> wrapped(const std::string& text) {
    std::vector<std::string> lines{""};
    for (size_t i = 0; i < text.size();) {
      const size_t end = std::min(text.find(' ', i), text.size());
      const std::string word = text.substr(i, end - i);
      if (!lines.back().empty() && widthOf(lines.back() + " " + word, kFont) > kRight - 30) lines.emplace_back();
      lines.back() += (lines.back().empty() ? "" : " ") + word;
      i = end + 1;
    }
    return lines;
  }

  struct End {
    double y, x;
    std::string label, color;
  };
  const Chart& chart_;
  LogAxis x_, y_;
  std::vector<Box> taken_;
  std::vector<End> ends_;
};

constexpr const char* kPartColors[] = {"#0068b0", "#e79a5b", "#00845f", "#8a3c8f", "#c9b037", "#7a7a7a", "#5aa7d8", "#a33b3b", "#57b894", "#333333"};

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t' ? ' ' : c;
    }
  }
  return out;
}

std::string tickLabel(double value) {
  if (value >= 1e9) return format("%.4g G", 1e-9 * value);
  if (value >= 1e6) return format("%.4g M", 1e-6 * value);
  if (value > 0 && value < 1e-4) return format("%.3g", value);
  const std::string digits = format("%.6g", value);
  if (value < 1000 || digits.find('.') != std::string::npos) return digits;
  std::string text;
  for (size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

LogAxis logAxis(double least, double most) {
  LogAxis axis;
  axis.least = least / 1.15, axis.most = most * 1.15;
  if (axis.most < 4 * axis.least) {
    const double middle = std::sqrt(axis.least * axis.most);
    axis.least = middle / 2, axis.most = middle * 2;
  }
  const double decades = std::log10(axis.most / axis.least);
  const auto from = [&](std::initializer_list<double> digits, std::vector<double>& into) {
    for (int power = int(std::floor(std::log10(axis.least))) - 1; power <= int(std::ceil(std::log10(axis.most))); ++power)
      for (const double digit : digits)
        if (const double value = digit * std::pow(10.0, power); value >= axis.least && value <= axis.most) into.push_back(value);
  };
  if (decades <= 2.2) from({1, 2, 5}, axis.ticks);
  else if (decades <= 4) from({1, 3}, axis.ticks);
  else from({1}, axis.ticks);
  if (axis.ticks.size() < 3) axis.ticks.clear(), from({1, 1.5, 2, 3, 4, 5, 7}, axis.ticks);
  if (axis.ticks.size() > 9) {
    std::vector<double> every;
    for (size_t i = 0; i < axis.ticks.size(); i += (axis.ticks.size() + 8) / 9) every.push_back(axis.ticks[i]);
    axis.ticks = every;
  }
  if (decades <= 4) from({1, 2, 3, 4, 5, 6, 7, 8, 9}, axis.lines);
  return axis;
}

std::string chartSvg(const Chart& chart) { return Plot(chart).draw(); }

std::string barsSvg(const std::string& title, const std::string& x_title, const std::vector<Bar>& bars) {
  constexpr double kLabels = 210, kNotes = 190, kRow = 24, kBarHeight = 15;
  std::vector<std::string> names;  // in the order of their sum
  double longest = 0;
  std::vector<double> sums;
  for (const Bar& bar : bars) {
    double sum = 0;
    for (const BarPart& part : bar.parts) {
      sum += part.value;
      const auto known = std::find(names.begin(), names.end(), part.name);
      if (known == names.end()) names.push_back(part.name), sums.push_back(part.value);
      else sums[size_t(known - names.begin())] += part.value;
    }
    longest = std::max(longest, sum);
  }
  std::vector<size_t> order(names.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return sums[a] > sums[b]; });
  const auto colorOf = [&](const std::string& name) {
    for (size_t i = 0; i < order.size(); ++i)
      if (names[order[i]] == name) return kPartColors[std::min(i, std::size(kPartColors) - 1)];
    return kPartColors[0];
  };
  const double legend_top = kTop + double(bars.size()) * kRow + 42;
  std::string legend;
  double at = kLabels, row = 0;
  for (size_t i = 0; i < order.size() && i < std::size(kPartColors); ++i) {
    const std::string name = i + 1 == std::size(kPartColors) && order.size() > i + 1 ? "others" : names[order[i]];
    const double width = widthOf(name, 11) + 34;
    if (at + width > kWidth) at = kLabels, ++row;
    legend += format("<rect x=\"%.1f\" y=\"%.1f\" width=\"11\" height=\"11\" fill=\"%s\"/>\n", at, legend_top + row * 18 - 10, kPartColors[i]) + textAt(at + 16, legend_top + row * 18, name, "start", 11);
    at += width;
  }
  std::string svg = header(kWidth, legend_top + row * 18 + 12, title) + textAt(12, 20, title, "start", 14, kInk, " font-weight=\"bold\"");
  const double scale = longest > 0 ? (kWidth - kLabels - kNotes) / longest : 0;
  for (size_t b = 0; b < bars.size(); ++b) {
    const double top = kTop + double(b) * kRow;
    double x = kLabels;
    svg += textAt(kLabels - 8, top + 12, bars[b].label, "end", 11);
    for (const BarPart& part : bars[b].parts) {
      const double width = part.value * scale;
      svg += format("<rect x=\"%.2f\" y=\"%.1f\" width=\"%.2f\" height=\"%.1f\" fill=\"%s\"><title>", x, top, std::max(width, 0.0), kBarHeight, colorOf(part.name)) +
             escaped(part.name + ": " + tickLabel(std::round(1000 * part.value) / 1000)) + "</title></rect>\n";
      x += width;
    }
    svg += textAt(x + 6, top + 12, bars[b].note, "start", 11, kSoft);
  }
  svg += textAt(kLabels, kTop + double(bars.size()) * kRow + 14, x_title, "start", 11, kSoft);
  return svg + legend + "</svg>\n";
}

}  // namespace lightwell::report
