#include "format/encode/verify.h"

#include <google/protobuf/message.h>
#include <google/protobuf/stubs/logging.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <system_error>

#include "format/encode/strict_message.h"
#include "format/encode/verify_context.h"

namespace lightwell::format {
namespace {

std::string placeOf(std::string_view section, std::string_view name) {
  std::string place(section);
  if (!name.empty()) place.append("/").append(name);
  return place;
}

std::string shapeText(std::span<const uint64_t> shape) {
  std::string text = "[";
  for (const uint64_t extent : shape)
    text.append(text.size() > 1 ? "," : "").append(extent == kAnyExtent ? "any" : std::to_string(extent));
  return text.append("]");
}

}  // namespace

void VerifyContext::add(IssueId id, Status status, bool is_note, uint64_t offset, std::string place, std::string message) {
  issues_.push_back({id, status, is_note, offset, std::move(place), std::move(message)});
}

void VerifyContext::report(IssueId id, std::string_view section, std::string_view name, std::string message) {
  const ChunkInfo* chunk = find(section, name);
  add(id, Status::bad_section, false, chunk ? chunk->offset : kHeaderBytes, placeOf(section, name), std::move(message));
}

void VerifyContext::note(IssueId id, std::string_view section, std::string_view name, std::string message) {
  const ChunkInfo* chunk = find(section, name);
  add(id, Status::too_new, true, chunk ? chunk->offset : kHeaderBytes, placeOf(section, name), std::move(message));
}

bool VerifyContext::has(std::string_view section) const {
  const SectionInfo* info = view_.findSection(section);
  return info && info->known;
}

const ChunkInfo* VerifyContext::expect(std::string_view section, std::string_view name, ElementType element,
                                       std::span<const uint64_t> shape) {
  const ChunkInfo* chunk = find(section, name);
  if (!chunk) {
    report(IssueId::chunk_missing, section, name, "missing");
    return nullptr;
  }
  listed_.insert(chunk);
  if (chunk->element != element) {
    report(IssueId::chunk_element, section, name, "has another element type than the section's table gives");
    return nullptr;
  }
  const std::span<const uint64_t> actual(chunk->shape, chunk->rank);
  const bool fits = std::equal(actual.begin(), actual.end(), shape.begin(), shape.end(),
                               [](uint64_t is, uint64_t wanted) { return wanted == kAnyExtent || is == wanted; });
  if (!fits) {
    report(IssueId::chunk_shape, section, name, "has shape " + shapeText(actual) + " instead of " + shapeText(shape));
    return nullptr;
  }
  return chunk;
}

bool VerifyContext::decode(const ChunkInfo& chunk, void* destination) {
  const Fault fault = view_.decode(chunk, destination, chunk.raw_bytes);
  if (fault && decoded_.insert(&chunk).second)
    add(IssueId::chunk_damaged, fault.status, false, fault.offset, placeOf(chunk.section, chunk.name), fault.what);
  decoded_.insert(&chunk);
  return !fault;
}

bool VerifyContext::loadMessage(std::string_view section, std::string_view name, google::protobuf::Message& message) {
  const auto bytes = load<uint8_t>(section, name, ElementType::bytes, {kAnyExtent});
  if (!bytes) return false;
  const google::protobuf::LogSilencer silencer;  // the issue says it
  if (parseStrictly({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, message)) return true;
  report(IssueId::message_invalid, section, name, "not a valid " + message.GetTypeName());
  return false;
}

bool VerifyContext::checkFinite(const std::vector<float>& values, std::string_view section, std::string_view name) {
  return checkEach(values, IssueId::not_finite, section, name, "are not finite", [](float v) { return !std::isfinite(v); });
}

bool VerifyContext::checkOffsets(const std::vector<uint32_t>& offsets, uint64_t end, bool strictly, std::string_view section,
                                 std::string_view name) {
  if (offsets.empty() || offsets.front() != 0 || offsets.back() != end) {
    report(IssueId::order, section, name, "does not run from 0 to " + std::to_string(end));
    return false;
  }
  for (size_t i = 1; i < offsets.size(); ++i)
    if (offsets[i] < offsets[i - 1] || (strictly && offsets[i] == offsets[i - 1])) {
      report(IssueId::order, section, name, std::string(strictly ? "does not rise" : "falls") + " at index " + std::to_string(i));
      return false;
    }
  return true;
}

void VerifyContext::checkRemaining() {
  for (const SectionInfo& section : view_.sections())
    if (!section.known) note(IssueId::section_unknown, section.type, "", "of a later version: its values are not checked");
  // A section that failed its checks was left halfway: what was not reached there is no news.
  std::set<std::string, std::less<>> failed;
  for (const Issue& issue : issues_)
    if (!issue.note) failed.insert(issue.place.substr(0, issue.place.find('/')));
  std::vector<uint8_t> scratch;
  for (const ChunkInfo& chunk : view_.chunks()) {
    if (!decoded_.contains(&chunk)) {
      if (chunk.decodable) {
        scratch.resize(chunk.raw_bytes);
        decode(chunk, scratch.data());
      } else if (const Fault fault = view_.checkStored(chunk)) {
        add(IssueId::chunk_damaged, fault.status, false, fault.offset, placeOf(chunk.section, chunk.name), fault.what);
      } else {
        note(IssueId::chunk_unknown, chunk.section, chunk.name, "coded in a way of a later version: only its checksum is checked");
      }
    }
    if (chunk.decodable && !listed_.contains(&chunk) && view_.sections()[chunk.section_index].known && !failed.contains(chunk.section))
      note(IssueId::chunk_unknown, chunk.section, chunk.name, "not a chunk of this version: its values are not checked");
  }
}

std::vector<Issue> verify(const Source& source, const Limits& limits) {
  View view;
  if (const Fault fault = view.open(source, {.limits = limits}))
    return {{IssueId::unreadable, fault.status, false, fault.offset, fault.offset < kHeaderBytes ? "header" : "directory", fault.what}};

  VerifyContext context(view);
  using Check = void (*)(VerifyContext&);
  constexpr std::pair<const char*, Check> checks[] = {
      {"meta", verifyMeta}, {"scene", verifyScene}, {"geometry", verifyGeometry}, {"atlas", verifyAtlas}, {"prm", verifyPrm}, {"prm_probes", verifyPrmProbes},
      {"environment", verifyEnvironment}, {"radiosity", verifyRadiosity}, {"probes", verifyProbes},
      {"lightmap", verifyLightmap}, {"vpl", verifyVpl}, {"points", verifyPoints}};
  for (const auto& [type, check] : checks)
    if (context.has(type)) check(context);
  context.checkRemaining();

  std::vector<Issue> issues = std::move(context.issues());
  std::stable_sort(issues.begin(), issues.end(), [](const Issue& a, const Issue& b) { return a.offset < b.offset; });
  // Never drop an error for the sake of a note.
  std::stable_partition(issues.begin(), issues.end(), [](const Issue& issue) { return !issue.note; });
  if (issues.size() > VerifyContext::kMaxIssues) issues.resize(VerifyContext::kMaxIssues);
  return issues;
}

std::vector<Issue> verify(const std::filesystem::path& file, const Limits& limits) {
  FileSource source;
  if (!source.open(file.c_str())) throw std::system_error(errno, std::generic_category(), file.string());
  return verify(source.source(), limits);
}

bool isSound(const std::vector<Issue>& issues) {
  return std::all_of(issues.begin(), issues.end(), [](const Issue& issue) { return issue.note; });
}

}  // namespace lightwell::format
