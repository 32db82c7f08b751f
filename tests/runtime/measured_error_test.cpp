// What a container says about its errors, read by the runtime: all of it, nothing of it, and damage.
#include <cmath>
#include <cstring>
#include <functional>

#include "format/encode/writer.h"
#include "lightwell/lightwell_error.h"
#include "lightwell/v1/container.pb.h"
#include "tests/runtime/support.h"

namespace lightwell::test {
namespace {

v1::MetaHeader twoErrors() {
  v1::MetaHeader meta;
  meta.mutable_provenance()->set_tool_version("0.1.0");
  v1::MeasuredError& first = *meta.add_errors();
  first.set_section("prm"), first.set_against("16 point lights"), first.set_texels(1011), first.set_seconds(2.5);
  first.set_relrmse(0.03), first.set_relrmse_low(0.02), first.set_relrmse_high(0.05);
  first.set_texrel(0.04), first.set_texrel_low(0.01), first.set_texrel_high(0.06);
  first.set_bias(-0.001), first.set_bias_low(-0.01), first.set_bias_high(0.008);
  first.set_maximum(0.3), first.set_maximum_low(0.2), first.set_maximum_high(0.9);
  v1::MeasuredError& second = *meta.add_errors();
  second.set_section("environment"), second.set_relrmse(0.01);
  *second.mutable_against() = std::string(254, 'a');
  second.mutable_against()->append("\xc3\xa9\xc3\xa9");
  return meta;
}

std::vector<uint8_t> containerOf(const v1::MetaHeader& meta) {
  format::Writer writer;
  writer.addSection("meta", 1, false);
  writer.addMessage("meta", "header", meta);
  return writer.bytes();
}

TEST(MeasuredErrors, AreReadAsTheyWereWritten) {
  const auto bytes = containerOf(twoErrors());
  Host host;
  const lw_config config = host.config();
  {
    const Container container = openMemory(bytes, &config);
    uint32_t count = 7;
    ASSERT_EQ(lw_count_measured_errors(container.get(), nullptr, &count), LW_OK);
    EXPECT_EQ(count, 2u);
    ASSERT_EQ(lw_count_measured_errors(container.get(), "environment", &count), LW_OK);
    EXPECT_EQ(count, 1u);
    ASSERT_EQ(lw_count_measured_errors(container.get(), "vpl", &count), LW_OK);
    EXPECT_EQ(count, 0u);
    lw_measured_error error{};
    ASSERT_EQ(lw_get_measured_error(container.get(), "prm", 0, &error), LW_OK);
    EXPECT_STREQ(error.section, "prm");
    EXPECT_STREQ(error.against, "16 point lights");
    EXPECT_EQ(error.relrmse.value, 0.03);
    EXPECT_EQ(error.relrmse.low, 0.02);
    EXPECT_EQ(error.relrmse.high, 0.05);
    EXPECT_EQ(error.texrel.value, 0.04);
    EXPECT_EQ(error.texrel.low, 0.01);
    EXPECT_EQ(error.texrel.high, 0.06);
    EXPECT_EQ(error.bias.value, -0.001);
    EXPECT_EQ(error.bias.low, -0.01);
    EXPECT_EQ(error.bias.high, 0.008);
    EXPECT_EQ(error.maximum.value, 0.3);
    EXPECT_EQ(error.maximum.low, 0.2);
    EXPECT_EQ(error.maximum.high, 0.9);
    EXPECT_EQ(error.texels, 1011u);
    EXPECT_EQ(error.seconds, 2.5);
    ASSERT_EQ(lw_get_measured_error(container.get(), nullptr, 1, &error), LW_OK);
    EXPECT_STREQ(error.section, "environment");
    EXPECT_EQ(error.relrmse.high, 0) << "an older bake, which knew no interval";
    EXPECT_EQ(std::string(error.against), std::string(254, 'a')) << "no half of a character is left";
    EXPECT_EQ(lw_get_measured_error(container.get(), "environment", 1, &error), LW_NOT_FOUND);
    EXPECT_NE(host.message.find("environment"), std::string::npos);
    EXPECT_EQ(lw_get_measured_error(nullptr, nullptr, 0, &error), LW_INVALID_ARGUMENT);
    lw_measured_error all[3];
    ASSERT_EQ(lw_get_measured_errors(container.get(), nullptr, 2, all), LW_OK);
    EXPECT_EQ(all[0].relrmse.value, 0.03);
    EXPECT_EQ(all[1].relrmse.value, 0.01);
    EXPECT_EQ(lw_get_measured_errors(container.get(), "environment", 1, all), LW_OK);
    EXPECT_STREQ(all[0].section, "environment");
    EXPECT_EQ(lw_get_measured_errors(container.get(), "environment", 0, nullptr), LW_OK);
    EXPECT_EQ(lw_get_measured_errors(container.get(), nullptr, 3, all), LW_NOT_FOUND);
    EXPECT_EQ(lw_get_measured_errors(container.get(), nullptr, 1, nullptr), LW_INVALID_ARGUMENT);
    EXPECT_EQ(lw_count_measured_errors(container.get(), nullptr, nullptr), LW_INVALID_ARGUMENT);
  }
  EXPECT_EQ(host.live, 0u);
}

TEST(MeasuredErrors, NothingWasMeasured) {
  format::Writer writer;
  writer.addSection("x_none", 1, false);
  const auto bytes = writer.bytes();
  const Container container = openMemory(bytes);
  uint32_t count = 7;
  EXPECT_EQ(lw_count_measured_errors(container.get(), nullptr, &count), LW_OK);
  EXPECT_EQ(count, 0u);
  lw_measured_error error;
  EXPECT_EQ(lw_get_measured_error(container.get(), nullptr, 0, &error), LW_NOT_FOUND);
}

TEST(MeasuredErrors, NumbersThatCannotBeAreRefused) {
  const std::function<void(v1::MeasuredError&)> breaches[] = {
      [](auto& e) { e.set_relrmse(NAN); },      [](auto& e) { e.set_texrel(-1); },      [](auto& e) { e.set_relrmse_low(0.1); },
      [](auto& e) { e.set_bias_high(INFINITY); }, [](auto& e) { e.set_maximum_low(NAN); }, [](auto& e) { e.set_seconds(-1); }};
  for (const auto& breach : breaches) {
    v1::MetaHeader meta = twoErrors();
    breach(*meta.mutable_errors(0));
    const auto bytes = containerOf(meta);
    const Container container = openMemory(bytes);
    lw_measured_error error{};
    EXPECT_EQ(lw_get_measured_errors(container.get(), nullptr, 2, std::array<lw_measured_error, 2>{}.data()), LW_BAD_SECTION);
    EXPECT_EQ(lw_get_measured_error(container.get(), "prm", 0, &error), LW_BAD_SECTION) << meta.errors(0).ShortDebugString();
  }
  // A message cut anywhere: an error, or fewer fields; never a crash.
  const std::string whole = twoErrors().SerializeAsString();
  for (size_t size = 0; size < whole.size(); ++size) {
    format::Writer writer;
    writer.addSection("meta", 1, false);
    writer.addRaw("meta", "header", format::ElementType::bytes, std::as_bytes(std::span(whole.data(), size)), std::array<uint64_t, 1>{size});
    const auto bytes = writer.bytes();
    const Container container = openMemory(bytes);
    uint32_t count = 0;
    const lw_result result = lw_count_measured_errors(container.get(), nullptr, &count);
    EXPECT_TRUE(result == LW_OK || result == LW_BAD_SECTION) << size << ": " << result;
  }
}

}  // namespace
}  // namespace lightwell::test
