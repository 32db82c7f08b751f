#include "server/rpc/requests.h"

#include <gtest/gtest.h>

#include "server/failure.h"

namespace lightwell::server {
namespace {

v1::JobSpec spec() {
  v1::JobSpec spec;
  for (const char* name : {"b.bin", "a.gltf"}) {
    auto& file = *spec.add_files();
    file.set_name(name);
    file.set_sha256(std::string(64, name[0]));
    file.set_size(1);
  }
  spec.set_scene("a.gltf");
  return spec;
}

std::string keyOf(v1::JobSpec spec, const std::string& version = "1") {
  checkSpec(spec);
  return requestKey(spec, version);
}

TEST(Requests, TheKeyKnowsWhatTheBytesDependOnAndNothingElse) {
  const std::string key = keyOf(spec());
  v1::JobSpec same = spec();
  same.mutable_files()->SwapElements(0, 1);
  same.set_settings_json("{\"seed\": 1}");
  same.set_priority(3), same.set_threads(7), same.set_label("x");
  same.mutable_limits()->set_wall_s(5);
  EXPECT_EQ(keyOf(same), key) << "order, defaults, priority, threads, label, limits";
  EXPECT_NE(keyOf(spec(), "2"), key);
  const auto differs = [&](auto change) {
    v1::JobSpec other = spec();
    change(other);
    EXPECT_NE(keyOf(other), key) << other.ShortDebugString();
  };
  differs([](v1::JobSpec& s) { s.set_settings_json("{\"seed\": 2}"); });
  differs([](v1::JobSpec& s) { s.mutable_files(0)->set_sha256(std::string(64, 'c')); });
  differs([](v1::JobSpec& s) { s.mutable_files(0)->set_name("c.bin"); });
  differs([](v1::JobSpec& s) { s.set_lights("b.bin"); });
  differs([](v1::JobSpec& s) { s.set_time_limit_s(1); });
  differs([](v1::JobSpec& s) { s.set_target_error(0.1); });
  differs([](v1::JobSpec& s) { s.set_size_limit_bytes(1); });
}

}  // namespace
}  // namespace lightwell::server
