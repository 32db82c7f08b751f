// Sets of gates that light has to do with on its way from one patch to another.
//
// A gate is a strip of a portal, numbered through all portals of the scene in order. Light counts for a set when each of its gates is as the set has it.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace lightwell::transport {

/// gate * 2 + closed.
using GateEntry = uint16_t;
inline constexpr GateEntry kNoEntry = 0xffff;
inline constexpr uint32_t kMostGates = 32767;
constexpr GateEntry openGate(uint32_t gate) { return GateEntry(gate * 2); }
constexpr GateEntry closedGate(uint32_t gate) { return GateEntry(gate * 2 + 1); }
constexpr bool isClosed(GateEntry entry) { return entry & 1; }

/// What a set's gates have in common: with all portals shut `always` and `closed` count, with all open `always` and `open`.
enum class GateClass : uint8_t { always, closed, open, mixed };
inline constexpr size_t kGateClasses = 4;

/// Distinct sets, numbered. Set 0 is the empty one.
class GateSets {
 public:
  GateSets() : number_{{{}, 0}} {}

  /// The number of a set. `entries` in any order, without repetitions, at most one for each gate.
  uint32_t number(std::span<const GateEntry> entries);
  std::span<const GateEntry> operator[](uint32_t set) const {
    return std::span<const GateEntry>(entry_).subspan(first_[set], first_[set + 1] - first_[set]);
  }
  uint32_t count() const { return uint32_t(first_.size()) - 1; }
  GateClass classOf(uint32_t set) const;

  /// As arrays: the entries of set i are entry[first[i] … first[i + 1]), ascending.
  const std::vector<uint32_t>& first() const { return first_; }
  const std::vector<GateEntry>& entries() const { return entry_; }
  /// The inverse; false when the arrays are no such sets.
  bool assign(const std::vector<uint32_t>& first, const std::vector<GateEntry>& entries);

 private:
  std::vector<uint32_t> first_ = {0, 0};
  std::vector<GateEntry> entry_;
  std::map<std::vector<GateEntry>, uint32_t> number_;
};

/// Adds the sets of `from` to `sets`; the number that each has there.
std::vector<uint32_t> addSets(const GateSets& from, GateSets& sets);

/// Those sets that `used` (numbers) names, and the empty one, in ascending order, so that numbers do not depend on the order in which sets were found; changes the numbers.
GateSets sortSets(const GateSets& sets, std::vector<uint32_t>& used);

}  // namespace lightwell::transport
