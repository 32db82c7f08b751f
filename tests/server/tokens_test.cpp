#include "server/tokens.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <fstream>

#include "tests/support/temporary_folder.h"

namespace lightwell::server {
namespace {
namespace fs = std::filesystem;

class TokensTest : public testing::Test {
 protected:
  fs::path file(const std::string& content) {
    std::ofstream(folder_ / "tokens") << content;
    fs::permissions(folder_ / "tokens", fs::perms::owner_read | fs::perms::owner_write);
    return folder_ / "tokens";
  }
  test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(TokensTest, NamesAndTokens) {
  const Tokens tokens(file("# comment\nanna 0123456789abcdef\n\n  fedcba9876543210  # without a name\n"));
  EXPECT_EQ(tokens.authorize("Bearer 0123456789abcdef"), "anna");
  EXPECT_EQ(tokens.authorize("Bearer fedcba9876543210"), "client4");
  EXPECT_EQ(tokens.authorize("Basic YW55OjAxMjM0NTY3ODlhYmNkZWY="), "anna");
  for (const char* header : {"", "Bearer", "Bearer ", "bearer 0123456789abcdef", "Bearer 0123456789abcdeg", "Basic !!!", "Basic", "Bearer anna"})
    EXPECT_EQ(tokens.authorize(header), std::nullopt) << header;
  EXPECT_EQ(Tokens().authorize(""), "local");
}

TEST_F(TokensTest, BadFiles) {
  for (const char* content : {"", "# nothing\n", "short\n", "a b c\n", "anna short\n"}) EXPECT_THROW(Tokens(file(content)), std::runtime_error) << content;
  EXPECT_THROW(Tokens(folder_ / "absent"), std::runtime_error);
  fs::permissions(file("anna 0123456789abcdef\n"), fs::perms::group_write, fs::perm_options::add);
  EXPECT_THROW(Tokens(folder_ / "tokens"), std::runtime_error);
}

}  // namespace
}  // namespace lightwell::server
