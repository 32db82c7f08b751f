#include "precompute/transport/environment/environment_map.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTileDescription.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "precompute/core/random.h"
#include "tests/environment/skies.h"

namespace lightwell::transport {
namespace {

class MapFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("lightwell-map-" + std::to_string(::getpid()) + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  std::vector<Rgb> read(const std::filesystem::path& file) {
    EnvironmentMap map(openRowSource(file, diagnostics_), file.string());
    std::vector<Rgb> pixels(size_t(map.width()) * size_t(map.height()), Rgb(-1));
    map.visitRows(diagnostics_, nullptr, [&](int row, std::span<const Rgb> values) {
      std::copy(values.begin(), values.end(), pixels.begin() + long(row) * map.width());
    });
    return pixels;
  }
  /// The message of the InputError that reading `file` ends in.
  std::string rejection(const std::filesystem::path& file) {
    try {
      read(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  Diagnostics diagnostics_;
  std::filesystem::path folder_;
};

// ---- Radiance. Texel (x, y) holds mantissas (x + 1, y + 1, 128), exponent 129: values (m / 128).

constexpr int kWidth = 16, kHeight = 4;
std::string header(const std::string& resolution, const std::string& extra = "") {
  return "#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\n" + extra + "\n" + resolution + "\n";
}
std::string texel(int x, int y) { return {char(x + 1), char(y + 3), char(128), char(129)}; }
std::vector<Rgb> expected() {
  std::vector<Rgb> pixels;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) pixels.push_back(Rgb(float(x + 1), float(y + 3), 128) / 128.0f);
  return pixels;
}
std::string flat(bool bottom_up, bool right_to_left) {
  std::string bytes;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) bytes += texel(right_to_left ? kWidth - 1 - x : x, bottom_up ? kHeight - 1 - y : y);
  return bytes;
}
std::string components() {
  std::string bytes;
  for (int y = 0; y < kHeight; ++y) {
    bytes += std::string("\2\2\0", 3) + char(kWidth);
    bytes += char(kWidth);  // a literal of reds, then three runs
    for (int x = 0; x < kWidth; ++x) bytes += char(x + 1);
    for (char value : {char(y + 3), char(128), char(129)}) bytes += std::string{char(128 + kWidth), value};
  }
  return bytes;
}

TEST_F(MapFiles, RadianceFlatInEveryRowDirection) {
  for (const auto& [resolution, up, left] : {std::tuple{"-Y 4 +X 16", false, false}, std::tuple{"+Y 4 +X 16", true, false},
                                             std::tuple{"-Y 4 -X 16", false, true}, std::tuple{"+Y 4 -X 16", true, true}})
    EXPECT_EQ(read(write("flat.hdr", header(resolution) + flat(up, left))), expected()) << resolution;
}

TEST_F(MapFiles, RadianceColumnsAreRejectedByName) {
  for (const char* resolution : {"+X 16 -Y 4", "-X 16 -Y 4", "+X 16 +Y 4", "-X 16 +Y 4"})
    EXPECT_NE(rejection(write("columns.hdr", header(resolution) + flat(false, false))).find("columns"), std::string::npos);
}

TEST_F(MapFiles, RadianceComponentRuns) { EXPECT_EQ(read(write("new.hdr", header("-Y 4 +X 16") + components())), expected()); }

TEST_F(MapFiles, RadianceOldRuns) {
  // 300 equal texels: one, then a repeat of 43 = 0x2b, then of 1 << 8.
  const std::string line = texel(0, 0) + std::string("\1\1\1\x2b", 4) + std::string("\1\1\1\1", 4);
  const std::vector<Rgb> pixels = read(write("old.hdr", header("-Y 1 +X 300") + line));
  ASSERT_EQ(pixels.size(), 300u);
  for (const Rgb& p : pixels) EXPECT_EQ(p, expected()[0]);
}

TEST_F(MapFiles, RadianceExposureIsUndone) {
  const auto pixels = read(write("exposure.hdr", header("-Y 4 +X 16", "EXPOSURE=2\nEXPOSURE=4\nCOLORCORR=1 2 0.5\n") + flat(false, false)));
  const Rgb first = expected()[0];
  EXPECT_EQ(pixels[0], Rgb(first.x / 8, first.y / 16, first.z / 4));
}

TEST_F(MapFiles, RadianceXyzBecomesRgb) {
  std::string bytes = header("-Y 1 +X 1");
  bytes.replace(bytes.find("rgbe"), 4, "xyze");
  const Rgb white = read(write("xyz.hdr", bytes + std::string{char(128), char(128), char(128), char(129)}))[0];
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(white[c], 1, 2e-3);
}

TEST_F(MapFiles, EveryTruncationOfARadianceFileIsRejected) {
  for (const std::string& body : {flat(false, false), components()}) {
    const std::string whole = header("-Y 4 +X 16") + body;
    for (size_t length = 0; length < whole.size(); ++length)
      ASSERT_NE(rejection(write("cut.hdr", whole.substr(0, length))), "accepted") << length;
  }
}

TEST_F(MapFiles, DamagedRadianceFiles) {
  const auto rejected = [&](const std::string& bytes, const char* why) {
    EXPECT_NE(rejection(write("bad.hdr", bytes)).find(why), std::string::npos) << rejection(path("bad.hdr"));
  };
  rejected(header("-Y 0 +X 16"), "unusable size");
  rejected(header("-Y 99999999 +X 99999999"), "unusable size");
  rejected(header("-Y 30000 +X 60000"), "unusable size");
  rejected(header("-Y four +X 16"), "no resolution line");
  rejected("#?RADIANCE\nFORMAT=something\n\n-Y 1 +X 1\n", "FORMAT");
  rejected(header("-Y 1 +X 16", "EXPOSURE=0\n"), "EXPOSURE");
  rejected("#?" + std::string(9000, 'x'), "line of more than");
  rejected(header("-Y 1 +X 16") + std::string("\2\2\0\x11", 4), "17 texels");
  rejected(header("-Y 1 +X 16") + std::string("\2\2\0\x10\xff\5", 6), "passes the end");
  rejected(header("-Y 1 +X 16") + std::string("\2\2\0\x10\0\5", 6), "passes the end");
  rejected(header("-Y 1 +X 16") + std::string("\1\1\1\5", 4), "repeat");
  rejected("GIF89a", "neither");
  EXPECT_NE(rejection(path("missing.hdr")).find("cannot be read"), std::string::npos);
  EXPECT_NE(rejection(folder_).find("cannot be read"), std::string::npos);
}

// ---- OpenEXR. Channel c of texel (x, y) holds 100 c + 10 y + x, exact in half.

float exrValue(int c, int x, int y) { return float(100 * c + 10 * y + x); }

/// Pixels of a data window, one plane per channel; float or half by `Value`.
template <class Value>
struct Planes {
  Imath::Box2i window;
  std::vector<std::vector<Value>> plane;
  Planes(const Imath::Box2i& window, int channels) : window(window), plane(size_t(channels)) {
    for (int c = 0; c < channels; ++c)
      for (int y = window.min.y; y <= window.max.y; ++y)
        for (int x = window.min.x; x <= window.max.x; ++x) plane[size_t(c)].push_back(Value(exrValue(c, x, y)));
  }
  Imf::FrameBuffer frame(const std::vector<std::string>& names) {
    Imf::FrameBuffer buffer;
    const size_t width = size_t(window.max.x - window.min.x + 1);
    for (size_t c = 0; c < names.size(); ++c)
      buffer.insert(names[c], Imf::Slice::Make(sizeof(Value) == 2 ? Imf::HALF : Imf::FLOAT, plane[c].data(), window, sizeof(Value),
                                               sizeof(Value) * width));
    return buffer;
  }
};
Imf::Header exrHeader(const Imath::Box2i& display, const Imath::Box2i& data, const std::vector<std::string>& names, Imf::PixelType type) {
  Imf::Header result(display, data);
  result.compression() = Imf::ZIP_COMPRESSION;
  for (const std::string& name : names) result.channels().insert(name, Imf::Channel(type));
  return result;
}
const Imath::Box2i kWindow({0, 0}, {19, 9});
void expectExr(const std::vector<Rgb>& pixels, bool luminance_only = false) {
  ASSERT_EQ(pixels.size(), 200u);
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 20; ++x)
      for (int c = 0; c < 3; ++c) ASSERT_EQ(pixels[size_t(y) * 20 + size_t(x)][c], exrValue(luminance_only ? 0 : c, x, y));
}

TEST_F(MapFiles, OpenExrScanLinesHalfAndFloatInBothOrders) {
  const std::vector<std::string> rgb = {"R", "G", "B"};
  for (Imf::LineOrder order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
    Imf::Header half_header = exrHeader(kWindow, kWindow, rgb, Imf::HALF);
    half_header.lineOrder() = order;
    {
      Planes<half> planes(kWindow, 3);
      Imf::OutputFile out(path("half.exr").c_str(), half_header);
      out.setFrameBuffer(planes.frame(rgb));
      out.writePixels(10);
    }
    expectExr(read(path("half.exr")));
  }
  {
    Planes<float> planes(kWindow, 3);
    Imf::OutputFile out(path("float.exr").c_str(), exrHeader(kWindow, kWindow, rgb, Imf::FLOAT));
    out.setFrameBuffer(planes.frame(rgb));
    out.writePixels(10);
  }
  expectExr(read(path("float.exr")));
}

TEST_F(MapFiles, OpenExrTilesAndLayers) {
  const std::vector<std::string> names = {"sky.R", "sky.G", "sky.B"};
  Imf::Header tiled = exrHeader(kWindow, kWindow, names, Imf::FLOAT);
  tiled.setTileDescription(Imf::TileDescription(7, 3, Imf::ONE_LEVEL));
  {
    Planes<float> planes(kWindow, 3);
    Imf::TiledOutputFile out(path("tiled.exr").c_str(), tiled);
    out.setFrameBuffer(planes.frame(names));
    out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
  }
  expectExr(read(path("tiled.exr")));
}

TEST_F(MapFiles, OpenExrLuminanceInTheSecondPart) {
  std::vector<Imf::Header> parts = {exrHeader(kWindow, kWindow, {"Z"}, Imf::FLOAT), exrHeader(kWindow, kWindow, {"Y"}, Imf::HALF)};
  for (size_t i = 0; i < 2; ++i) parts[i].setName(i ? "sky" : "depth"), parts[i].setType(Imf::SCANLINEIMAGE);
  {
    Planes<float> depth(kWindow, 1);
    Planes<half> sky(kWindow, 1);
    Imf::MultiPartOutputFile out(path("parts.exr").c_str(), parts.data(), 2);
    Imf::OutputPart first(out, 0), second(out, 1);
    first.setFrameBuffer(depth.frame({"Z"}));
    first.writePixels(10);
    second.setFrameBuffer(sky.frame({"Y"}));
    second.writePixels(10);
  }
  expectExr(read(path("parts.exr")), true);
}

TEST_F(MapFiles, OpenExrDataWindowAgainstDisplayWindow) {
  const Imath::Box2i display({0, 0}, {15, 7}), data({-3, 2}, {11, 9});  // overscan at the left and below, empty at the right and above
  const std::vector<std::string> rgb = {"R", "G", "B"};
  {
    Planes<float> planes(data, 3);
    Imf::OutputFile out(path("window.exr").c_str(), exrHeader(display, data, rgb, Imf::FLOAT));
    out.setFrameBuffer(planes.frame(rgb));
    out.writePixels(8);
  }
  const std::vector<Rgb> pixels = read(path("window.exr"));
  ASSERT_EQ(pixels.size(), 16u * 8u);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x)
      for (int c = 0; c < 3; ++c)
        ASSERT_EQ(pixels[size_t(y) * 16 + size_t(x)][c], y >= 2 && x <= 11 ? exrValue(c, x, y) : 0.0f) << x << " " << y;
}

/// The bytes of a sound file, written to `file`.
std::string wholeExr(const std::filesystem::path& file) {
  const std::vector<std::string> rgb = {"R", "G", "B"};
  {
    Planes<float> planes(kWindow, 3);
    Imf::OutputFile out(file.c_str(), exrHeader(kWindow, kWindow, rgb, Imf::FLOAT));
    out.setFrameBuffer(planes.frame(rgb));
    out.writePixels(10);
  }
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(MapFiles, DamagedOpenExrFiles) {
  const std::string whole = wholeExr(path("whole.exr"));
  for (size_t length = 0; length < whole.size(); length += 7)
    ASSERT_NE(rejection(write("cut.exr", whole.substr(0, length))), "accepted") << length;
  {
    Planes<float> planes(kWindow, 1);
    Imf::OutputFile out(path("depth.exr").c_str(), exrHeader(kWindow, kWindow, {"Z"}, Imf::FLOAT));
    out.setFrameBuffer(planes.frame({"Z"}));
    out.writePixels(10);
  }
  EXPECT_NE(rejection(path("depth.exr")).find("Z"), std::string::npos);
}

/// The kilobyte of a header that claims an attribute of 1.8 GB takes no 1.8 GB, which OpenEXR would clear before it read them.
TEST_F(MapFiles, OpenExrAttributesLongerThanTheFileAreRejectedUnread) {
  const std::string whole = wholeExr(path("whole.exr"));
  const auto peakBytes = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return int64_t(usage.ru_maxrss) * 1024;
  };
  const int64_t before = peakBytes();
  for (const std::string type : {"string", "stringvector", "floatvector", "preview", "of_no_known_type"}) {
    const std::string attribute = std::string("note") + '\0' + type + '\0' + std::string("\0\0\0\x6f", 4) + "text";
    EXPECT_NE(rejection(write("claims.exr", whole.substr(0, 8) + attribute + whole.substr(8))).find("Invalid size"), std::string::npos) << type;
  }
  EXPECT_LT(peakBytes() - before, 64 << 20);
}

TEST_F(MapFiles, OpenExrBlocksThatAreTooLargeAreRejectedByTheirSize) {
  const Imath::Box2i wide({0, 0}, {(1 << 20) - 1, 0});
  const auto rejectionOf = [&](Imf::Compression compression, const char* name) {
    Imf::Header given = exrHeader(Imath::Box2i({0, 0}, {63, 0}), wide, {"R", "G", "B"}, Imf::FLOAT);
    given.compression() = compression;
    {
      Planes<float> planes(wide, 3);
      Imf::OutputFile out(path(name).c_str(), given);
      out.setFrameBuffer(planes.frame({"R", "G", "B"}));
      out.writePixels(1);
    }
    return rejection(path(name));
  };
  EXPECT_NE(rejectionOf(Imf::ZIP_COMPRESSION, "zip.exr").find("compression: packs 16 rows of 1048576 texels together"), std::string::npos);
  EXPECT_EQ(rejectionOf(Imf::ZIPS_COMPRESSION, "zips.exr"), "accepted");
}

TEST_F(MapFiles, FlippedBytesAreReadOrRejected) {
  const std::vector<std::string> rgb = {"R", "G", "B"};
  {
    Planes<half> planes(kWindow, 3);
    Imf::OutputFile out(path("whole.exr").c_str(), exrHeader(kWindow, kWindow, rgb, Imf::HALF));
    out.setFrameBuffer(planes.frame(rgb));
    out.writePixels(10);
  }
  std::ifstream in(path("whole.exr"), std::ios::binary);
  const std::string exr{std::istreambuf_iterator<char>(in), {}};
  for (const std::string& whole : {exr, header("-Y 4 +X 16") + components(), header("-Y 4 +X 16") + flat(false, false)})
    for (uint64_t i = 0; i < 400; ++i) {
      std::string damaged = whole;
      const uint32_t where = mixBits(2 * i) % damaged.size();
      damaged[where] = char(uint8_t(damaged[where]) ^ (1u << mixBits(2 * i + 1) % 8));
      try {
        for (const Rgb& value : read(write("flipped", damaged)))
          ASSERT_TRUE(isFinite(value) && value.x >= 0 && value.y >= 0 && value.z >= 0);
      } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("flipped"), std::string::npos);
      }
    }
}

