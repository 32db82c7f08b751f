// Who gets in, and where the daemon listens.
#include <httplib.h>

#include <thread>

#include "tests/server/service_fixture.h"

namespace lightwell::test {
namespace {

using nlohmann::json;

/// Runs lightwelld to its end; for command lines that it must refuse.
Finished refusedDaemon(const std::filesystem::path& folder, std::vector<std::string> options) {
  std::string command = std::string("timeout 10 ") + LIGHTWELLD_PROGRAM + " --data " + (folder / "data").string();
  for (const auto& option : options) command += " " + option;
  command += " 2> " + (folder / "err").string();
  const int status = std::system(command.c_str());
  return {WEXITSTATUS(status), "", readFile(folder / "err")};
}

class ServiceSecurity : public ServiceTest {
 protected:
  const std::string token_ = "0123456789abcdefghij";
  std::string tokenFile() {
    writeFile(path("tokens"), "# who may call\nanna " + token_ + "\n");
    std::filesystem::permissions(path("tokens"), std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
    return path("tokens");
  }
  /// An authority, and a certificate of it for localhost and 127.0.0.1.
  void makeCertificates() {
    const std::string in = "cd " + folder_.string() + " && ";
    const std::string quiet = " >/dev/null 2>&1";
    ASSERT_EQ(std::system((in + "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -keyout ca.key -out ca.crt "
                                "-subj /CN=test-ca -days 2" + quiet).c_str()), 0);
    writeFile(path("names"), "subjectAltName=DNS:localhost,IP:127.0.0.1\n");
    for (const char* name : {"server", "client"}) {
      const std::string n = name;
      ASSERT_EQ(std::system((in + "openssl req -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -keyout " + n + ".key -out " + n +
                             ".csr -subj /CN=" + n + quiet + " && openssl x509 -req -in " + n + ".csr -CA ca.crt -CAkey ca.key -CAcreateserial "
                             "-out " + n + ".crt -days 2 -extfile names" + quiet).c_str()), 0);
    }
  }
};

TEST_F(ServiceSecurity, ElsewhereOnlyWithTokensAndTls) {
  for (const std::string listen : {"0.0.0.0:0", "[::]:0", "192.0.2.1:7411"}) {
    const Finished finished = refusedDaemon(folder_, {"--listen", listen});
    EXPECT_EQ(finished.exit_code, 2) << listen;
    EXPECT_NE(finished.err.find("will not listen"), std::string::npos) << finished.err;
  }
  EXPECT_EQ(refusedDaemon(folder_, {"--http", "0.0.0.0:0"}).exit_code, 2);
  EXPECT_EQ(refusedDaemon(folder_, {"--listen", "0.0.0.0:0", "--token-file", tokenFile()}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "data"));
}

TEST_F(ServiceSecurity, TokenFilesThatOthersCanReadAreRefused) {
  std::filesystem::permissions(tokenFile(), std::filesystem::perms::others_read, std::filesystem::perm_options::add);
  const Finished finished = refusedDaemon(folder_, {"--token-file", path("tokens")});
  EXPECT_NE(finished.exit_code, 0);
  EXPECT_NE(finished.err.find("chmod"), std::string::npos);
}

TEST_F(ServiceSecurity, OneDaemonPerFolderAndPort) {
  startDaemon();
  EXPECT_EQ(refusedDaemon(folder_, {"--listen", "127.0.0.1:" + std::to_string(freePort())}).exit_code, 2) << "the folder";
  std::filesystem::create_directory(folder_ / "other");
  EXPECT_EQ(refusedDaemon(folder_ / "other", {"--listen", daemon_->address()}).exit_code, 2) << "the port";
}

TEST_F(ServiceSecurity, TokensAreNeeded) {
  startDaemon({"--token-file", tokenFile()});
  EXPECT_EQ(client({"jobs"}).exit_code, 5);
  writeFile(path("wrong"), "0123456789abcdefghiX");
  EXPECT_EQ(client({"jobs", "--token-file", path("wrong")}).exit_code, 5);
  EXPECT_EQ(client({"jobs", "--token-file", path("tokens")}).exit_code, 0) << "the server's own file serves a client too";
  httplib::Client http("127.0.0.1", daemon_->httpPort());
  EXPECT_EQ(http.Get("/healthz")->status, 200);
  for (const char* page : {"/", "/jobs.json", "/metrics"}) EXPECT_EQ(http.Get(page)->status, 401) << page;
  http.set_bearer_token_auth(token_.c_str());
  for (const char* page : {"/", "/jobs.json", "/metrics"}) EXPECT_EQ(http.Get(page)->status, 200) << page;
  httplib::Client browser("127.0.0.1", daemon_->httpPort());
  browser.set_basic_auth("anybody", token_.c_str());
  EXPECT_EQ(browser.Get("/")->status, 200);
}

TEST_F(ServiceSecurity, TlsWithClientCertificates) {
  makeCertificates();
  startDaemon({"--token-file", tokenFile(), "--tls-certificate", path("server.crt"), "--tls-key", path("server.key"), "--tls-client-ca",
               path("ca.crt")});
  const std::vector<std::string> plain{"jobs", "--token-file", path("tokens")};
  EXPECT_EQ(client(plain).exit_code, 5) << "without TLS";
  auto tls = plain;
  tls.insert(tls.end(), {"--tls-ca", path("ca.crt")});
  EXPECT_EQ(client(tls).exit_code, 5) << "without a certificate";
  tls.insert(tls.end(), {"--tls-certificate", path("client.crt"), "--tls-key", path("client.key")});
  EXPECT_EQ(client(tls).exit_code, 0) << client(tls).err;
}

TEST_F(ServiceSecurity, AForeignNameOfThisMachineGetsNothing) {
  startDaemon();
  httplib::Client http("127.0.0.1", daemon_->httpPort());
  EXPECT_EQ(http.Get("/jobs.json")->status, 200);
  EXPECT_EQ(http.Get("/jobs.json", {{"Host", "evil.example.org"}})->status, 401) << "DNS rebinding";
}

TEST_F(ServiceSecurity, ATokenIsNotSentInTheClear) {
  const Finished finished = lightwell({"jobs", "--server", "bake.example.org:7411", "--token-file", tokenFile()});
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("without TLS"), std::string::npos);
}

}  // namespace
}  // namespace lightwell::test
