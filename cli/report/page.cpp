#include "cli/report/page.h"

#include <algorithm>
#include <cmath>

#include "cli/console.h"
#include "cli/report/chart.h"
#include "cli/report/ladder.h"

namespace lightwell::report {
namespace {

namespace fs = std::filesystem;

constexpr double kNearlyBest = 1.3;

constexpr const char* kStyle = R"(
:root { color-scheme: light; }
body { font: 15px/1.5 "Helvetica Neue", Helvetica, Arial, "DejaVu Sans", sans-serif; color: #222; background: #fff; margin: 2.5em auto; max-width: 800px; padding: 0 20px; }
h1 { font-size: 1.7em; margin: 0 0 .2em; } h2 { font-size: 1.25em; margin: 2.2em 0 .6em; border-bottom: 2px solid #222; padding-bottom: .15em; } h3 { font-size: 1.05em; margin: 1.6em 0 .4em; }
p { margin: .5em 0 .8em; } .lead { color: #666; } .note { color: #666; font-size: .87em; }
figure { margin: 1.2em 0 1.8em; break-inside: avoid; } figure svg { width: 100%; height: auto; } figcaption { font-size: .87em; color: #555; margin-top: .3em; }
table { border-collapse: collapse; font-size: .82em; width: 100%; margin: .8em 0; } th { text-align: left; border-bottom: 1.5px solid #222; vertical-align: bottom; } td, th { padding: .28em .6em .28em 0; }
td { border-bottom: 1px solid #e4e4e4; vertical-align: top; } td.n, th.n { text-align: right; white-space: nowrap; } tr { break-inside: avoid; } tr.base td { color: #777; }
code, pre { font: 12.5px/1.45 "DejaVu Sans Mono", Menlo, Consolas, monospace; } pre { background: #f5f5f3; padding: .7em .9em; white-space: pre-wrap; overflow-wrap: anywhere; border-radius: 4px; margin: .4em 0; }
.dot { display: inline-block; width: .75em; height: .75em; border-radius: 50%; margin-right: .45em; vertical-align: baseline; }
.pictures { display: grid; grid-template-columns: repeat(3, 1fr); gap: 8px; break-inside: avoid; } .pictures img { width: 100%; image-rendering: pixelated; display: block; } .pictures span { font-size: .8em; color: #555; }
.card { border-left: 4px solid; padding: .1em 0 .1em 1em; margin: 1.1em 0; break-inside: avoid; } .card b.big { font-size: 1.25em; }
@media print { body { margin: 0; max-width: none; font-size: 10.5pt; } h2 { break-after: avoid; } a { color: inherit; } @page { size: A4; margin: 16mm 15mm; } }
)";

template <class... Args>
std::string format(const char* text, Args... arguments) {
  char buffer[512];
  std::snprintf(buffer, sizeof buffer, text, arguments...);
  return buffer;
}

std::string percent(double share) { return !std::isfinite(share) ? "–" : format(std::abs(share) >= 0.0995 ? "%.0f %%" : "%.2g %%", 100 * share); }
std::string signedPercent(double share) { return !std::isfinite(share) ? "–" : (share > 0 ? "+" : share < 0 ? "−" : "") + percent(std::abs(share)); }
std::string seconds(double s) { return s < 9.95 ? format("%.2g s", s) : s < 60 ? format("%.0f s", s) : cli::formatDuration(s); }
std::string ms(const std::optional<double>& value) { return !value ? "–" : *value == 0 ? "0" : format(*value < 9.95 ? "%.2g" : "%.0f", *value); }
std::string errorText(const Report& report, const Evaluated& e) {
  return e.relrmse > report.reference.resolution ? percent(e.relrmse) : "under " + percent(report.reference.resolution);
}
std::string cell(const std::string& text, bool number = true) { return std::string("<td") + (number ? " class=\"n\"" : "") + ">" + text + "</td>"; }
std::string head(std::initializer_list<const char*> names) {
  std::string row = "<tr>";
  bool first = true;
  for (const char* name : names) row += std::string("<th") + (first ? "" : " class=\"n\"") + ">" + name + "</th>", first = false;
  return row + "</tr>\n";
}
std::string dot(const Series& series) { return "<span class=\"dot\" style=\"background:" + std::string(series.color) + "\"></span>"; }

const Evaluated* onOpenGl(const Baked& baked) {
  for (const Evaluated& e : baked.evaluated)
    if (e.variant == "OpenGL") return &e;
  return nullptr;
}

/// What a technique gives here, and how to get it.
std::string card(const Report& report, const Series& series) {
  const Baked* best = recommended(report, series.name);
  if (!best) return "";
  const Evaluated& e = best->evaluated[0];
  std::string text = "<div class=\"card\" style=\"border-color:" + std::string(series.color) + "\"><h3>" + escaped(std::string(series.title)) + "</h3><p>" + escaped("For " + std::string(series.use) + ".") + "</p><p>";
  text += "<b class=\"big\">" + errorText(report, e) + "</b> off on average (" + percent(e.texrel) + " texel by texel, " + signedPercent(e.bias) + " too bright or dark overall). ";
  text += "Bakes in " + seconds(best->seconds.value_or(0)) + ", takes " + cli::formatBytes(double(best->section_bytes));
  if (e.gl_ms && *e.gl_ms > 0) text += ", and " + ms(e.gl_ms) + " ms of a frame on OpenGL" + (e.cpu_ms ? " or " + ms(e.cpu_ms) + " ms on the processor" : "");
  else if (e.cpu_ms && *e.cpu_ms > 0) text += ", and " + ms(e.cpu_ms) + " ms of a frame on the processor";
  else if (const Evaluated* gl = onOpenGl(*best); gl && gl->load_ms) text += ", and " + seconds(1e-3 * *gl->load_ms) + " to draw once on OpenGL, with " + errorText(report, *gl) + " error";
  else if (series.name == "lightmap") text += ", and nothing of a frame";
  return text + ".</p><pre>" + escaped(best->command) + "</pre></div>\n";
}

std::string comparison(const Report& report, const char* ours, const char* theirs, const char* what) {
  const Baked *a = recommended(report, ours), *b = nullptr;
  for (const Baked& baked : report.bakes)
    if (baked.series == theirs && !baked.evaluated.empty() && (!b || baked.evaluated[0].relrmse < b->evaluated[0].relrmse)) b = &baked;
  if (!a || !b) return "";
  const double mine = shownError(report, a->evaluated[0]), other = shownError(report, b->evaluated[0]);
  if (!(mine > 0) || !(other > 0)) return "";
  const double ratio = other / mine;
  return "<li>" + escaped(what) + ": " + percent(other) + " instead of " + errorText(report, a->evaluated[0]) +
         (ratio >= 1.05 ? format(", %.2g times the error", ratio) : ratio <= 0.95 ? format(", %.2g times the error", ratio) : ", about the same") + ".</li>\n";
}

std::string summary(const Report& report) {
  std::string text = "<h2>In short</h2>\n<p>Indirect light – what arrives after at least one reflection – of " + escaped(fs::path(report.scene).filename().string()) + ", on " +
                     tickLabel(double(report.texels)) + " texels, was compared with path tracing. “Off” is the rms error over the rms of the light, as <code>lightwell compare</code> prints it.</p>\n";
  if (!report.made_lights.empty()) text += "<p>" + escaped(report.made_lights.substr(0, 1) == "t" ? "T" + report.made_lights.substr(1) : report.made_lights) + ".</p>\n";
  std::string cards;
  for (const char* name : {"prm", "radiosity", "lightmap", "vpl"}) cards += card(report, seriesNamed(name));
  text += cards.empty() ? "<p>No bake ended within the budget: give more time with <code>--budget</code>.</p>\n" : cards;
  const std::string against = comparison(report, "prm", "prm-paper", "Radiance maps as published, the 32 brightest of 256 panes") +
                              comparison(report, "radiosity", "radiosity-uniform", "Radiosity with patches of one size, the best of those tried") +
                              comparison(report, "vpl", "vpl-points", "Virtual point lights, the best of those tried");
  if (!against.empty()) text += "<p>Beside the ways of the papers:</p>\n<ul>\n" + against + "</ul>\n";
  return text;
}

std::string plotsOfChapter(const std::vector<Plot>& plots, const char* chapter) {
  std::string text;
  for (const Plot& plot : plots)
    if (plot.chapter == chapter) text += "<figure>" + plot.svg + "<figcaption>" + escaped(plot.caption) + "</figcaption></figure>\n";
  return text;
}

std::string chapter(const std::vector<Plot>& plots, const char* name, const char* title, const std::string& more = "") {
  const std::string figures = plotsOfChapter(plots, name);
  return figures.empty() && more.empty() ? "" : std::string("<h2>") + title + "</h2>\n" + figures + more;
}

std::string picturesText(const fs::path& folder, const std::vector<Picture>& pictures) {
  if (pictures.empty()) return "";
  std::string text = "<h2>Pictures</h2>\n<p>The unfolded surfaces, one exposure for all. In the pictures of errors red is too bright and blue is too dark, full colour from a fifth of the light’s rms on, the same for all techniques. "
                     "Below each, the surroundings of its worst texel.</p>\n";
  for (const Picture& picture : pictures) {
    text += "<h3>" + escaped(picture.title) + "</h3>\n<div class=\"pictures\">";
    const std::pair<const std::string&, const char*> parts[] = {{picture.reference, "reference"}, {picture.result, "result"}, {picture.error, "error"}, {picture.near_reference, "reference, zoomed"},
                                                                {picture.near_result, "result, zoomed"}, {picture.near_error, "error, zoomed"}};
    for (const auto& [file, name] : parts) text += "<div><img alt=\"" + escaped(name) + "\" src=\"" + dataUri(folder / file) + "\"><span>" + escaped(name) + "</span></div>";
    text += "</div>\n<p class=\"note\">" + format("Worst texel: column %d, row %d from above, off by %s of the light’s rms, the noise of the reference included.", picture.worst_x, picture.worst_y, percent(picture.worst).c_str()) + "</p>\n";
  }
  return text;
}

std::string tables(const Report& report) {
  std::string text = "<h2>Tables</h2>\n<h3>Bakes and errors</h3>\n<table>" +
                     head({"technique and setting", "bake", "section", "relrmse", "95 %", "texrel", "bias", "p99", "max", "CPU ms", "GL ms", "textures", "B / texel"});
  for (const Series& series : allSeries())
    for (const Baked& baked : report.bakes) {
      if (baked.series != series.name) continue;
      bool first = true;
      for (const Evaluated& e : baked.evaluated) {
        text += std::string("<tr") + (series.baseline ? " class=\"base\"" : "") + ">";
        text += cell(first ? dot(series) + escaped(std::string(series.title) + ", " + baked.setting + (e.variant.empty() ? "" : ", " + e.variant)) : "&emsp;&emsp;" + escaped(e.variant), false);
        text += cell(first && baked.seconds ? seconds(*baked.seconds) : "") + cell(first ? cli::formatBytes(double(baked.section_bytes)) : "");
        text += cell(percent(e.relrmse)) + cell(percent(std::max(e.relrmse_low, 0.0)) + " to " + percent(e.relrmse_high)) + cell(percent(e.texrel)) + cell(signedPercent(e.bias));
        text += cell(percent(e.p99)) + cell(percent(e.max)) + cell(ms(e.cpu_ms)) + cell(ms(e.gl_ms));
        text += cell(e.texture_bytes ? cli::formatBytes(double(*e.texture_bytes)) : "–") + cell(e.fetched_bytes_per_texel ? tickLabel(std::round(*e.fetched_bytes_per_texel)) : "–") + "</tr>\n";
        first = false;
      }
    }
  text += "</table>\n<p class=\"note\">relrmse = rms(c − r) / rms(r); texrel = √mean(((c − r) / (r + 0.1 mean r))²); bias = mean c / mean r − 1; p99 and max are of |c − r| / rms(r). A negative relrmse says that noise hides the error.</p>\n";
  if (report.rays && report.rays->raw_mrays > 0)
    text += "<h3>Rays</h3>\n<table>" + head({"closest hits, one thread", "Mray/s", "÷ raw Embree"}) + "<tr>" + cell("raw Embree, fastest build", false) + cell(format("%.2f", report.rays->raw_mrays)) + cell("1") +
            "</tr>\n<tr>" + cell("raw Embree, robust: no ray slips through an edge", false) + cell(format("%.2f", report.rays->raw_robust_mrays)) + cell(format("%.2f", report.rays->raw_robust_mrays / report.rays->raw_mrays)) +
            "</tr>\n<tr>" + cell("this tracer, robust, with masks and glass", false) + cell(format("%.2f", report.rays->tracer_mrays)) + cell(format("%.2f", report.rays->tracer_mrays / report.rays->raw_mrays)) +
            "</tr></table>\n";
  if (!report.skipped.empty()) {
    text += "<h3>Not measured</h3>\n<table>" + std::string("<tr><th>what</th><th>why</th></tr>\n");
    for (const Skipped& one : report.skipped) text += "<tr>" + cell(escaped(one.what), false) + cell(escaped(one.reason), false) + "</tr>\n";
    text += "</table>\n";
  }
  return text;
}

std::string method(const Report& report) {
  const Reference& r = report.reference;
  std::string text = "<h2>How it was measured</h2>\n<p>Two independent path-traced maps of " + tickLabel(r.samples) + " paths a texel (" + seconds(r.seconds) +
                     " for both) are the reference. Errors are products of the differences to one and to the other, so that the noise of the references drops out of them; the mean of both is " + percent(r.noise) +
                     " noisy, and errors below " + percent(r.resolution) + " cannot be told from none. Bake times hold import and atlas (" + seconds(report.stage_seconds) +
                     ") and leave out what bakes spend on measuring their own errors. " + std::to_string(report.threads) + (report.threads == 1 ? " thread" : " threads") + ", lightwell " + escaped(report.version) +
                     ". This run took " + seconds(report.seconds) + " of at most " + seconds(report.budget_s) + ": " + std::to_string(report.measured) + " bakes were measured, " + std::to_string(report.reused) +
                     " taken from earlier runs.</p>\n<p>Everything can be done by hand, in the folder of this report:</p>\n<pre>" + escaped(r.first_command) + "\n" + escaped(r.second_command) + "\n";
  for (const Baked& baked : report.bakes)
    if (!baked.command.empty() && !baked.evaluated.empty()) {
      text += escaped(baked.command + "\n" + baked.evaluated[0].command + "\nlightwell compare " + r.first + " " + baked.evaluated[0].map + " --second-reference " + r.second) + "\n";
      break;
    }
  return text + "</pre>\n<p class=\"note\">All commands and figures are in report.json and report.csv beside this page; the plots are files of their own, too.</p>\n";
}

}  // namespace

const Baked* recommended(const Report& report, std::string_view series) {
  double least = INFINITY;
  for (const Baked& baked : report.bakes)
    if (baked.series == series && !baked.evaluated.empty()) least = std::min(least, shownError(report, baked.evaluated[0]));
  const Baked* best = nullptr;
  for (const Baked& baked : report.bakes)
    if (baked.series == series && !baked.evaluated.empty() && shownError(report, baked.evaluated[0]) <= kNearlyBest * least && (!best || baked.seconds.value_or(0) < best->seconds.value_or(0))) best = &baked;
  return best;
}

std::string pageOf(const fs::path& folder, const Report& report, const std::vector<Plot>& plots, const std::vector<Picture>& pictures) {
  const std::string scene = escaped(fs::path(report.scene).filename().string());
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" + scene + ": error against run time</title>\n<style>" +
                     kStyle + "</style>\n</head>\n<body>\n<h1>" + scene + ": error against run time</h1>\n<p class=\"lead\">" + tickLabel(double(report.triangles)) + " triangles, " + std::to_string(report.lamps) +
                     (report.lamps == 1 ? " lamp" : " lamps") + (report.environment.empty() ? "" : ", under the sky of " + escaped(fs::path(report.environment).filename().string())) + ", light map of " +
                     std::to_string(report.lightmap_size) + "² texels</p>\n";
  page += summary(report);
  page += chapter(plots, "bake", "Baking");
  page += chapter(plots, "size", "Size and memory");
  page += chapter(plots, "frame", "In the game");
  page += chapter(plots, "load", "While a level loads");
  page += chapter(plots, "live", "Lamps without a bake");
  page += chapter(plots, "sky", "Sky");
  page += picturesText(folder, pictures) + tables(report) + method(report);
  return page + "</body>\n</html>\n";
}

}  // namespace lightwell::report
