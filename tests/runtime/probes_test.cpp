// Probes from strangers, and what is made of their links.
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "tests/format/probes_content.h"
#include "tests/runtime/probes_fixture.h"

namespace lightwell::test {
namespace {

using Content = format::ProbesContent;

lw_result load(const std::vector<uint8_t>& bytes, std::string* message = nullptr, size_t fail_at = SIZE_MAX) {
  Host host;
  const lw_config config = host.config();
  lw_container* container = nullptr;
  lw_radiosity* radiosity = nullptr;
  lw_probes* probes = nullptr;
  EXPECT_EQ(lw_open_memory(bytes.data(), bytes.size(), &config, &container), LW_OK);
  EXPECT_EQ(lw_radiosity_load(container, &radiosity), LW_OK);
  host.fail_at = fail_at == SIZE_MAX ? SIZE_MAX : host.allocations + fail_at;
  const lw_result result = lw_probes_load(container, radiosity, &probes);
  if (message) *message = host.message;
  lw_probes_release(probes);
  lw_radiosity_release(radiosity);
  lw_close(container);
  EXPECT_EQ(host.live, 0u);
  return result;
}

TEST(ProbesHostile, RefusesValuesThatCannotBe) {
  const std::pair<const char*, std::function<void(Content&)>> breaches[] = {
      {"no probes", [](Content& c) { c.header.clear_lattice_probes(), c.header.clear_points(); }},
      {"far too many", [](Content& c) { c.header.set_points(0xffffffffu); }},
      {"other number", [](Content& c) { c.header.set_points(2); }},
      {"two dimensions", [](Content& c) { c.header.mutable_lattice_count()->RemoveLast(); }},
      {"no lattice", [](Content& c) { c.header.clear_lattice_count(), c.header.clear_lattice_first(); }},
      {"spacing", [](Content& c) { c.header.set_lattice_spacing(NAN); }},
      {"spacing zero", [](Content& c) { c.header.set_lattice_spacing(0); }},
      {"nowhere", [](Content& c) { c.header.set_lattice_first(1, INFINITY); }},
      {"flat", [](Content& c) { c.header.set_lattice_count(1, 0); }},
      {"huge", [](Content& c) { for (int k = 0; k < 3; ++k) c.header.set_lattice_count(k, 0xffffffffu); }},
      {"beyond", [](Content& c) { c.lattice_point[2] = 8; }},
      {"twice", [](Content& c) { c.lattice_point[1] = 0; }},
      {"nearness", [](Content& c) { c.nearness.resize(289); }},
      {"position", [](Content& c) { c.point_position[1] = NAN; }},
      {"first", [](Content& c) { c.link_first[2] = 0x80000000u; }},
      {"node", [](Content& c) { c.link_node[2] = 11; }},
      {"set", [](Content& c) { c.link_gates[1] = 2; }},
      {"gate", [](Content& c) { c.gate_set[0] = 4; }},
      {"set 0", [](Content& c) { c.gate_set_first = {0, 1, 1}; }},
      {"scale", [](Content& c) { c.scale[2] = 1; }},
      {"scale nan", [](Content& c) { c.scale[2] = NAN; }},
      {"missing", [](Content& c) { c.left_out = {"link_code"}; }},
  };
  EXPECT_EQ(load(toWriter(format::probesContent()).bytes()), LW_OK);
  for (const auto& [name, spoil] : breaches) {
    Content content = format::probesContent();
    spoil(content);
    std::string message;
    EXPECT_EQ(load(toWriter(content).bytes(), &message), LW_BAD_SECTION) << name << ": " << message;
  }
  EXPECT_EQ(load(toWriter(format::portalsContent()).bytes()), LW_NOT_FOUND);
}

TEST(ProbesHostile, SurvivesEveryFailedAllocation) {
  const auto bytes = toWriter(format::probesContent()).bytes();
  size_t failures = 0;
  while (load(bytes, nullptr, failures) == LW_OUT_OF_MEMORY) ++failures;
  EXPECT_GT(failures, 12u);
  EXPECT_EQ(load(bytes, nullptr, failures), LW_OK);
}

float irradiance(const float* sh, double theta, double phi) {
  const float n[3] = {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)), float(std::cos(theta))};
  // Without lw_sh_irradiance, which would hide what is negative.
  const float basis[9] = {0.28209479f, 0.48860251f * n[1], 0.48860251f * n[2], 0.48860251f * n[0], 1.09254843f * n[0] * n[1], 1.09254843f * n[1] * n[2],
                          0.31539157f * (3 * n[2] * n[2] - 1), 1.09254843f * n[0] * n[2], 0.54627422f * (n[0] * n[0] - n[1] * n[1])};
  float sum = 0;
  for (int k = 0; k < 9; ++k) sum += basis[k] * sh[k * 3] * float(std::numbers::pi) * (k == 0 ? 1.0f : k < 4 ? 2.0f / 3 : 0.25f);
  return sum;
}

