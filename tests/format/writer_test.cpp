// The Writer's own promises: determinism, the choice of codec, whole files or none.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include "format/encode/atomic_file.h"
#include "format/encode/reader.h"
#include "format/encode/verify.h"
#include "tests/format/content.h"

namespace lightwell::format {
namespace {

namespace fs = std::filesystem;

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "lightwell-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }
  size_t entries() const { return size_t(std::distance(fs::directory_iterator(path_), fs::directory_iterator())); }

 private:
  fs::path path_;
};

TEST(Writer, SameCallsSameBytes) {
  const std::vector<uint8_t> first = toWriter(localBasesContent()).bytes();
  std::vector<uint8_t> second;
  std::thread([&] { second = toWriter(localBasesContent()).bytes(); }).join();
  EXPECT_EQ(first, second);
}

TEST(Writer, TakesTheSmallestCodec) {
  Writer writer;
  writer.addSection("s", 1, false);
  std::vector<uint32_t> offsets(5000);
  std::vector<float> smooth(5000);
  std::vector<uint8_t> noise(500);
  for (uint32_t i = 0; i < 5000; ++i) {
    offsets[i] = i * 17 + (i * i % 3);
    smooth[i] = std::sqrt(float(i + 1));
  }
  std::mt19937 random(1);
  for (uint8_t& value : noise) value = uint8_t(random());
  writer.add("s", "offsets", offsets);
  writer.add("s", "smooth", smooth);
  writer.add("s", "noise", noise);
  writer.add("s", "zeros", std::vector<uint8_t>(5000));
  const Reader reader(writer.bytes());
  EXPECT_EQ(reader.chunk("s", "offsets").codec, Codec::zstd_delta_planes);
  EXPECT_EQ(reader.chunk("s", "smooth").codec, Codec::zstd_planes);
  EXPECT_EQ(reader.chunk("s", "noise").codec, Codec::raw);
  EXPECT_EQ(reader.chunk("s", "zeros").codec, Codec::zstd);
  EXPECT_EQ(writer.storedBytes("s", "noise"), 500u);
  EXPECT_LT(writer.storedBytes("s", "offsets"), 5000u);
}

TEST(Writer, RefusesMisuse) {
  Writer writer;
  writer.addSection("s");
  const std::vector<float> values(6);
  EXPECT_THROW(writer.addSection("s"), std::invalid_argument);
  EXPECT_THROW(writer.addSection("Upper"), std::invalid_argument);
  EXPECT_THROW(writer.addSection("t", 0), std::invalid_argument);
  EXPECT_THROW(writer.add("t", "c", values), std::invalid_argument);
  EXPECT_THROW(writer.add("s", "", values), std::invalid_argument);
  EXPECT_THROW(writer.add("s", "c", values, {4, 2}), std::invalid_argument);
  EXPECT_THROW(writer.add("s", "c", values, {1, 1, 1, 1, 6}), std::invalid_argument);
  writer.add("s", "c", values, {2, 3});
  EXPECT_THROW(writer.add("s", "c", values), std::invalid_argument);
}

TEST(Writer, FileEqualsBytesAndReplacesTheOldOne) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "scene.lwc";
  std::ofstream(file) << "old";
  const Writer writer = toWriter(panesContent());
  writer.write(file);
  std::ifstream stream(file, std::ios::binary);
  EXPECT_EQ((std::vector<uint8_t>{std::istreambuf_iterator<char>(stream), {}}), writer.bytes());
  EXPECT_EQ(folder.entries(), 1u);
  EXPECT_TRUE(isSound(verify(file)));
  EXPECT_EQ(Reader(file).atlas().width(), 4u);
}

TEST(AtomicFile, FailureLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  const std::vector<uint8_t> bytes(100, 7);
  EXPECT_THROW(writeFileAtomically(folder.path() / "missing" / "a.lwc", bytes), std::runtime_error);
  EXPECT_THROW(writeFileAtomically(folder.path(), bytes), std::runtime_error);
  EXPECT_THROW(writeFileAtomically("/dev/null", bytes), std::runtime_error);
  EXPECT_EQ(folder.entries(), 0u);
  const fs::path pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(writeFileAtomically(pipe, bytes), std::runtime_error);
  EXPECT_THROW(Reader{pipe}, std::system_error);
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(AtomicFile, FollowsASymbolicLink) {
  const TemporaryFolder folder;
  const fs::path target = folder.path() / "target.lwc", link = folder.path() / "link.lwc";
  std::ofstream(target) << "old";
  fs::create_symlink(target, link);
  const std::vector<uint8_t> bytes(100, 7);
  writeFileAtomically(link, bytes);
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(fs::file_size(target), 100u);
}

TEST(Reader, ErrorsNameFileByteAndReason) {
  std::vector<uint8_t> bytes = toWriter(panesContent()).bytes();
  bytes.back() ^= 1;
  const Reader reader(bytes, "room.lwc");
  try {
    reader.read<uint32_t>("prm", "emitter_indirect", ElementType::rgb9e5);
    FAIL();
  } catch (const ContainerError& error) {
    EXPECT_EQ(error.status, Status::bad_checksum);
    EXPECT_EQ(error.offset, reader.chunk("prm", "emitter_indirect").offset);
    EXPECT_NE(std::string(error.what()).find("room.lwc: byte "), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("prm/emitter_indirect: checksum differs"), std::string::npos);
  }
  EXPECT_THROW(reader.read<uint32_t>("prm", "pane"), ContainerError);  // it is RGB9E5
  EXPECT_THROW(reader.read<uint32_t>("prm", "nothing"), ContainerError);
  EXPECT_THROW((void)reader.readMessage<v1::PrmHeader>("meta", "other"), ContainerError);
  EXPECT_EQ(reader.meta().provenance().scene_name(), "two triangles.glb");
  EXPECT_TRUE(reader.has("prm"));
  EXPECT_FALSE(reader.has("vpl"));
}

}  // namespace
}  // namespace lightwell::format
