// The checks of section environment. docs/format.md has the tables that they hold.
#include <cmath>
#include <numbers>
#include <string>

#include "format/decode/pixel.h"
#include "format/encode/verify_context.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::format {
namespace {

constexpr const char* kSection = "environment";
constexpr uint32_t kMostCells = 4096, kFewestFaceCells = 4, kMostFaceCells = 256;
constexpr double kPi = std::numbers::pi, kSumTolerance = 1e-4, kRoundingTolerance = 1e-3;

bool isNegativeOrNotFinite(float v) { return !(v >= 0) || !std::isfinite(v); }

/// False when what follows would make no sense.
bool verifyHeader(VerifyContext& context, const v1::EnvironmentHeader& header) {
  const auto wrong = [&](const char* what) {
    context.report(IssueId::header_value, kSection, "header", what);
    return false;
  };
  if (header.cells() < 1 || header.cells() > kMostCells) return wrong("there are not 1 to 4096 cells");
  if (header.suns() > header.cells()) return wrong("there are more suns than cells");
  if (header.face_cells() < kFewestFaceCells || header.face_cells() > kMostFaceCells || header.face_cells() % 2 != 0)
    return wrong("face_cells is not an even number from 4 to 256");
  int exponent = 0;
  if (!(header.node_scale() > 0) || !std::isfinite(header.node_scale()) || std::frexp(header.node_scale(), &exponent) != 0.5f)
    return wrong("node_scale is not a power of two");
  if (header.sky_flux_size() != 3 || header.radiance_sh_size() != 27) return wrong("sky_flux has not 3 numbers, or radiance_sh not 27");
  for (int c = 0; c < 3; ++c) {
    const float flux = header.sky_flux(c);
    if (isNegativeOrNotFinite(flux)) return wrong("sky_flux is negative or not finite");
    for (int k = 0; k < 9; ++k)  // no basis function exceeds 1.1
      if (!(std::abs(header.radiance_sh(3 * k + c)) <= 1.1f * flux)) return wrong("radiance_sh is not of a sky with this flux");
    if (std::abs(header.radiance_sh(c) * std::sqrt(4 * kPi) - flux) > kSumTolerance * flux)
      return wrong("radiance_sh has another mean than sky_flux");
  }
  if (!std::isfinite(header.rotation_deg())) wrong("rotation_deg is not finite");
  if (isNegativeOrNotFinite(header.intensity())) wrong("intensity is negative or not finite");
  if (header.ground_radiance_size() != 0 && header.ground_radiance_size() != 3) wrong("ground_radiance has not three numbers");
  for (const float v : header.ground_radiance())
    if (isNegativeOrNotFinite(v)) wrong("ground_radiance is negative or not finite");
  return true;
}

void verifyCells(VerifyContext& context, const v1::EnvironmentHeader& header) {
  const uint64_t cells = header.cells();
  if (const auto direction = context.load<float>(kSection, "cell_direction", {cells, 3}))
    for (uint64_t i = 0; i < cells; ++i) {
      double squared = 0;
      for (uint64_t c = 0; c < 3; ++c) squared += double((*direction)[3 * i + c]) * (*direction)[3 * i + c];
      if (std::abs(squared - 1) <= 1e-5) continue;
      context.report(IssueId::value_range, kSection, "cell_direction", "the direction of cell " + std::to_string(i) + " is not a unit vector");
      break;
    }
  if (const auto flux = context.load<float>(kSection, "cell_flux", {cells, 3});
      flux && context.checkEach(*flux, IssueId::not_finite, kSection, "cell_flux", "are negative or not finite", isNegativeOrNotFinite))
    for (int c = 0; c < 3; ++c) {
      double sum = 0;
      for (uint64_t i = header.suns(); i < cells; ++i) sum += (*flux)[3 * i + uint64_t(c)];
      if (std::abs(sum - header.sky_flux(c)) <= kSumTolerance * header.sky_flux(c)) continue;
      context.report(IssueId::value_range, kSection, "cell_flux", "the cells without the suns do not add to sky_flux");
      break;
    }
  if (const auto angle = context.load<float>(kSection, "cell_solid_angle", {cells});
      angle && context.checkEach(*angle, IssueId::value_range, kSection, "cell_solid_angle", "are not above 0 and at most 4 pi",
                                 [](float v) { return !(v > 0 && v <= 12.56638f); })) {
    double sum = 0;
    for (const float v : *angle) sum += v;
    if (std::abs(sum / (4 * kPi) - 1) > kSumTolerance)
      context.report(IssueId::value_range, kSection, "cell_solid_angle", "they do not add to 4 pi");
  }
  if (const auto spread = context.load<float>(kSection, "cell_spread", {cells}))
    context.checkEach(*spread, IssueId::value_range, kSection, "cell_spread", "are outside 0 to 1",
                      [](float v) { return !(v >= 0 && v <= 1); });
  if (const auto covariance = context.load<float>(kSection, "cell_covariance", {cells, 3}))
    for (uint64_t i = 0; i < cells; ++i) {
      const double xx = (*covariance)[3 * i], xy = (*covariance)[3 * i + 1], yy = (*covariance)[3 * i + 2];
      if (xx >= 0 && yy >= 0 && xx + yy <= 1.00001 && xy * xy <= xx * yy * 1.00001 + 1e-14) continue;
      context.report(IssueId::value_range, kSection, "cell_covariance", "that of cell " + std::to_string(i) + " is none of unit vectors");
      break;
    }
}

void verifyNodes(VerifyContext& context, const v1::EnvironmentHeader& header) {
  const uint64_t m = header.face_cells();
  const auto node = context.load<uint16_t>(kSection, "node", ElementType::f16, {6, m + 1, m + 1, 3});
  if (!node || !context.checkEach(*node, IssueId::not_finite, kSection, "node", "are not finite",
                                  [](uint16_t v) { return (v & 0x7c00u) == 0x7c00u; }))
    return;
  const double unit = header.node_scale() * 4 * kPi / (6.0 * double(m * m));
  for (size_t c = 0; c < 3; ++c) {
    double sum = 0, magnitude = 0;
    for (size_t i = c; i < node->size(); i += 3) {
      const double mass = unit * unpackHalf((*node)[i]);
      sum += mass;
      magnitude += std::abs(mass);
    }
    if (std::abs(sum - header.sky_flux(int(c))) <= kRoundingTolerance * magnitude) continue;
    context.report(IssueId::value_range, kSection, "node", "they do not add to sky_flux");
    return;
  }
}

}  // namespace

void verifyEnvironment(VerifyContext& context) {
  v1::EnvironmentHeader header;
  if (!context.loadMessage(kSection, "header", header) || !verifyHeader(context, header)) return;
  verifyCells(context, header);
  verifyNodes(context, header);
}

}  // namespace lightwell::format