TEST(Probes, LightFromOneSideIsNowhereNegativeAndKeepsItsMean) {
  // One link only: all light from one direction, the worst there is.
  LoadedProbes p(probesInRoom([](uint32_t) { return std::vector<ProbeLink>{{37, 0.02}}; }));
  ASSERT_EQ(lw_radiosity_step(p.room.state, 1), LW_OK);
  for (const uint32_t coefficients : {4u, 9u}) {
    const auto sh = p.evaluate(coefficients, LW_RADIOSITY_EMITTERS);
    const uint32_t probe = 3;
    double mean = 0, least = INFINITY, most = 0;
    for (double theta = 0.01; theta < 3.14; theta += 0.02)
      for (double phi = 0; phi < 6.28; phi += 0.05) {
        const double e = double(irradiance(&sh[probe * 27], theta, phi));
        least = std::min(least, e), most = std::max(most, e), mean += e * std::sin(theta) * 0.02 * 0.05 / (4 * std::numbers::pi);
      }
    const double flux = 0.02 * 4 * std::numbers::pi * 1;  // emission 1 over two hundredths of the sphere
    EXPECT_GT(least, -1e-4 * most) << coefficients;
    EXPECT_NEAR(mean / (flux / 4), 1, 0.01) << coefficients;
    EXPECT_NEAR(most / flux, coefficients == 9 ? 0.95 : 0.5, 0.02);
    for (uint32_t k = coefficients * 3; k < 27; ++k) EXPECT_EQ(sh[probe * 27 + k], 0.0f);
  }
}

TEST(Probes, ReflectedAndEmittedLightAreApart) {
  LoadedProbes p(probesInRoom());
  std::vector<float> direct(size_t(p.room.info.patches) * 3, 2.0f);
  ASSERT_EQ(lw_radiosity_set_direct(p.room.state, direct.data()), LW_OK);
  p.room.solve();
  const auto both = p.evaluate(9), reflected = p.evaluate(9, LW_RADIOSITY_INDIRECT), emitted = p.evaluate(9, LW_RADIOSITY_EMITTERS);
  // The first coefficient is never windowed.
  for (size_t i = 0; i < both.size(); i += 27) {
    EXPECT_NEAR(both[i], reflected[i] + emitted[i], 1e-4f * both[i]);
    EXPECT_GT(reflected[i], 0.1f);
    EXPECT_GT(emitted[i], 0.01f);
  }
}

