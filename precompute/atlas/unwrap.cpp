#include "precompute/atlas/unwrap.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <string>

#include "precompute/atlas/grow.h"
#include "precompute/atlas/pack.h"
#include "precompute/atlas/split.h"
#include "precompute/core/parallel.h"

namespace lightwell::atlas {
namespace {

constexpr int kLargestAtlas = 8192;
/// Charts put beside given ones have their density at most, and at least this share of it; else all is unwrapped anew.
constexpr double kLeastShareOfGivenDensity = 1.0 / 8;

std::string plural(size_t count, const char* noun) { return std::to_string(count) + " " + noun + (count == 1 ? "" : "s"); }

/// One warning for each kind of problem, at the first object that has it.
void reportProblems(const scene::Scene& scene, const UvCheck& check, Diagnostics& diagnostics) {
  struct Group {
    size_t first, count;
  };
  std::map<UvProblem, Group> groups;
  for (size_t i = 0; i < scene.objects.size(); ++i)
    if (check.problem[i] != UvProblem::none && scene.objects[i].triangle_count > 0)
      ++groups.try_emplace(check.problem[i], Group{i, 0}).first->second.count;
  for (const auto& [problem, group] : groups) {
    std::string message = std::string("light-map coordinates were generated, as TEXCOORD_1 is ") + describe(problem);
    if (group.count > 1) message += " (and for " + plural(group.count - 1, "more object") + ")";
    diagnostics.warn(scene.objects[group.first].gltf_path, message);
  }
}

void grow(const scene::Scene& scene, const std::vector<size_t>& objects, const AtlasOptions& options, int threads,
          std::vector<ObjectCharts>& grown) {
  const float deviation = std::clamp(options.chart_normal_deviation, 0.0f, 1.4f);
  std::vector<size_t> missing;
  std::copy_if(objects.begin(), objects.end(), std::back_inserter(missing), [&](size_t i) { return grown[i].charts.empty(); });
  if (options.charts) {
    auto charts = options.charts(scene, missing, deviation);
    for (size_t i = 0; i < missing.size(); ++i) grown[missing[i]].charts = std::move(charts.at(i));
    return;
  }
  parallelFor(missing.size(), 1, threads, nullptr, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) grown[missing[i]].charts = growCharts(scene.mesh, scene.objects[missing[i]], deviation);
  });
}

/// Packs the charts of `objects`; false when they do not fit with at least `least_density`.
bool pack(const std::vector<size_t>& objects, const std::vector<TexelRect>& bins, int padding, double least_density, double most_density,
          std::vector<ObjectCharts>& grown) {
  std::vector<Vec2d> extents;
  for (size_t i : objects)
    for (const Chart& chart : grown[i].charts) extents.push_back(chart.extent);
  const auto packing = packCharts(extents, bins, padding, most_density);
  if (!packing || packing->texels_per_unit < least_density) return false;
  size_t next = 0;
  for (size_t i : objects) {
    const auto first = packing->placements.begin() + ptrdiff_t(next);
    grown[i].placements.assign(first, first + ptrdiff_t(grown[i].charts.size()));
    next += grown[i].charts.size();
  }
  return true;
}

}  // namespace

std::vector<Vec2> layOut(scene::Scene& scene, const UvCheck& check, const AtlasOptions& options, Diagnostics& diagnostics, int threads,
                         bool& atlas_unwrapped) {
  const int size = options.size, padding = std::max(0, options.padding_texels);
  std::vector<ObjectCharts> grown(scene.objects.size());
  std::vector<size_t> unsound, all;
  bool any_sound = false;
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.objects[i].triangle_count == 0) continue;
    all.push_back(i);
    if (check.problem[i] != UvProblem::none) unsound.push_back(i);
    else any_sound = true;
  }
  atlas_unwrapped = !unsound.empty();
  if (unsound.empty()) return splitAlongSeams(scene, grown, size);

  reportProblems(scene, check, diagnostics);
  grow(scene, unsound, options, threads, grown);
  if (any_sound) {
    const double given_density = std::sqrt(check.sound_uv_area_texels / check.sound_area);
    const auto free = freeRectangles(check.occupied, size, size, padding);
    if (pack(unsound, free, padding, given_density * kLeastShareOfGivenDensity, given_density, grown))
      return splitAlongSeams(scene, grown, size);
    diagnostics.warn(scene.file, "the given light-map coordinates leave too little room for the generated ones at a size of " +
                                     std::to_string(size) + ": all light-map coordinates were generated anew");
    grow(scene, all, options, threads, grown);
  }
  if (!pack(all, {wholeAtlas(size, padding)}, padding, 0, std::numeric_limits<double>::infinity(), grown)) {
    size_t charts = 0;
    for (const ObjectCharts& object : grown) charts += object.charts.size();
    const int smallest = smallestAtlas(charts, padding, kLargestAtlas);
    const std::string advice = smallest <= kLargestAtlas ? "the smallest size that would do is " + std::to_string(smallest)
                                                         : "not even a size of " + std::to_string(kLargestAtlas) + " would do";
    throw InputError(scene.file, "",
                     plural(charts, "chart") + " do not fit into a light map of size " + std::to_string(size) + "; " + advice);
  }
  return splitAlongSeams(scene, grown, size);
}

}  // namespace lightwell::atlas
