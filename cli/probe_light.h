// What probes for moving objects receive, whichever section lights them.
#pragma once
#include <vector>

namespace lightwell::cli {

/// Positions in the container's coordinates, [probes][3], and integrals of radiance times Y, [probes][9][3].
struct ProbeLight {
  std::vector<float> position_m, radiance_sh;
};

}  // namespace lightwell::cli
