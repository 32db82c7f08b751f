// The measured errors of section meta.
#include "lightwell/lightwell_error.h"

#include <cmath>
#include <cstring>

#include "runtime/src/container.h"

namespace lightwell::runtime {
namespace {

/// `message` holds what `error` refers to.
lw_result load(const lw_container& container, const char* section, uint32_t index, Array<uint8_t>& message, format::MeasuredError& error, uint32_t& count) {
  count = 0;
  if (!container.view.findChunk("meta", "header")) return LW_OK;
  const format::ChunkInfo* chunk = nullptr;
  if (const lw_result result = findChunk(container, "meta", "header", format::ElementType::bytes, chunk)) return result;
  if (const lw_result result = decodeChunk(container, *chunk, message)) return result;
  return format::parseMetaErrors(message.data(), message.size(), section ? section : "", index, error, count) ? LW_OK
                                                                                                               : badSection(container, *chunk, "it is not a valid message");
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

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_count_measured_errors(const lw_container* container, const char* section, uint32_t* count) {
  if (!container || !count) return LW_INVALID_ARGUMENT;
  Array<uint8_t> message;
  lightwell::format::MeasuredError any;
  uint32_t found = 0;
  const lw_result result = load(*container, section, 0, message, any, found);
  if (!result) *count = found;
  return result;
}

lw_result lw_get_measured_error(const lw_container* container, const char* section, uint32_t index, lw_measured_error* out) {
  if (!container || !out) return LW_INVALID_ARGUMENT;
  Array<uint8_t> message;
  lightwell::format::MeasuredError error;
  uint32_t count = 0;
  if (const lw_result result = load(*container, section, index, message, error, count)) return result;
  if (index >= count) return container->host.fail(LW_NOT_FOUND, "there is no measured error %u%s%s", index, section ? " of section " : "", section ? section : "");
  if (!isSound(error)) return container->host.fail(LW_BAD_SECTION, "meta/header: measured error %u is out of range", index);
  copyText(error.section, out->section, sizeof out->section);
  copyText(error.against, out->against, sizeof out->against);
  out->relrmse = estimate(error.relrmse), out->texrel = estimate(error.texrel), out->bias = estimate(error.bias), out->maximum = estimate(error.maximum);
  out->seconds = error.seconds;
  out->texels = error.texels;
  return LW_OK;
}
