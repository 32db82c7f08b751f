#include "precompute/core/image.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <limits>

#include "precompute/core/error.h"

namespace lightwell {
namespace {

class Image : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("lightwell-image-" + std::to_string(::getpid()) + "-" + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static ImageRgba gradient(int width, int height) {
    ImageRgba image{width, height, {}};
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) image.pixels.push_back({0.1f * x, -3.5f * y, 1e30f / (1 + x), float((x + y) % 2)});
    return image;
  }
  /// A half-float file with the given channels, all of them holding x + 1.
  std::filesystem::path writeChannels(std::initializer_list<const char*> names) const {
    const std::filesystem::path file = folder_ / "channels.exr";
    constexpr int kWidth = 4, kHeight = 2;
    Imf::Header header(kWidth, kHeight);
    std::vector<half> values;
    for (int i = 0; i < kWidth * kHeight; ++i) values.push_back(half(float(i % kWidth + 1)));
    Imf::FrameBuffer frame;
    for (const char* name : names) {
      header.channels().insert(name, Imf::Channel(Imf::HALF));
      frame.insert(name, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(values.data()), sizeof(half), sizeof(half) * kWidth));
    }
    Imf::OutputFile out(file.c_str(), header);
    out.setFrameBuffer(frame);
    out.writePixels(kHeight);
    return file;
  }

  std::filesystem::path folder_;
};

TEST_F(Image, RoundTripKeepsEveryBitAndTheOrientation) {
  ImageRgba image = gradient(37, 11);
  image.pixels[5][1] = std::numeric_limits<float>::infinity();
  image.pixels[6][2] = std::numeric_limits<float>::denorm_min();
  writeExr(folder_ / "a.exr", image);
  const ImageRgba read = readExr(folder_ / "a.exr");
  EXPECT_EQ(read.width, 37);
  EXPECT_EQ(read.height, 11);
  EXPECT_EQ(read.pixels, image.pixels);
}

TEST_F(Image, ReplacesAFileAndLeavesNothingElse) {
  writeExr(folder_ / "a.exr", gradient(3, 3));
  writeExr(folder_ / "a.exr", gradient(4, 2));
  EXPECT_EQ(readExr(folder_ / "a.exr").width, 4);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(Image, AFailedWriteNamesTheFileAndLeavesNothing) {
  std::filesystem::create_directory(folder_ / "taken");
  std::ofstream(folder_ / "taken" / "content") << "x";
  try {
    writeExr(folder_ / "taken", gradient(2, 2));  // a folder that is not empty cannot be replaced
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("taken"), std::string::npos);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
  EXPECT_THROW(writeExr(folder_ / "no" / "such" / "folder.exr", gradient(2, 2)), std::runtime_error);
  EXPECT_THROW(writeExr(folder_ / "b.exr", ImageRgba{2, 2, {}}), std::runtime_error);
}

TEST_F(Image, HalfWithoutAlphaReadsAsCovered) {
  const ImageRgba image = readExr(writeChannels({"R", "G", "B"}));
  EXPECT_EQ(image.pixels[2], (std::array<float, 4>{3, 3, 3, 1}));
}

TEST_F(Image, LuminanceReadsAsGrey) {
  const ImageRgba image = readExr(writeChannels({"Y", "A"}));
  EXPECT_EQ(image.pixels[1], (std::array<float, 4>{2, 2, 2, 2}));
}

TEST_F(Image, RejectsWhatItCannotRead) {
  EXPECT_THROW(readExr(folder_ / "missing.exr"), InputError);
  std::ofstream(folder_ / "text.exr") << "not a picture";
  EXPECT_THROW(readExr(folder_ / "text.exr"), InputError);
  EXPECT_THROW(readExr(writeChannels({"Z"})), InputError);

  writeExr(folder_ / "a.exr", gradient(40, 40));
  std::ifstream in(folder_ / "a.exr", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  for (size_t length = 0; length < bytes.size(); length += 53) {
    std::ofstream(folder_ / "cut.exr", std::ios::binary) << bytes.substr(0, length);
    EXPECT_THROW(readExr(folder_ / "cut.exr"), InputError) << length;
  }
}

}  // namespace
}  // namespace lightwell
