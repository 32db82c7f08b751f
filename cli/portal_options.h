// How far portals are open, as evaluate and reference are told: --portal NAME=OPEN.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "precompute/scene/scene.h"

namespace lightwell::cli {

/// A name, at whose end * stands for any rest, and how far what is called so is open, 0 to 1.
using PortalState = std::pair<std::string, float>;

void addPortalStates(CLI::App& command, std::vector<std::string>& words, const std::string& what);
/// Throws UsageError for what is no NAME=OPEN.
std::vector<PortalState> parsePortalStates(const std::vector<std::string>& words);
/// Per portal; those that no state names are shut, of several states the last counts. Throws UsageError, with the portals' names, for a name that none has.
std::vector<float> portalsOpen(const std::vector<PortalState>& states, const std::vector<scene::Portal>& portals);

}  // namespace lightwell::cli
