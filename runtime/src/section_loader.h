// Decoding a section chunk by chunk: the first failure stays, and what follows it does nothing.
#pragma once
#include "runtime/src/container.h"

namespace lightwell::runtime {

class SectionLoader {
 protected:
  /// `section`: a literal.
  SectionLoader(const lw_container& container, const char* section) : container_(container), section_(section) {}

  lw_result bad(const char* chunk, const char* reason) { return result_ = container_.host.fail(LW_BAD_SECTION, "%s/%s: %s", section_, chunk, reason); }
  void require(bool good, const char* chunk, const char* reason) {
    if (!result_ && !good) bad(chunk, reason);
  }
  template <class T>
  bool decode(const char* name, format::ElementType element, uint64_t elements, Array<T>& values) {
    if (!result_) result_ = decodeChunk(container_, section_, name, element, elements, values);
    return !result_;
  }
  /// The number of elements of a chunk whose size no header gives.
  uint64_t elementsOf(const char* name) {
    const format::ChunkInfo* chunk = nullptr;
    if (!result_) result_ = findChunk(container_, section_, name, chunk);
    if (result_ == LW_NOT_FOUND && container_.view.findSection(section_)) result_ = LW_BAD_SECTION;
    require(!chunk || chunk->elements <= UINT32_MAX, name, "it is too long");
    return chunk && !result_ ? chunk->elements : 0;
  }
  template <class T>
  bool allocate(Array<T>& values, size_t count) {
    if (result_) return false;
    if (values.allocate(container_.host, count)) return true;
    result_ = container_.host.fail(LW_OUT_OF_MEMORY, "%s: no memory for %zu values", section_, count);
    return false;
  }
  static bool areOffsets(const Array<uint32_t>& first, uint64_t end) {
    bool good = !first.empty() && first[0] == 0 && first[first.size() - 1] == end;
    for (size_t i = 0; good && i + 1 < first.size(); ++i) good = first[i + 1] >= first[i];
    return good;
  }
  /// The chunks gate_set_first and gate_set: `sets` sets of entries gate * 2 + closed, of `gates` gates.
  void loadGateSets(uint32_t gates, uint32_t& sets, Array<uint32_t>& set_first, Array<uint16_t>& set) {
    const uint64_t firsts = elementsOf("gate_set_first"), entries = elementsOf("gate_set");
    require(firsts >= 2 && firsts <= 65537, "gate_set_first", "the number of sets cannot be");
    if (!decode("gate_set_first", format::ElementType::u32, firsts, set_first) || !decode("gate_set", format::ElementType::u16, entries, set)) return;
    sets = uint32_t(firsts) - 1;
    require(areOffsets(set_first, entries) && set_first[1] == 0, "gate_set_first", "it does not split the gates, or set 0 is not empty");
    bool good = true;
    for (const uint16_t g : set) good &= g / 2u < gates;
    require(good, "gate_set", "an entry is no gate");
  }

  const lw_container& container_;
  const char* section_;
  lw_result result_ = LW_OK;
};

}  // namespace lightwell::runtime
