// Sound containers with one invariant of a section broken, and what verify says of them.
#pragma once
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "format/encode/verify.h"
#include "tests/format/listed.h"

namespace lightwell::format {

template <class Content>
struct BreachOf {
  const char* name;
  IssueId id;
  const char* place;
  std::function<void(Content&)> spoil;
};

template <class Content>
std::vector<Issue> issuesOf(const Content& content) {
  const std::vector<uint8_t> file = toWriter(content).bytes();
  return verify(memorySource(file.data(), file.size()));
}

/// verify names the chunk and the issue, and nothing else is wrong with the file.
template <class Content>
void expectNamed(const BreachOf<Content>& breach, Content content) {
  breach.spoil(content);
  const auto issues = issuesOf(content);
  ASSERT_EQ(issues.size(), 1u) << listed(issues);
  EXPECT_EQ(issues[0].id, breach.id) << listed(issues);
  EXPECT_EQ(issues[0].place, breach.place) << listed(issues);
  EXPECT_EQ(issues[0].status, Status::bad_section);
}

}  // namespace lightwell::format