// ---- Placement and repair.

TEST(EnvironmentMap, RepairsAreCounted) {
  std::vector<Rgb> pixels(32, Rgb(1));
  pixels[3].x = std::nanf("");
  pixels[4].y = -2;
  pixels[5].z = std::numeric_limits<float>::infinity();
  pixels[6].z = 1e30f;
  EnvironmentMap map(memoryRowSource(8, 4, pixels), "broken");
  Diagnostics diagnostics;
  map.visitRows(diagnostics, nullptr, [&](int row, std::span<const Rgb> values) {
    for (const Rgb& v : values) EXPECT_TRUE(isFinite(v) && v.x >= 0 && v.y >= 0);
    if (row == 0) {
      EXPECT_TRUE(values[3].x == 0 && values[4].y == 0 && values[5].z == 65504);
    }
  });
  const auto warnings = diagnostics.warnings();
  ASSERT_EQ(warnings.size(), 3u);
  EXPECT_NE(warnings[0].message.find("1 values are not numbers"), std::string::npos);
  EXPECT_NE(warnings[2].message.find("2 values are infinite"), std::string::npos);
}

TEST(EnvironmentMap, DirectionsAndSolidAngles) {
  const EnvironmentMap map = makeSky(64, 32, [](const Vec3&) { return Rgb(1); });
  EXPECT_NEAR((map.direction(0, 0) - Vec3d(0, 1, 0)).length(), 0, 1e-12);
  EXPECT_NEAR((map.direction(32, 16) - Vec3d(1, 0, 0)).length(), 0, 1e-12);  // u = 1/2: atan2(z, x) = 0
  EXPECT_NEAR((map.direction(48, 16) - Vec3d(0, 0, 1)).length(), 0, 1e-12);
  double sum = 0;
  for (int row = 0; row < 32; ++row) sum += 64 * map.texelSolidAngle(row);
  EXPECT_NEAR(sum / (4 * std::numbers::pi), 1, 1e-14);
}

TEST(EnvironmentMap, RotationIntensityAndGround) {
  MapPlacement placement;
  placement.world_from_map = rotationAboutY(std::numbers::pi / 2);  // +x goes to −z
  placement.intensity = 2;
  placement.ground_radiance_rgb = Rgb(5, 0, 0);
  EnvironmentMap map = makeSky(8, 4, [](const Vec3&) { return Rgb(0, 1, 0); }, placement);
  EXPECT_NEAR((map.direction(4, 2) - Vec3d(0, 0, -1)).length(), 0, 1e-12);
  Diagnostics diagnostics;
  map.visitRows(diagnostics, nullptr, [](int row, std::span<const Rgb> values) {
    for (const Rgb& v : values) EXPECT_EQ(v, row < 2 ? Rgb(0, 2, 0) : Rgb(10, 0, 0));
  });
  placement.world_from_map[0][0] = 3;
  EXPECT_THROW(makeSky(8, 4, [](const Vec3&) { return Rgb(0); }, placement), UsageError);
}

}  // namespace
}  // namespace lightwell::transport
