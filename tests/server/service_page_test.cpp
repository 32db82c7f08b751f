// The HTTP port: the page in a real browser, pictures, downloads, metrics.
#include <httplib.h>

#include <cstdio>

#include "tests/cli/schema.h"
#include "tests/server/service_fixture.h"

namespace lightwell::test {
namespace {

using nlohmann::json;

class ServicePage : public ServiceTest {};

/// What a shell command prints.
std::string outputOf(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  char buffer[4096];
  while (const size_t got = fread(buffer, 1, sizeof buffer, pipe)) text.append(buffer, got);
  pclose(pipe);
  return text;
}

TEST_F(ServicePage, DownloadsPicturesAndMetrics) {
  startDaemon();
  const std::string room = scene("room.gltf"), job = submit(room);
  ASSERT_EQ(watch(job)["state"], "succeeded");
  httplib::Client http("127.0.0.1", daemon_->httpPort());
  const auto list = json::parse(http.Get("/jobs.json")->body);
  ASSERT_EQ(list["jobs"].size(), 1u);
  EXPECT_EQ(schemaViolation(readSchema("job"), list["jobs"][0]), "");
  EXPECT_EQ(list["counts"]["succeeded"], 1);
  EXPECT_EQ(digest(http.Get("/jobs/" + job + "/result.lwc")->body), bake(room));
  EXPECT_EQ(http.Get("/jobs/" + job + "/preview.png")->body.substr(1, 3), "PNG");
  EXPECT_EQ(http.Get("/jobs/0123456789abcdef.json")->status, 404);
  EXPECT_EQ(http.Get("/jobs/../../etc/passwd")->status, 404);
  EXPECT_EQ(http.Post("/jobs.json", "{}", "application/json")->status, 404);
  const std::string metrics = http.Get("/metrics")->body;
  EXPECT_NE(metrics.find("lightwelld_jobs{state=\"succeeded\"} 1"), std::string::npos) << metrics;
  EXPECT_NE(metrics.find("lightwelld_submit_seconds_count 1"), std::string::npos);
  EXPECT_EQ(metrics.find("lightwelld_tasks_run_total 0\n"), std::string::npos) << metrics;
}

TEST_F(ServicePage, InABrowser) {
  if (std::system("command -v chromium >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "chromium is not installed: the status page was not tested in a browser (apt-get install chromium)";
  startDaemon({}, true);
  const std::string done = submit(scene("room.gltf"), {"--label", "<b>a room & more</b>"}), crashed = submit(scene("crash.gltf"));
  watch(done), watch(crashed);
  const std::string running = submit(scene("hang.gltf"));
  while (daemon_->workers().empty()) usleep(10000);
  const std::string browser = "timeout 60 chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --user-data-dir=" +
                              path("profile") + " --virtual-time-budget=4000 ";
  const std::string url = " http://127.0.0.1:" + std::to_string(daemon_->httpPort()) + "/ 2>/dev/null";
  const std::string page = outputOf(browser + "--dump-dom" + url);
  EXPECT_NE(page.find("id=\"job-" + done), std::string::npos) << page;
  EXPECT_NE(page.find("&lt;b&gt;a room &amp; more&lt;/b&gt;"), std::string::npos) << "what clients write is text, not markup";
  EXPECT_NE(page.find("class=\"state succeeded\""), std::string::npos);
  EXPECT_NE(page.find("jobs/" + done + "/preview.png"), std::string::npos);
  EXPECT_NE(page.find("jobs/" + done + "/result.lwc"), std::string::npos);
  EXPECT_NE(page.find("worker_crashed"), std::string::npos);
  EXPECT_NE(page.find("about to crash on purpose"), std::string::npos);
  EXPECT_NE(page.find("<progress"), std::string::npos);
  EXPECT_NE(page.find("1 failed, 1 running, 1 succeeded"), std::string::npos) << page;
}

}  // namespace
}  // namespace lightwell::test
