// The table of stiff and extreme cases.
#pragma once
#include <string>
#include <vector>

#include "cli/stress/trial.h"

namespace lightwell::stress {

struct Case {
  std::string name, holds;  // what is exact or expected, in words
  std::vector<plan::Technique> techniques;  // to which it applies
  void (*run)(Trial&);
  bool slow = false;        // many seconds or gigabytes
  bool needs_gl = false;    // has no evaluation on the CPU
};

std::vector<Case> placeCases();       // scale, origin, mirrors
std::vector<Case> reflectionCases();  // albedo, bounces, convergence
std::vector<Case> lightCases();       // lamps and emitters
std::vector<Case> geometryCases();    // faces that modelling programs should not write, and do
std::vector<Case> skyCases();         // leaks, suns, lobes
std::vector<Case> dynamicCases();     // lamps that nothing was baked for
std::vector<Case> sizeCases();        // none, one and very many of something

/// All of them, in this order.
std::vector<Case> allCases();
/// `pattern`: * stands for anything, ? for one character.
bool matches(const std::string& pattern, const std::string& name);

inline const std::vector<plan::Technique> kOfLamps = {plan::Technique::prm, plan::Technique::radiosity, plan::Technique::lightmap, plan::Technique::vpl};

}  // namespace lightwell::stress
