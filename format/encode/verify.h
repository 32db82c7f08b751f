// Every checksum and every invariant of a container.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "format/decode/view.h"

namespace lightwell::format {

/// What is wrong, numbered in groups; numbers are stable and never reused (docs/format.md lists them).
enum class IssueId : int {
  // 1000: the file as a whole: header, directory, limits. Nothing else can be checked then
  unreadable = 1001,
  // 2000: one chunk
  chunk_damaged = 2001,     // checksum, padding or coding
  chunk_missing = 2002,
  chunk_element = 2003,     // another element type than the section's table says
  chunk_shape = 2004,       // another shape than the header or the other chunks imply
  chunk_unknown = 2005,     // coded in a way of a later version: cannot be checked (a note)
  // 3000: values
  message_invalid = 3001,   // not a message of the right type
  header_value = 3002,      // a header field out of range
  not_finite = 3003,
  index_range = 3004,
  order = 3005,             // offsets not monotone, links not ascending, texels not unique
  weight_sum = 3006,
  reserved_bits = 3007,
  value_range = 3008,
  // 4000: sections together
  section_missing = 4001,   // a section that another needs
  cross_section = 4002,     // two sections contradict each other
  section_unknown = 4003,   // of a later version: its values are not checked (a note)
};

struct Issue {
  IssueId id{};
  Status status{};      // what a reader would report
  bool note = false;    // true: the file is sound, but something could not be checked
  uint64_t offset = 0;  // of the chunk or the header field in the file
  std::string place;    // "prm/link_cluster", "header", "directory"
  std::string message;
};

/// All issues in the order of the file, then all notes; at most 100. Empty for a sound file. Throws only std::bad_alloc and, when the
/// file cannot be opened, std::system_error.
std::vector<Issue> verify(const std::filesystem::path& file, const Limits& limits = {});
/// The same for a source; see OpenOptions for the limits.
std::vector<Issue> verify(const Source& source, const Limits& limits = {});
/// True when no issue is more than a note.
bool isSound(const std::vector<Issue>& issues);

}  // namespace lightwell::format
