// What a report measures on a scene: bakes in an order in which a budget that ends early has still seen something of everything.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "cli/report/result.h"
#include "precompute/plan/plan.h"

namespace lightwell::report {

/// A line of the plots: one technique, or the paper's way of it, at settings that cost more and more.
struct Series {
  std::string_view name, title, color;
  bool baseline = false;           // what was published; drawn dashed
  std::string_view use;            // what a game can do with it, for people
};
/// All of them, in the order of legends and tables. "given": containers of --against.
const std::vector<Series>& allSeries();
/// Throws std::logic_error for another name.
const Series& seriesNamed(std::string_view name);

/// One bake.
struct Rung {
  std::string series, setting;
  std::string options;             // of `lightwell bake` besides those that all bakes have
  plan::Settings settings;         // with one technique
  double cost = 1;                 // expected, of a draft
  std::vector<uint32_t> brightest; // panes: evaluated with so many, 0: all
  bool sweeps = false;             // radiosity: evaluated after few bounces too

  plan::Technique technique() const { return settings.techniques[0]; }
  std::string fileName() const;    // without folder and extension
};

/// `base`: what all bakes share. What the scene cannot use is told in `skipped` with the reason.
std::vector<Rung> ladderOf(const plan::Settings& base, const plan::SceneFacts& facts, std::vector<Skipped>& skipped);

}  // namespace lightwell::report
