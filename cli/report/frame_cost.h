// What a frame costs a game: milliseconds on the CPU and on OpenGL, bytes that it reads, texture memory.
#pragma once
#include "cli/report/result.h"
#include "cli/runtime_handles.h"
#include "format/encode/reader.h"

namespace lightwell::report {

struct FrameSettings {
  bool gl = true;
  uint32_t brightest = 0;   // panes
  uint32_t sweeps = 1;      // radiosity: bounces a frame
};

/// Medians by wall clock, on OpenGL until glFinish returns. A frame: one point light near the middle of the scene has moved by a twentieth of it; its light at the entry points or patches (without a shadow ray on the CPU,
/// with its shadow maps drawn before on OpenGL), and from there to all texels of the atlas. Light maps have nothing to do in a frame: 0 ms. Virtual lights are drawn once; their frame is 0 ms too.
/// Throws UsageError without OpenGL.
void measureFrame(const cli::RuntimeContainer& container, const format::Reader& reader, const std::string& technique, const FrameSettings& settings, Evaluated& evaluated);
/// Such a frame of lightwell_dynamic: views of the lamp, virtual lights, shadow maps, all texels.
double dynamicFrameMs(const cli::RuntimeContainer& container, bool incremental, uint32_t lights, uint32_t shadow_side);

}  // namespace lightwell::report
