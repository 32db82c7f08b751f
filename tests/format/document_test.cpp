// docs/format.md is the specification: its hex example opens, and its lists name everything that the code knows.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <sstream>

#include "format/encode/reader.h"
#include "format/encode/verify.h"
#include "tests/format/content.h"

namespace lightwell::format {
namespace {

std::string document() {
  std::ifstream stream(SOURCE_FOLDER "/docs/format.md");
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The example's writer; the document shows its bytes.
Writer exampleWriter() {
  Writer writer;
  writer.addSection("sample", 1, false);
  writer.add("sample", "ramp", std::vector<uint16_t>{1, 2, 3}, {3});
  return writer;
}

std::vector<uint8_t> hexExample(const std::string& text) {
  const size_t begin = text.find("```hex\n"), end = text.find("```", begin + 3);
  std::vector<uint8_t> bytes;
  if (begin == std::string::npos) return bytes;
  std::istringstream lines(text.substr(begin + 7, end - begin - 7));
  for (std::string line; std::getline(lines, line);) {
    // "offset  bytes  | what they are"
    std::istringstream words(line.substr(0, line.find('|')));
    size_t offset = 0;
    words >> std::hex >> offset;
    EXPECT_EQ(offset, bytes.size()) << line;
    for (unsigned byte; words >> std::hex >> byte;) bytes.push_back(uint8_t(byte));
  }
  return bytes;
}

TEST(Document, HexExampleIsTheFileThatItDescribes) {
  const std::vector<uint8_t> bytes = hexExample(document());
  ASSERT_FALSE(bytes.empty());
  EXPECT_EQ(bytes, exampleWriter().bytes());
  const Reader reader(bytes);
  EXPECT_EQ(reader.read<uint16_t>("sample", "ramp"), (std::vector<uint16_t>{1, 2, 3}));
}

TEST(Document, NamesEveryStatusIssueSectionAndChunk) {
  const std::string text = document();
  const auto has = [&](const std::string& word) { return text.find(word) != std::string::npos; };
  for (int code = 0; code < 100; ++code)
    if (const std::string name = statusName(Status(code)); name != "unknown") {
      EXPECT_TRUE(has("| " + std::to_string(code) + " | `" + name + "`")) << name;
    }
  for (const int id : {1001, 2001, 2002, 2003, 2004, 2005, 3001, 3002, 3003, 3004, 3005, 3006, 3007, 3008, 4001, 4002, 4003})
    EXPECT_TRUE(has("| " + std::to_string(id) + " |")) << id;
  for (const KnownSection& section : kKnownSections) EXPECT_TRUE(has("### Section `" + std::string(section.type) + "`")) << section.type;
  for (const Content& content : {panesContent(), localBasesContent()}) {
    const Reader reader(toWriter(content).bytes());
    for (const ChunkInfo& chunk : reader.view().chunks()) {
      std::string name(chunk.name);
      if (name.starts_with("alpha_texture_")) name = "alpha_texture_<i>";
      EXPECT_TRUE(has("| `" + name + "` |") || has("| [ `" + name + "` ] |")) << name;
    }
  }
}

}  // namespace
}  // namespace lightwell::format
