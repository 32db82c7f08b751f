// A scene with its atlas and tracer, for tests of estimators.
#pragma once
#include <memory>

#include "precompute/atlas/validity.h"
#include "precompute/trace/tracer.h"

namespace lightwell::test {

/// A scene with everything that a bake derives from it.
struct PreparedScene {
  scene::Scene scene;
  atlas::Atlas atlas;
  std::unique_ptr<trace::Tracer> tracer;
  explicit PreparedScene(scene::Scene s, int size = 48) : scene(std::move(s)) {
    Diagnostics diagnostics;
    atlas = atlas::buildAtlas(scene, {.size = size}, diagnostics);
    tracer = std::make_unique<trace::Tracer>(scene, 1);
    atlas::fillInvalid(atlas, scene, *tracer, 1, 1, nullptr);
  }
};

}  // namespace lightwell::test
