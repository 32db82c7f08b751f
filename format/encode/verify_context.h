// What the checks of the sections share: loading a chunk against its table row, and reporting. Internal to verify.
#pragma once
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "format/encode/verify.h"
#include "format/encode/writer.h"

namespace google::protobuf {
class Message;
}

namespace lightwell::format {

/// An extent that the checker does not know beforehand.
inline constexpr uint64_t kAnyExtent = ~uint64_t(0);

class VerifyContext {
 public:
  static constexpr size_t kMaxIssues = 100;

  explicit VerifyContext(const View& view) : view_(view) {}
  const View& view() const { return view_; }
  std::vector<Issue>& issues() { return issues_; }

  void report(IssueId id, std::string_view section, std::string_view name, std::string message);
  void note(IssueId id, std::string_view section, std::string_view name, std::string message);

  /// Whether the section is there in a known version.
  bool has(std::string_view section) const;
  const ChunkInfo* find(std::string_view section, std::string_view name) const { return view_.findChunk(section, name); }

  /// The values of a chunk that must exist with this element type and shape; nullopt after reporting why not. Each chunk is decoded once
  /// by the checks; asking again for a damaged one reports nothing new.
  template <class T>
  std::optional<std::vector<T>> load(std::string_view section, std::string_view name, ElementType element,
                                     std::initializer_list<uint64_t> shape) {
    const ChunkInfo* chunk = expect(section, name, element, {shape.begin(), shape.size()});
    if (!chunk) return std::nullopt;
    std::vector<T> values(chunk->raw_bytes / sizeof(T));
    if (!decode(*chunk, values.data())) return std::nullopt;
    return values;
  }
  template <class T>
  std::optional<std::vector<T>> load(std::string_view section, std::string_view name, std::initializer_list<uint64_t> shape) {
    return load<T>(section, name, detail::elementTypeOf<T>(), shape);
  }
  /// Decodes a BYTES chunk into a message.
  bool loadMessage(std::string_view section, std::string_view name, google::protobuf::Message& message);

  /// Reports the first value for which `wrong(value)` holds, with its index and how many more there are.
  template <class T, class Predicate>
  bool checkEach(const std::vector<T>& values, IssueId id, std::string_view section, std::string_view name, const char* what,
                 Predicate wrong) {
    size_t count = 0, first = 0;
    for (size_t i = 0; i < values.size(); ++i)
      if (wrong(values[i]) && count++ == 0) first = i;
    if (count > 0)
      report(id, section, name, std::to_string(count) + " of " + std::to_string(values.size()) + " values " + what +
                                    ", the first at index " + std::to_string(first));
    return count == 0;
  }
  bool checkFinite(const std::vector<float>& values, std::string_view section, std::string_view name);
  /// offsets[0] = 0, the last = `end`, rising strictly or not falling.
  bool checkOffsets(const std::vector<uint32_t>& offsets, uint64_t end, bool strictly, std::string_view section, std::string_view name);

  /// Decodes every chunk that no check has touched, and notes those that the tables do not list.
  void checkRemaining();

 private:
  const ChunkInfo* expect(std::string_view section, std::string_view name, ElementType element, std::span<const uint64_t> shape);
  bool decode(const ChunkInfo& chunk, void* destination);
  void add(IssueId id, Status status, bool is_note, uint64_t offset, std::string place, std::string message);

  const View& view_;
  std::vector<Issue> issues_;
  std::set<const ChunkInfo*> listed_;   // by some table row
  std::set<const ChunkInfo*> decoded_;  // successfully or reported
};

// One per section of version 1. Each is called when the section is there.
/// Reports values that belong to no covered texel of the atlas, or do not ascend.
void checkTexels(VerifyContext& context, std::string_view section, const std::vector<uint32_t>& texel);
/// Loads the chunks gate_set_first and gate_set of a section and reports sets that are empty of sense, name no gate or do not ascend.
struct GateSetChunks {
  std::optional<std::vector<uint32_t>> first;
  std::optional<std::vector<uint16_t>> entry;
  bool good = false;
};
GateSetChunks loadGateSets(VerifyContext& context, std::string_view section, uint64_t gates);

void verifyMeta(VerifyContext& context);
void verifyScene(VerifyContext& context);
void verifyGeometry(VerifyContext& context);
void verifyAtlas(VerifyContext& context);
void verifyPrm(VerifyContext& context);
void verifyPrmProbes(VerifyContext& context);
void verifyEnvironment(VerifyContext& context);
void verifyRadiosity(VerifyContext& context);
void verifyProbes(VerifyContext& context);
void verifyLightmap(VerifyContext& context);
void verifyVpl(VerifyContext& context);
void verifyPoints(VerifyContext& context);

}  // namespace lightwell::format
