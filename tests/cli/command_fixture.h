// Commands that are expected to succeed, and what they write.
#pragma once
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "precompute/core/image.h"
#include "tests/cli/process.h"
#include "tests/cli/schema.h"

namespace lightwell::test {

class CommandTest : public FolderTest {
 protected:
  /// Runs and expects success.
  Finished run(const std::vector<std::string>& arguments) {
    const Finished finished = lightwell(arguments);
    EXPECT_EQ(finished.exit_code, 0) << arguments[0] << ": " << finished.err;
    return finished;
  }
  /// The JSON document on stdout, which must keep to the schema of that name.
  nlohmann::json runJson(const std::vector<std::string>& arguments, const std::string& schema) {
    const auto document = nlohmann::json::parse(run(arguments).out, nullptr, false);
    EXPECT_FALSE(document.is_discarded()) << arguments[0];
    EXPECT_EQ(schemaViolation(readSchema(schema), document), "");
    return document;
  }
  /// Mean of the red channel over covered texels.
  double meanOf(const std::string& exr) {
    const ImageRgba image = readExr(path(exr));
    double sum = 0, count = 0;
    for (const auto& p : image.pixels)
      if (p[3] == 1) sum += p[0], ++count;
    EXPECT_GT(count, 0);
    return sum / count;
  }
};

}  // namespace lightwell::test
