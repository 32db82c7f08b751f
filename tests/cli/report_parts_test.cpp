// The parts of lightwell report that are arithmetic or text.
#include <gmock/gmock.h>

#include <cmath>

#include "cli/report/chart.h"
#include "cli/report/line_fit.h"
#include "cli/report/pictures.h"
#include "cli/report/truth.h"

namespace lightwell::report {
namespace {

using Points = std::vector<std::pair<double, double>>;
using testing::HasSubstr;
using testing::Not;

TEST(PowerLawTest, FindsTheExponentOfAnExactLaw) {
  Points points;
  for (const double x : {0.5, 1.0, 3.0, 40.0, 900.0}) points.push_back({x, 0.7 * std::pow(x, -0.42)});
  const auto law = fitPowerLaw(points);
  ASSERT_TRUE(law);
  EXPECT_NEAR(law->slope, -0.42, 1e-12);
  EXPECT_NEAR(law->factor, 0.7, 1e-12);
  EXPECT_NEAR(law->at(10), 0.7 * std::pow(10, -0.42), 1e-12);
}

TEST(PowerLawTest, IsTheLeastSquaresLineOfTheLogarithms) {
  // (0, 0), (1, 2), (2, 1): slope 1/2, mean 1.
  const auto law = fitPowerLaw(Points{{1, 1}, {std::exp(1), std::exp(2)}, {std::exp(2), std::exp(1)}});
  ASSERT_TRUE(law);
  EXPECT_NEAR(law->slope, 0.5, 1e-12);
  EXPECT_NEAR(std::log(law->factor), 0.5, 1e-12);
}

TEST(PowerLawTest, SaysNothingOfTooLittle) {
  EXPECT_FALSE(fitPowerLaw(Points{}));
  EXPECT_FALSE(fitPowerLaw(Points{{1, 1}, {2, 2}}));
  EXPECT_FALSE(fitPowerLaw(Points{{2, 1}, {2, 2}, {2, 3}})) << "one x";
  EXPECT_FALSE(fitPowerLaw(Points{{1, 1}, {2, -1}, {3, 0}, {NAN, 1}, {4, INFINITY}, {5, 5}})) << "two are usable";
}

TEST(ChartTest, EscapesWhatXmlReserves) {
  EXPECT_EQ(escaped("a<b & \"c\" > d\x01\n"), "a&lt;b &amp; &quot;c&quot; &gt; d \n");
  const Chart chart{.title = "<t>&", .x_title = "a<b", .y_title = "\"y\"", .y_percent = true,
                    .curves = {{.label = "<script>", .color = "#000", .dashed = false, .joined = true, .points = {{1, 1, "</text>", 0, 0}, {2, 0.5, "&", 0, 0}}}}, .levels = {{0.7, "<l>"}}};
  const std::string svg = chartSvg(chart);
  for (const char* raw : {"<script>", "<t>", "a<b", "\"y\"<", "<l>"}) EXPECT_THAT(svg, Not(HasSubstr(raw)));
  EXPECT_THAT(svg, HasSubstr("&lt;script&gt;"));
}

TEST(ChartTest, AxesHaveReadableTicksForAnyRange) {
  for (const double least : {1e-9, 3e-4, 0.07, 1.0, 950.0, 2e7})
    for (const double ratio : {1.0, 1.3, 3.0, 20.0, 500.0, 1e5, 1e9}) {
      const LogAxis axis = logAxis(least, least * ratio);
      EXPECT_GE(axis.ticks.size(), 2u) << least << " " << ratio;
      EXPECT_LE(axis.ticks.size(), 9u) << least << " " << ratio;
      EXPECT_LE(axis.least, least);
      EXPECT_GE(axis.most, least * ratio);
      EXPECT_TRUE(std::is_sorted(axis.ticks.begin(), axis.ticks.end()));
    }
  EXPECT_EQ(tickLabel(0.05), "0.05");
  EXPECT_EQ(tickLabel(3000), "3,000");
  EXPECT_EQ(tickLabel(250000), "250,000");
  EXPECT_EQ(tickLabel(2e6), "2 M");
  EXPECT_EQ(tickLabel(1e-5), "1e-05");
}

TEST(ChartTest, LeavesOutWhatNoLogarithmHas) {
  Chart chart{.title = "t", .x_title = "", .y_title = "", .y_percent = true, .curves = {{.label = "c", .color = "#000", .dashed = false, .joined = true, .points = {{0, 1, "", 0, 0}, {1, -1, "", 0, 0}, {NAN, 1, "", 0, 0}}}}, .levels = {}};
  EXPECT_THAT(chartSvg(chart), HasSubstr("nothing was measured"));
  chart.curves[0].points.push_back({1, 0.1, "one", 0, 0});
  const std::string svg = chartSvg(chart);
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

TEST(PicturesTest, Base64IsRfc4648s) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\xff\xfe\x00", 3)), "//4A");
}

TEST(TruthTest, NoiseIsThatOfTheMeanAndErrorsAreFreeOfIt) {
  // r = 10 everywhere; the references are off by +1 and −1, the map by +2.
  ImageRgba first{8, 8, std::vector<std::array<float, 4>>(64, {11, 11, 11, 1})}, second{8, 8, std::vector<std::array<float, 4>>(64, {9, 9, 9, 1})}, map{8, 8, std::vector<std::array<float, 4>>(64, {12, 12, 12, 1})};
  const Truth truth{first, second};
  Reference reference;
  describeNoise(truth, reference);
  EXPECT_NEAR(reference.noise, 1 / std::sqrt(99.0), 1e-9);  // rms(A − B) / 2 over √mean AB
  Evaluated evaluated;
  compareWith(truth, map, evaluated);
  EXPECT_NEAR(evaluated.relrmse, std::sqrt(3.0 / 99), 1e-6);  // (12 − 11)(12 − 9)
  EXPECT_NEAR(evaluated.relrmse_low, evaluated.relrmse, 1e-6) << "all texels are alike";
  map.pixels[19][1] = 20;
  EXPECT_EQ(worstTexel(truth, map), std::pair(3, 2));
}

}  // namespace
}  // namespace lightwell::report
