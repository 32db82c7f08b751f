#include "cli/report/plots.h"

#include <algorithm>
#include <functional>

#include "cli/report/chart.h"
#include "cli/report/ladder.h"
#include "cli/report/line_fit.h"
#include "cli/report/live.h"

namespace lightwell::report {
namespace {

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g %%", 100 * share);
  return text;
}

ChartPoint pointOf(const Report& report, double x, const Evaluated& e, std::string label) {
  const bool resolved = e.relrmse > 0;
  return {x, shownError(report, e), (resolved ? "" : "under ") + label, std::max(e.relrmse_low, 0.0), resolved ? e.relrmse_high : 0};
}

void sortByX(ChartCurve& curve) {
  std::stable_sort(curve.points.begin(), curve.points.end(), [](const ChartPoint& a, const ChartPoint& b) { return a.x < b.x; });
}

std::vector<ChartLevel> floorOf(const Report& report) {
  return {{report.reference.noise, "noise of the reference, which errors are free of: " + percent(report.reference.noise)},
          {report.reference.resolution, "smallest error to be told from none: " + percent(report.reference.resolution)}};
}

Chart errorChart(const Report& report, std::string title, std::string x_title) {
  return {.title = std::move(title), .x_title = std::move(x_title), .y_title = "error of indirect light (relrmse)", .y_percent = true, .curves = {}, .levels = floorOf(report)};
}

/// One curve a series, of the first evaluation of each bake; `x` is NaN for a bake without one.
Chart byBake(const Report& report, std::string title, std::string x_title, const std::function<double(const Baked&)>& x, bool slopes) {
  Chart chart = errorChart(report, std::move(title), std::move(x_title));
  for (const Series& series : allSeries()) {
    ChartCurve curve{.label = std::string(series.title), .color = std::string(series.color), .dashed = series.baseline, .joined = series.name != "given", .points = {}};
    for (const Baked& baked : report.bakes)
      if (baked.series == series.name && !baked.evaluated.empty())
        if (const double at = x(baked); at > 0) curve.points.push_back(pointOf(report, at, baked.evaluated[0], baked.setting));
    if (curve.points.empty()) continue;
    sortByX(curve);
    if (slopes) {
      std::vector<std::pair<double, double>> points;
      for (const ChartPoint& point : curve.points) points.push_back({point.x, point.y});
      if (const auto law = fitPowerLaw(points)) {
        char text[48];
        std::snprintf(text, sizeof text, ", slope %.2f", law->slope);
        curve.label += text;
      }
    }
    chart.curves.push_back(std::move(curve));
  }
  return chart;
}

/// Curves over what differs at run time: settings of a technique's bakes, numbers of panes, bounces a frame.
Chart byFrame(const Report& report, std::string title, std::string x_title, const std::function<std::optional<double>(const Evaluated&)>& x) {
  Chart chart = errorChart(report, std::move(title), std::move(x_title));
  for (const Series& series : allSeries()) {
    ChartCurve settings{.label = std::string(series.title), .color = std::string(series.color), .dashed = series.baseline, .joined = series.name != "given", .points = {}}, variants = settings;
    for (const Baked& baked : report.bakes) {
      if (baked.series != series.name) continue;
      for (size_t i = 0; i < baked.evaluated.size(); ++i) {
        const auto at = x(baked.evaluated[i]);
        if (!at || !(*at > 0)) continue;
        const bool of_bakes = i == 0 && series.name != "prm-paper";  // panes: one bake, summed in several ways
        if (of_bakes) settings.points.push_back(pointOf(report, *at, baked.evaluated[i], baked.setting));
        else if (baked.setting == "production" || series.name == "given") variants.points.push_back(pointOf(report, *at, baked.evaluated[i], baked.evaluated[i].variant));
      }
    }
    if (series.name == "radiosity") variants.label = "radiosity, all bounces anew in each frame", variants.dashed = false, settings.label = "radiosity, one bounce more a frame, settled";
    if (series.name == "prm-paper") variants.label += ", production, by number of panes";
    for (ChartCurve* curve : {&settings, &variants})
      if (!curve->points.empty()) sortByX(*curve), chart.curves.push_back(*curve);
  }
  return chart;
}

bool empty(const Chart& chart) { return chart.curves.empty(); }

Chart byLoad(const Report& report) {
  Chart chart = errorChart(report, "Error against the time until the light is there, OpenGL", "milliseconds of drawing, once");
  for (const char* name : {"vpl", "vpl-points"}) {
    const Series& series = seriesNamed(name);
    ChartCurve curve{.label = std::string(series.title) + ", shadow maps", .color = std::string(series.color), .dashed = series.baseline, .joined = true, .points = {}};
    for (const Baked& baked : report.bakes)
      for (const Evaluated& e : baked.evaluated)
        if (baked.series == name && e.variant == "OpenGL" && e.load_ms) curve.points.push_back(pointOf(report, *e.load_ms, e, baked.setting));
    if (!curve.points.empty()) sortByX(curve), chart.curves.push_back(curve);
  }
  return chart;
}

Chart byBytes(const Report& report) {
  Chart chart = byBake(report, "Error against size", "bytes of the section in the container", [](const Baked& b) { return double(b.section_bytes); }, false);
  ChartCurve uncompressed{.label = "uncompressed form factors", .color = "#57b894", .dashed = true, .joined = true, .points = {}};
  for (const Baked& baked : report.bakes)
    if (baked.series == "radiosity-uniform" && baked.uncompressed_bytes && !baked.evaluated.empty())
      uncompressed.points.push_back(pointOf(report, double(*baked.uncompressed_bytes), baked.evaluated[0], baked.setting));
  if (!uncompressed.points.empty()) sortByX(uncompressed), chart.curves.push_back(uncompressed);
  return chart;
}

Chart byTextures(const Report& report) {
  return byFrame(report, "Error against texture memory, OpenGL", "bytes of textures", [](const Evaluated& e) { return e.texture_bytes ? std::optional(double(*e.texture_bytes)) : std::nullopt; });
}

std::string phases(const Report& report) {
  std::vector<Bar> bars;
  std::vector<const Baked*> by_series;
  for (const Series& series : allSeries())
    for (const Baked& baked : report.bakes)
      if (baked.series == series.name && baked.seconds) by_series.push_back(&baked);
  for (const Baked* one : by_series) {
    const Baked& baked = *one;
    Bar bar{std::string(seriesNamed(baked.series).name) + ", " + baked.setting, {}, ""};
    for (const Phase& phase : baked.phases) bar.parts.push_back({phase.name, phase.seconds});
    char text[64];
    std::snprintf(text, sizeof text, "%.3g s", *baked.seconds);
    bar.note = text;
    if (report.rays && report.rays->raw_mrays > 0 && baked.rays && *baked.rays > 0) {
      const double rate = 1e-6 * double(*baked.rays) / *baked.seconds / report.threads;
      std::snprintf(text, sizeof text, ", %.2g Mray/s, %.0f %% of raw", rate, 100 * rate / report.rays->raw_mrays);
      bar.note += text;
    }
    bars.push_back(bar);
  }
  return bars.empty() ? "" : barsSvg("Where bake time goes", "seconds; rays per second and thread, as a share of raw Embree’s on this scene", bars);
}

Chart skyChart(const Report& report, uint32_t shininess, bool by_seconds) {
  Chart chart{.title = shininess == 1 ? "The sky alone: diffuse light" : "The sky alone: gloss of shininess 100",
              .x_title = by_seconds ? "seconds of the bake" : "cells: shadowed directional lights that a game draws", .y_title = "error (rms of all directions)", .y_percent = true, .curves = {}, .levels = {}};
  const struct { const char *model, *label, *color; bool dashed; } models[] = {{"sky", "sky nodes and suns (unshadowed)", "#0068b0", false}, {"spread", "cells, spread", "#00845f", false},
                                                                               {"paper", "cells, paper’s blend", "#e79a5b", true}, {"one sample", "one sample a cell", "#c24e00", true},
                                                                               {"shadowed, rays", "shadowed on the surfaces, rays", "#222222", false}, {"shadowed, OpenGL", "shadowed, OpenGL’s depth maps", "#8a3c8f", false}};
  for (const auto& model : models) {
    ChartCurve curve{.label = model.label, .color = model.color, .dashed = model.dashed, .joined = true, .points = {}};
    for (const SkyAnswer& answer : report.sky)
      if (answer.model == model.model && answer.shininess == shininess)
        curve.points.push_back({by_seconds ? answer.seconds : double(answer.cells), answer.relrmse, by_seconds ? std::to_string(answer.cells) : "", 0, 0});
    if (curve.points.empty()) continue;
    std::vector<std::pair<double, double>> points;
    for (const ChartPoint& point : curve.points) points.push_back({point.x, point.y});
    if (const auto law = fitPowerLaw(points); law && !by_seconds && law->slope < -0.05) {
      char text[48];
      std::snprintf(text, sizeof text, ", slope %.2f", law->slope);
      curve.label += text;
    }
    sortByX(curve);
    chart.curves.push_back(curve);
  }
  return chart;
}

/// Of `lights` each, or with shadow maps of `side` each; over one of them, or over milliseconds.
Chart lampChart(const Report& report, std::string title, std::string x_title, const std::function<bool(const LampAnswer&)>& of, const std::function<double(const LampAnswer&)>& x,
                const std::function<std::string(const LampAnswer&)>& label) {
  Chart chart{.title = std::move(title), .x_title = std::move(x_title), .y_title = "error after one reflection (relrmse)", .y_percent = true, .curves = {}, .levels = {}};
  for (const bool incremental : {false, true}) {
    ChartCurve curve{.label = incremental ? "incremental lights" : "lights anew in each frame", .color = incremental ? "#00845f" : "#c24e00", .dashed = false, .joined = true, .points = {}};
    for (const LampAnswer& answer : report.live_lamps)
      if (answer.incremental == incremental && of(answer)) curve.points.push_back({x(answer), answer.relrmse, label(answer), 0, 0});
    if (!curve.points.empty()) sortByX(curve), chart.curves.push_back(curve);
  }
  return chart;
}

}  // namespace

