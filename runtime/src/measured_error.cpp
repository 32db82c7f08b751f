// The measured errors of section meta.
#include "lightwell/lightwell_error.h"

#include <cmath>
#include <cstring>

#include "format/decode/wire.h"
#include "runtime/src/container.h"

namespace lightwell::runtime {
namespace {

/// Calls `visit(index, error)` for each error of `section` (null: of all) until it says false; what an error refers to lasts as long as the call.
template <class Visit>
lw_result readErrors(const lw_container& container, const char* section, Visit visit) {
  if (!container.view.findChunk("meta", "header")) return LW_OK;
  return readHeader(container, "meta", [&](const Array<uint8_t>& message) {
    format::WireReader meta(message.data(), message.size());
    uint32_t index = 0;
    while (meta.next()) {
      if (meta.field() != 3) continue;
      const std::string_view bytes = meta.bytes();
      format::MeasuredError error;
      if (!format::parseMeasuredError(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), error)) return false;
      if ((!section || error.section == section) && !visit(index++, error)) return true;
    }
    return meta.ok();
  });
}

/// Cut between characters.
void copyText(std::string_view text, char* to, size_t capacity) {
  size_t size = text.size() < capacity ? text.size() : capacity - 1;
  if (size < text.size())
    while (size > 0 && (uint8_t(text[size]) & 0xc0) == 0x80) --size;
  if (size > 0) std::memcpy(to, text.data(), size);  // empty text may be null
  to[size] = 0;
}

lw_estimate estimate(const format::MeasuredError::Estimate& e) { return {e.value, e.low, e.high}; }

bool isSound(const format::MeasuredError& error) {
  for (const auto* e : {&error.relrmse, &error.texrel, &error.bias, &error.maximum})
    if (!std::isfinite(e->value) || !std::isfinite(e->high) || !(e->low <= e->high) || !std::isfinite(e->low)) return false;
  return error.relrmse.value >= 0 && error.texrel.value >= 0 && error.maximum.value >= 0 && std::isfinite(error.seconds) && error.seconds >= 0;
}

/// Writes errors [first, first + count) of `section`.
lw_result copyErrors(const lw_container& container, const char* section, uint32_t first, uint32_t count, lw_measured_error* out) {
  uint32_t found = 0, unsound = kNone;
  const lw_result result = readErrors(container, section, [&](uint32_t index, const format::MeasuredError& error) {
    if (index < first) return true;
    if (found == count) return false;
    if (!isSound(error)) {
      unsound = index;
      return false;
    }
    lw_measured_error& to = out[found++];
    copyText(error.section, to.section, sizeof to.section);
    copyText(error.against, to.against, sizeof to.against);
    to.relrmse = estimate(error.relrmse), to.texrel = estimate(error.texrel), to.bias = estimate(error.bias), to.maximum = estimate(error.maximum);
    to.seconds = error.seconds;
    to.texels = error.texels;
    return true;
  });
  if (result) return result;
  if (unsound != kNone) return container.host.fail(LW_BAD_SECTION, "meta/header: measured error %u is out of range", unsound);
  if (found < count)
    return container.host.fail(LW_NOT_FOUND, "there is no measured error %u%s%s", first + found, section ? " of section " : "", section ? section : "");
  return LW_OK;
}

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_count_measured_errors(const lw_container* container, const char* section, uint32_t* count) {
  if (!container || !count) return LW_INVALID_ARGUMENT;
  uint32_t found = 0;
  const lw_result result = readErrors(*container, section, [&](uint32_t, const lightwell::format::MeasuredError&) {
    ++found;
    return true;
  });
  if (!result) *count = found;
  return result;
}

lw_result lw_get_measured_error(const lw_container* container, const char* section, uint32_t index, lw_measured_error* error) {
  if (!container || !error) return LW_INVALID_ARGUMENT;
  return copyErrors(*container, section, index, 1, error);
}

lw_result lw_get_measured_errors(const lw_container* container, const char* section, uint32_t count, lw_measured_error* errors) {
  if (!container || (count && !errors)) return LW_INVALID_ARGUMENT;
  return copyErrors(*container, section, 0, count, errors);
}
