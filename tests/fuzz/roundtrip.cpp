// Any structure through the writer: what is read back is what was written, whatever names, shapes, elements and values it has.
#include <cstring>
#include <stdexcept>

#include "format/encode/reader.h"
#include "format/encode/verify.h"
#include "format/encode/writer.h"
#include "tests/fuzz/feed.h"
#include "tests/fuzz/require.h"

namespace lightwell::fuzz {
namespace {
using namespace lightwell::format;

struct Written {
  std::string section, name;
  ElementType element;
  std::vector<uint64_t> shape;
  std::string bytes;
};

/// Runs of values, so that the codecs have something to find.
std::string values(Feed& feed, size_t bytes) {
  std::string text;
  while (text.size() < bytes) {
    const std::string piece = feed.bytes(1 + feed.upTo(15));
    for (uint32_t n = 1 + feed.upTo(40); n > 0 && text.size() < bytes; --n) text += piece.empty() ? std::string(1, '\0') : piece;
  }
  text.resize(bytes);
  return text;
}

std::string name(Feed& feed, const char* const (&known)[4]) {
  const uint32_t choice = feed.upTo(7);
  return choice < 4 ? known[choice] : feed.bytes(feed.upTo(70));
}

void run(Feed& feed) {
  constexpr const char* kSections[4] = {"a", "prm", "x_private", "meta"};
  constexpr const char* kNames[4] = {"header", "b", "c", "d9_"};
  Writer writer({.zstd_level = int(1 + feed.upTo(5))});
  std::vector<Written> written;
  for (int call = 0; call < 24 && !feed.empty(); ++call) {
    Written chunk{name(feed, kSections), name(feed, kNames), ElementType(feed.upTo(10)), {}, ""};
    try {
      if (feed.upTo(3) == 0) {
        writer.addSection(chunk.section, feed.upTo(3), false);
        continue;
      }
      uint64_t elements = 1;
      for (uint32_t rank = feed.upTo(5); rank > 0; --rank) elements *= chunk.shape.emplace_back(feed.upTo(9));
      chunk.bytes = values(feed, elements * elementBytes(chunk.element) + (feed.upTo(31) == 0));
      writer.addRaw(chunk.section, chunk.name, chunk.element, {reinterpret_cast<const std::byte*>(chunk.bytes.data()), chunk.bytes.size()}, chunk.shape);
      written.push_back(chunk);
    } catch (const std::invalid_argument&) {  // the writer says no to misuse
    }
  }
  const std::vector<uint8_t> file = writer.bytes();
  const Reader reader(file);
  require(reader.view().chunks().size() == written.size(), "as many chunks as were written");
  for (size_t i = 0; i < written.size(); ++i) {
    const ChunkInfo& chunk = reader.view().chunks()[i];
    require(chunk.section == written[i].section && chunk.name == written[i].name && chunk.element == written[i].element, "the same chunk");
    require(std::vector<uint64_t>(chunk.shape, chunk.shape + chunk.rank) == written[i].shape, "the same shape");
    std::string bytes(chunk.raw_bytes, '\0');
    require(!reader.view().decode(chunk, bytes.data(), bytes.size()), "a chunk that decodes");
    require(bytes == written[i].bytes, "the same values");
  }
  for (const Issue& issue : verify(memorySource(file.data(), file.size()))) require(issue.note || issue.status == Status::bad_section, "a sound file, whatever its values");
}

}  // namespace
}  // namespace lightwell::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  lightwell::fuzz::Feed feed(data, size);
  lightwell::fuzz::run(feed);
  return 0;
}
