// A small sound container with a section "points", as plain data that a test may spoil before it is written.
#pragma once
#include "tests/format/content.h"

namespace lightwell::format {

/// The surfaces of Content, with four points.
struct PointsContent {
  Content base;  // without prm
  v1::PointsHeader header;
  std::vector<uint16_t> position;
  std::vector<int16_t> normal;
  std::vector<uint32_t> texel;
};

PointsContent pointsContent();
Writer toWriter(const PointsContent& content);

}  // namespace lightwell::format
