// A small sound section "environment", as plain data that a test may spoil before it is written.
#pragma once
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "format/encode/writer.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::format {

/// A sun and two half spheres; a cube of 4 × 4 cells a face.
struct EnvironmentContent {
  v1::EnvironmentHeader header;
  std::vector<float> direction, flux, solid_angle, spread, covariance;
  std::vector<uint16_t> node;
  std::set<std::string> left_out;  // chunks that are not written
};

EnvironmentContent environmentContent();
Writer toWriter(const EnvironmentContent& content);

}  // namespace lightwell::format