double shownError(const Report& report, const Evaluated& e) { return e.relrmse > 0 ? e.relrmse : report.reference.resolution; }

std::vector<Plot> plotsOf(const Report& report) {
  std::vector<Plot> plots;
  const auto add = [&](const char* file, const char* chapter, const Chart& chart, const char* caption) {
    if (!empty(chart)) plots.push_back({file, chapter, caption, chartSvg(chart)});
  };
  add("error_by_bake_seconds.svg", "bake",
      byBake(report, "Error against bake time", "seconds of the bake: import, atlas and all tasks", [](const Baked& b) { return b.seconds.value_or(0); }, true),
      "How far indirect light is off, against the time that the bake took; both axes are logarithmic. Down and to the left is better. Dashed lines are the ways of the papers that Lightwell builds on. "
      "A slope of −0.5 is what plain Monte Carlo gives: half the error for four times the work. Thin vertical lines are 95 % intervals.");
  if (const std::string svg = phases(report); !svg.empty())
    plots.push_back({"bake_phases.svg", "bake",
                     "The parts of each bake. Import, atlas and the tracer’s tree are shared by all bakes of this report and counted in each of them. Rays per second count the whole bake, not only the time spent on rays.", svg});
  add("error_by_bytes.svg", "size", byBytes(report),
      "The same errors against the bytes that a game ships. Uncompressed form factors are what radiosity would store without links: 8 bytes for each pair of patches that see each other.");
  add("error_by_texture_memory.svg", "size", byTextures(report), "Memory of the graphics card, atlases included.");
  add("error_by_frame_ms_gl.svg", "frame",
      byFrame(report, "Error against time per frame, OpenGL", "milliseconds per frame, one lamp has moved", [](const Evaluated& e) { return e.gl_ms; }),
      "What a frame costs in which one lamp has moved: its light at entry points or patches, and from there to every texel. By quality of the bake, by number of panes that are summed, and by bounces that are done anew. "
      "A light map costs nothing in a frame, and neither do virtual lights once they are drawn. Without a graphics card OpenGL runs on the processor (llvmpipe): compare, but do not take the milliseconds for a game’s.");
  add("error_by_frame_ms_cpu.svg", "frame", byFrame(report, "Error against time per frame, CPU", "milliseconds per frame, one lamp has moved, one thread", [](const Evaluated& e) { return e.cpu_ms; }),
      "The same on the processor, without shadow rays, which are the game’s.");
  add("error_by_fetched_bytes.svg", "frame",
      byFrame(report, "Error against bytes read per frame", "bytes for each texel of the atlas", [](const Evaluated& e) { return e.fetched_bytes_per_texel; }),
      "What a frame reads of the decoded container, shared data spread over all texels: what bounds the speed on a graphics card.");
  add("error_by_load_ms.svg", "load", byLoad(report), "Virtual lights are drawn once, while a level loads; each light has a shadow map of its own. Light is there piece by piece, from the first light on.");
  const auto of_counts = [](const LampAnswer& a) { return a.shadow_side == kLampShadowSide; };
  const auto of_sides = [](const LampAnswer& a) { return a.lights == kLampLights; };
  const auto count = [](const LampAnswer& a) { return std::to_string(a.lights); };
  add("lamps_by_lights.svg", "live", lampChart(report, "Error against the number of virtual lights", "virtual lights of each lamp", of_counts, [](const LampAnswer& a) { return double(a.lights); }, [](const LampAnswer&) { return ""; }),
      "The first reflection of lamps that nothing was baked for (lightwell_dynamic), against path tracing that ends there: reflective shadow maps, virtual lights, imperfect shadow maps of 32 × 32 texels.");
  add("lamps_by_shadow_map.svg", "live", lampChart(report, "Error against the size of shadow maps", "texels along the shadow map of each of 256 virtual lights", [&](const LampAnswer& a) { return of_sides(a) && a.shadow_side > 0; },
                                                   [](const LampAnswer& a) { return double(a.shadow_side); }, [](const LampAnswer&) { return ""; }),
      "The same by the size of the virtual lights’ own shadow maps.");
  add("lamps_by_frame_ms.svg", "live", lampChart(report, "Error against time per frame", "milliseconds per frame on OpenGL, one lamp has moved", of_counts, [](const LampAnswer& a) { return a.gl_ms; }, count),
      "What a frame costs in which one lamp has moved: its views, its virtual lights and their shadow maps, and all texels of the atlas. Numbers are virtual lights. Incremental ones are placed anew sixteen a frame.");
  for (const uint32_t shininess : {1u, 100u})
    add(shininess == 1 ? "sky_diffuse_by_cells.svg" : "sky_glossy_by_cells.svg", "sky", skyChart(report, shininess, false),
        "The light of the whole sky without anything in the way, against quadrature over the map. The nodes answer light without shadows; the cells are what shadows are cast with; how well these light the scene’s surfaces is compared with path tracing there.");
  add("sky_glossy_by_seconds.svg", "sky", skyChart(report, 100, true), "The same against the time of the bake; numbers are cells.");
  return plots;
}

}  // namespace lightwell::report
