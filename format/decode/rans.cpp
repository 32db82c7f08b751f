#include "format/decode/rans.h"

#include "format/decode/endian.h"

namespace lightwell::format::rans {
namespace {

/// One part's state. Small, so that four of them stay in registers.
struct Lane {
  uint32_t state, sum;  // sum: of the sizes in the window
  uint32_t seen;        // contexts, a bit each
  const uint8_t *next, *end;
  uint8_t* out;
};

/// The byte number `i` of the lane's part; `full`: there are bytes that leave the window. False where the stream ends early.
template <bool full>
inline bool step(Lane& lane, const uint32_t* slots, size_t i) {
  const uint32_t context = contextOf(lane.sum);
  lane.seen |= 1u << context;
  const uint32_t slot = slots[context * kScale + (lane.state & (kScale - 1))];
  lane.state = ((slot >> 8 & (kScale - 1)) + 1) * (lane.state >> kScaleBits) + (slot >> 20);
  const uint8_t symbol = uint8_t(slot);
  lane.sum += sizeOf(symbol);
  if (full) lane.sum -= sizeOf(lane.out[i - kWindow]);
  lane.out[i] = symbol;
  if (lane.state < kLeastState) {
    if (lane.next == lane.end) return false;
    lane.state = lane.state << 16 | loadLittle<uint16_t>(lane.next);
    lane.next += 2;
  }
  return true;
}

template <bool full>
bool steps(Lane (&lanes)[kParts], const uint32_t* slots, size_t begin, size_t end) {
  Lane a = lanes[0], b = lanes[1], c = lanes[2], d = lanes[3];
  bool good = true;
  for (size_t i = begin; i < end && good; ++i) {
    good = step<full>(a, slots, i);
    good &= step<full>(b, slots, i);
    good &= step<full>(c, slots, i);
    good &= step<full>(d, slots, i);
  }
  lanes[0] = a, lanes[1] = b, lanes[2] = c, lanes[3] = d;
  return good;
}

}  // namespace

bool makeSlots(const uint8_t* planes, uint32_t* slots, uint32_t& used) {
  used = 0;
  for (size_t context = 0; context < kContexts; ++context) {
    uint32_t total = 0;
    for (size_t symbol = 0; symbol < kSymbols; ++symbol) {
      const size_t at = context * kSymbols + symbol;
      const uint32_t frequency = uint32_t(planes[at]) | uint32_t(planes[kTableBytes / 2 + at]) << 8;
      if (frequency > kScale - total) return false;
      for (uint32_t i = 0; i < frequency; ++i) slots[context * kScale + total + i] = uint32_t(symbol) | (frequency - 1) << 8 | i << 20;
      total += frequency;
    }
    used |= uint32_t(total == kScale) << context;
    if (total != 0 && total != kScale) return false;
    for (uint32_t i = total; i < kScale; ++i) slots[context * kScale + i] = 0;  // read before what is seen tells
  }
  return true;
}

bool decode(const uint8_t* stored, size_t stored_bytes, const uint32_t* slots, uint32_t used, uint8_t* out, size_t count) {
  if (stored_bytes < kParts * 4) return false;
  Lane lanes[kParts] = {};
  size_t at = kParts * 4;
  for (size_t part = 0; part < kParts; ++part) {
    const size_t bytes = loadLittle<uint32_t>(stored + part * 4);
    if (bytes < 4 || bytes % 2 || bytes > stored_bytes - at) return false;
    lanes[part].state = loadLittle<uint32_t>(stored + at);
    lanes[part].next = stored + at + 4;
    lanes[part].end = stored + (at += bytes);
    lanes[part].out = out + partBegin(count, part);
    if (lanes[part].state < kLeastState) return false;
  }
  if (at != stored_bytes) return false;
  const size_t common = count - partBegin(count, kParts - 1);  // what the shortest, the last part has
  const size_t first = common < kWindow ? common : kWindow;
  bool good = steps<false>(lanes, slots, 0, first) && steps<true>(lanes, slots, first, common);
  for (size_t part = 0; part < kParts; ++part) {
    const size_t bytes = partBegin(count, part + 1) - partBegin(count, part);
    for (size_t i = common; i < bytes && good; ++i) good = i < kWindow ? step<false>(lanes[part], slots, i) : step<true>(lanes[part], slots, i);
    good = good && lanes[part].state == kLeastState && lanes[part].next == lanes[part].end && (lanes[part].seen & ~used) == 0;
  }
  return good;
}

}  // namespace lightwell::format::rans
