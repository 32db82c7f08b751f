// Probes of radiance maps: from twelve values to spherical harmonics, and which of them are asked for.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <cstring>

#include "lightwell/lightwell_prm_probes.h"
#include "tests/format/prm_probes_content.h"
#include "tests/runtime/support.h"

namespace lightwell::test {
namespace {

using Probes = std::unique_ptr<lw_prm_probes, decltype(&lw_prm_probes_release)>;
using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The corners of an icosahedron in the order of docs/format.md.
std::array<Vector, 12> corners() {
  const double golden = (1 + std::sqrt(5.0)) / 2, length = std::sqrt(1 + golden * golden);
  std::array<Vector, 12> result;
  for (int i = 0; i < 12; ++i) {
    const int a = i / 4;
    result[size_t(i)][size_t(a)] = 0;
    result[size_t(i)][size_t((a + 1) % 3)] = (i & 2 ? -1 : 1) / length;
    result[size_t(i)][size_t((a + 2) % 3)] = (i & 1 ? -golden : golden) / length;
  }
  return result;
}

/// Irradiance about a normal that is `cosine` away from a light of unit irradiance, bands 0 to 2.
double lobe(double cosine) { return 0.25 + 0.5 * cosine + 0.3125 * (3 * cosine * cosine - 1) / 2; }

class PrmProbes : public testing::Test {
 protected:
  void open(const format::PrmProbesContent& content) {
    container = openMemory(toWriter(content).bytes());
    prm = loadPrm(container.get());
    lw_prm_probes* loaded = nullptr;
    ASSERT_EQ(lw_prm_probes_load(container.get(), prm.get(), &loaded), LW_OK);
    probes.reset(loaded);
    prm.reset();  // they have a share in it
  }
  std::vector<float> evaluate(const std::vector<float>& cluster_rgb, const lw_prm_probes_evaluation& evaluation, size_t count) {
    std::vector<float> scratch(lw_prm_probes_scratch_bytes(probes.get()) / sizeof(float)), sh(count * 27, -1e9f);
    EXPECT_EQ(lw_prm_probes_evaluate(probes.get(), cluster_rgb.data(), &evaluation, scratch.data(), scratch.size() * sizeof(float), sh.data()), LW_OK);
    return sh;
  }
  Container container;
  Prm prm{nullptr, lw_prm_release};
  Probes probes{nullptr, lw_prm_probes_release};
};

TEST_F(PrmProbes, TurnValuesIntoHarmonicsExactly) {
  // A light from `direction` and as much from all around, so that no window is needed.
  const Vector direction{0.48, -0.6, 0.64};
  format::PrmProbesContent content = format::prmProbesContent();
  content.header.set_probes(1), content.header.set_max_rank(1), content.header.set_has_emitter(false);
  content.position = {0, 0, 0}, content.block_rank = {1}, content.emitter.clear();
  content.basis.clear();
  const double largest = 0.25 + lobe(1);
  for (const Vector& corner : corners()) content.basis.push_back(int8_t(std::lround(127 * (0.25 + lobe(dot(corner, direction))) / largest)));
  content.block_first_link = {0, 1}, content.link_wavelet = {1}, content.coefficient = {100, 0, 0};
  content.coefficient_scale = {0.01f, 0.01f, 0.01f};
  open(content);
  std::vector<float> cluster_rgb(9, 0.0f);
  cluster_rgb[3] = cluster_rgb[4] = cluster_rgb[5] = 2;  // wavelet 1 in units of 2: one unit
  const auto sh = evaluate(cluster_rgb, LW_PRM_PROBES_EVALUATION_INIT, 1);
  for (int seed = 0; seed < 50; ++seed) {
    const double z = std::cos(0.06 * seed), phi = 2.4 * seed, r = std::sqrt(1 - z * z);
    const Vector n{r * std::cos(phi), r * std::sin(phi), z};
    const float normal[3] = {float(n[0]), float(n[1]), float(n[2])};
    float irradiance[3];
    lw_sh_irradiance(reinterpret_cast<const float(*)[3]>(sh.data()), normal, irradiance);
    for (const float channel : irradiance) EXPECT_NEAR(channel, (0.25 + lobe(dot(n, direction))) / largest, 0.01);
  }
}

TEST_F(PrmProbes, AreEvaluatedOneByOneAsAllTogether) {
  open(format::prmProbesContent());
  const std::vector<float> cluster_rgb{1, 2, 3, 0.5f, 0.25f, 4, 0, 1, 2};
  const auto all = evaluate(cluster_rgb, LW_PRM_PROBES_EVALUATION_INIT, 2);
  lw_prm_probes_evaluation one = LW_PRM_PROBES_EVALUATION_INIT;
  const uint32_t second = 1;
  one.probe = &second, one.count = 1;
  EXPECT_THAT(evaluate(cluster_rgb, one, 1), testing::ElementsAreArray(all.begin() + 27, all.end()));
  one.emitters = 0;
  EXPECT_THAT(evaluate(std::vector<float>(9, 0.0f), one, 1), testing::Each(0.0f)) << "no light, no emitters";
}

TEST_F(PrmProbes, AddTheLightOfEmitters) {
  format::PrmProbesContent content = format::prmProbesContent();
  std::fill(content.emitter.begin(), content.emitter.end(), uint16_t(0));
  for (size_t k = 0; k < 3; ++k) content.emitter[27 + k] = 0x4000;  // 2.0
  open(content);
  const auto sh = evaluate(std::vector<float>(9, 0.0f), LW_PRM_PROBES_EVALUATION_INIT, 2);
  EXPECT_EQ(sh[0], 0);
  EXPECT_THAT(std::vector<float>(sh.begin() + 27, sh.begin() + 31), testing::ElementsAre(2, 2, 2, 0));
}

TEST_F(PrmProbes, RefuseWhatCannotBe) {
  open(format::prmProbesContent());
  std::vector<float> cluster_rgb(9, 1.0f), scratch(lw_prm_probes_scratch_bytes(probes.get()) / sizeof(float)), sh(54);
  lw_prm_probes_evaluation evaluation = LW_PRM_PROBES_EVALUATION_INIT;
  const auto result = [&](size_t bytes) { return lw_prm_probes_evaluate(probes.get(), cluster_rgb.data(), &evaluation, scratch.data(), bytes, sh.data()); };
  EXPECT_EQ(result(scratch.size() * sizeof(float) - 1), LW_INVALID_ARGUMENT);
  const uint32_t third = 2;
  evaluation.probe = &third, evaluation.count = 1;
  EXPECT_EQ(result(scratch.size() * sizeof(float)), LW_NOT_FOUND);
  evaluation = LW_PRM_PROBES_EVALUATION_INIT;
  cluster_rgb[8] = -1;
  EXPECT_EQ(result(scratch.size() * sizeof(float)), LW_INVALID_ARGUMENT);

  lw_prm_probes* loaded = nullptr;
  const Container without = openMemory(toWriter(format::localBasesContent()).bytes());
  const Prm bases = loadPrm(without.get());
  EXPECT_EQ(lw_prm_probes_load(without.get(), bases.get(), &loaded), LW_NOT_FOUND);
  const Container panes = openMemory(toWriter(format::panesContent()).bytes());
  const Prm of_panes = loadPrm(panes.get());
  EXPECT_EQ(lw_prm_probes_load(panes.get(), of_panes.get(), &loaded), LW_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace lightwell::test