TEST(Probes, LightThroughADoorComesAsFarAsItIsOpen) {
  const auto bytes = toWriter(format::probesContent()).bytes();
  const Container container = openMemory(bytes);
  lw_radiosity* radiosity = nullptr;
  lw_radiosity_state* state = nullptr;
  lw_probes* probes = nullptr;
  ASSERT_EQ(lw_radiosity_load(container.get(), &radiosity), LW_OK);
  ASSERT_EQ(lw_radiosity_state_create(radiosity, &state), LW_OK);
  ASSERT_EQ(lw_probes_load(container.get(), radiosity, &probes), LW_OK);
  const std::vector<float> direct(27, 1.0f);
  ASSERT_EQ(lw_radiosity_set_direct(state, direct.data()), LW_OK);
  float sh[3][27];
  const uint32_t last = 3;
  lw_probes_evaluation evaluation = LW_PROBES_EVALUATION_INIT;
  evaluation.probe = &last, evaluation.count = 1;
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(lw_radiosity_set_gate(state, 0, float(i) / 2), LW_OK);
    ASSERT_EQ(lw_probes_evaluate(probes, state, &evaluation, sh[i]), LW_OK);
  }
  EXPECT_LT(sh[0][0], sh[1][0]);
  EXPECT_NEAR(sh[1][0], (sh[0][0] + sh[2][0]) / 2, 1e-5f);
  lw_probes_release(probes);
  lw_radiosity_state_destroy(state);
  lw_radiosity_release(radiosity);
}

TEST(Probes, InterpolateBetweenThemAndNotBeyond) {
  LoadedProbes p(probesInRoom());
  // At a probe it is that probe's, halfway it is both halves.
  const float* at = p.info.position_m;
  lw_probes_around around;
  ASSERT_EQ(lw_probes_find(p.probes, at, &around), LW_OK);
  float own = 0;
  for (uint32_t i = 0; i < around.count; ++i) own += around.probe[i] == 0 ? around.weight[i] : 0.0f;
  EXPECT_NEAR(own, 1, 2e-3);
  const float between[3] = {at[0] + 0.5f * p.info.lattice_spacing_m, at[1], at[2]}, outside[3] = {-1e6f, 1e6f, at[2]}, nowhere[3] = {NAN, 0, 0};
  ASSERT_EQ(lw_probes_find(p.probes, between, &around), LW_OK);
  EXPECT_NEAR(around.weight[0], 0.5, 2e-3);
  EXPECT_NEAR(around.weight[1], 0.5, 2e-3);
  ASSERT_EQ(lw_probes_find(p.probes, outside, &around), LW_OK);
  float sum = 0;
  for (uint32_t i = 0; i < around.count; ++i) sum += around.weight[i];
  EXPECT_NEAR(sum, 1, 1e-5);
  EXPECT_EQ(lw_probes_find(p.probes, nowhere, &around), LW_INVALID_ARGUMENT);
}

TEST(Probes, RefuseBadArguments) {
  LoadedProbes p(probesInRoom());
  RoomOptions options;
  options.walls = boxWalls({0, 0, 0}, {1, 1, 1}, 2, 0.5, 1);
  LoadedRoom other(options);
  std::vector<float> sh(size_t(p.info.probes) * 27);
  EXPECT_EQ(lw_probes_evaluate(p.probes, other.state, nullptr, sh.data()), LW_INVALID_ARGUMENT);
  const uint32_t beyond = p.info.probes;
  lw_probes_evaluation evaluation = LW_PROBES_EVALUATION_INIT;
  evaluation.probe = &beyond, evaluation.count = 1;
  EXPECT_EQ(lw_probes_evaluate(p.probes, p.room.state, &evaluation, sh.data()), LW_NOT_FOUND);
  for (const uint32_t light : {0u, 4u, 7u}) {
    evaluation = LW_PROBES_EVALUATION_INIT;
    evaluation.light = light;
    EXPECT_EQ(lw_probes_evaluate(p.probes, p.room.state, &evaluation, sh.data()), LW_INVALID_ARGUMENT);
  }
  evaluation = LW_PROBES_EVALUATION_INIT;
  evaluation.coefficients = 5;
  EXPECT_EQ(lw_probes_evaluate(p.probes, p.room.state, &evaluation, sh.data()), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_probes_load(nullptr, nullptr, nullptr), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_probes_get_info(nullptr, nullptr), LW_INVALID_ARGUMENT);
  lw_probes_release(nullptr);
}

}  // namespace
}  // namespace lightwell::test
