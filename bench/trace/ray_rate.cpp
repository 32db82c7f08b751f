// Rays per second of the tracer and of the gathering that a PRM bake consists of, against raw Embree on the same rays in the same process.
//   ray_rate SCENE.glb [--threads 1 --threads 2] [--json]
// Times are CPU seconds of the tracing threads, so that what else the machine does hardly matters; every round runs all contestants in
// turn.
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "precompute/bake/context.h"
#include "precompute/core/random.h"
#include "precompute/trace/raw_embree.h"
#include "precompute/transport/prm/gather.h"

using namespace lightwell;
using nlohmann::json;
using trace::RawEmbree, trace::rawRay;

namespace {

struct Options {
  std::filesystem::path scene;
  std::vector<int> threads{1, 2};
  int lightmap_size = 256, rounds = 5;
  uint32_t texels = 512, rays = 512;
  bool json = false;
};

double threadSeconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// CPU seconds per thread that `body(begin, end)` takes over [0, count), a contiguous share for each thread.
double secondsPerThread(int threads, size_t count, const std::function<void(size_t, size_t)>& body) {
  std::vector<double> seconds(threads);
  std::vector<std::thread> pool;
  for (int t = 0; t < threads; ++t)
    pool.emplace_back([&, t] {
      const double begin = threadSeconds();
      body(count * t / threads, count * (t + 1) / threads);
      seconds[t] = threadSeconds() - begin;
    });
  for (auto& thread : pool) thread.join();
  double sum = 0;
  for (const double s : seconds) sum += s;
  return sum / threads;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// A way to trace all rays once, and what it took in each round.
struct Contestant {
  std::string name;
  std::function<double(int threads)> seconds_per_thread;
  std::vector<double> seconds;
};

json measure(const Options& options, int threads, size_t rays, std::vector<Contestant> contestants) {
  for (int round = 0; round <= options.rounds; ++round)
    for (auto& c : contestants) {
      const double seconds = c.seconds_per_thread(threads);
      if (round > 0) c.seconds.push_back(seconds);  // the first round warms the caches
    }
  const auto fastest = [&](std::string_view prefix) {
    double seconds = std::numeric_limits<double>::infinity();
    for (const auto& c : contestants)
      if (c.name.starts_with(prefix)) seconds = std::min(seconds, median(c.seconds));
    return seconds;
  };
  const double raw = fastest("Embree"), raw_robust = fastest("Embree robust");
  json rows = json::array();
  for (const auto& c : contestants) {
    const double seconds = median(c.seconds);
    rows.push_back({{"what", c.name},
                    {"threads", threads},
                    {"rays", rays},
                    {"mrays_per_cpu_second", 1e-6 * double(rays) / seconds / threads},
                    {"ratio_to_raw", raw / seconds},
                    {"ratio_to_raw_robust", raw_robust / seconds}});
  }
  return rows;
}

void run(const Options& options) {
  Diagnostics diagnostics;
  const CancelFlag cancel;
  plan::Settings settings;
  settings.lightmap_size = options.lightmap_size;
  const bake::BakeContext context({options.scene, {}}, settings, 0, diagnostics, cancel,
                                  [](const std::string& stage) { std::fprintf(stderr, "%s\n", stage.c_str()); });
  if (!context.tracer()) throw std::runtime_error(options.scene.string() + " has no surfaces");
  const trace::Tracer& tracer = *context.tracer();
  const atlas::Atlas& atlas = context.atlas();
  const scene::Mesh& mesh = context.scene().mesh;
  const auto sides = transport::surfaceSides(atlas);
  const auto clusters = transport::makeEntries(context.scene(), atlas, tracer, {}, {}, settings.seed);
  const transport::Gatherer gatherer(context.scene(), atlas, tracer, sides, clusters, settings.seed);

  std::vector<uint32_t> slots;
  for (uint32_t i = 0; i < options.texels; ++i) slots.push_back(uint32_t(mixBits(combineKeys(settings.seed, i)) % atlas.slots.size()));
  const transport::HemisphereBundle bundle = gatherer.bundle(options.rays, 0);
  std::vector<trace::Ray> rays;
  for (const uint32_t slot : slots)
    for (const auto& ray : gatherer.rays(slot, bundle)) rays.push_back(ray);
  std::vector<trace::Hit> hits(rays.size());
  tracer.closest(rays, hits);
  // Shadow rays: the first half of the way to the hits and beyond them, so that half of them are blocked.
  std::vector<trace::Ray> shadow_rays = rays;
  for (size_t i = 0; i < rays.size(); ++i) shadow_rays[i].t_max = hits[i].triangle == kNone ? 1e3f : hits[i].t * (i % 2 ? 1.5f : 0.5f);
  std::vector<float> transmittance(rays.size());

  const RawEmbree robust(mesh, RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_MEDIUM), plain(mesh, RTC_SCENE_FLAG_NONE, RTC_BUILD_QUALITY_HIGH);
  std::vector<RTCRayHit> raw_closest(rays.size()), closest_work;
  std::vector<RTCRay> raw_shadow(rays.size()), shadow_work;
  for (size_t i = 0; i < rays.size(); ++i) {
    raw_closest[i].ray = rawRay(rays[i]);
    raw_closest[i].hit.geomID = raw_closest[i].hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    raw_shadow[i] = rawRay(shadow_rays[i]);
  }
  using ClosestCall = void (RawEmbree::*)(std::span<RTCRayHit>) const;
  using ShadowCall = void (RawEmbree::*)(std::span<RTCRay>) const;
  const auto rawClosest = [&](const RawEmbree& embree, ClosestCall call) {
    return [&, call](int threads) {
      closest_work = raw_closest;  // Embree overwrites its rays
      return secondsPerThread(threads, rays.size(),
                              [&](size_t begin, size_t end) { (embree.*call)(std::span(closest_work).subspan(begin, end - begin)); });
    };
  };
  const auto rawShadow = [&](const RawEmbree& embree, ShadowCall call) {
    return [&, call](int threads) {
      shadow_work = raw_shadow;
      return secondsPerThread(threads, rays.size(),
                              [&](size_t begin, size_t end) { (embree.*call)(std::span(shadow_work).subspan(begin, end - begin)); });
    };
  };
  // As the bake does: some thousand rays at a time.
  const auto byThousands = [](size_t begin, size_t end, const auto& body) {
    for (; begin < end; begin += 1024) body(begin, std::min<size_t>(1024, end - begin));
  };
  json rows = json::array();
  for (const int threads : options.threads) {
    std::fprintf(stderr, "%d thread%s, %zu rays\n", threads, threads > 1 ? "s" : "", rays.size());
    const json closest = measure(options, threads, rays.size(),
                                 {{"Embree, rtcIntersect1", rawClosest(plain, &RawEmbree::intersectEach), {}},
                                  {"Embree, rtcIntersect1M", rawClosest(plain, &RawEmbree::intersectStream), {}},
                                  {"Embree robust, rtcIntersect1", rawClosest(robust, &RawEmbree::intersectEach), {}},
                                  {"Embree robust, rtcIntersect1M", rawClosest(robust, &RawEmbree::intersectStream), {}},
                                  {"Tracer::closest",
                                   [&](int n) {
                                     return secondsPerThread(n, rays.size(), [&](size_t begin, size_t end) {
                                       byThousands(begin, end, [&](size_t at, size_t count) {
                                         tracer.closest(std::span(rays).subspan(at, count), std::span(hits).subspan(at, count));
                                       });
                                     });
                                   },
                                   {}},
                                  {"sampling rays, untraced",
                                   [&](int n) {
                                     return secondsPerThread(n, slots.size(), [&](size_t begin, size_t end) {
                                       for (size_t i = begin; i < end; ++i) gatherer.rays(slots[i], bundle);
                                     });
                                   },
                                   {}},
                                  {"gathering (PRM bake)",
                                   [&](int n) {
                                     return secondsPerThread(n, slots.size(), [&](size_t begin, size_t end) {
                                       for (size_t i = begin; i < end; ++i) gatherer.hits(slots[i], bundle);
                                     });
                                   },
                                   {}}});
    const json shadow =
        measure(options, threads, rays.size(),
                {{"Embree, rtcOccluded1", rawShadow(plain, &RawEmbree::occludeEach), {}},
                 {"Embree, rtcOccluded1M", rawShadow(plain, &RawEmbree::occludeStream), {}},
                 {"Embree robust, rtcOccluded1", rawShadow(robust, &RawEmbree::occludeEach), {}},
                 {"Embree robust, rtcOccluded1M", rawShadow(robust, &RawEmbree::occludeStream), {}},
                 {"Tracer::transmittance",
                  [&](int n) {
                    return secondsPerThread(n, rays.size(), [&](size_t begin, size_t end) {
                      byThousands(begin, end, [&](size_t at, size_t count) {
                        tracer.transmittance(std::span(shadow_rays).subspan(at, count), std::span(transmittance).subspan(at, count));
                      });
                    });
                  },
                  {}}});
    for (const auto& part : {closest, shadow}) rows.insert(rows.end(), part.begin(), part.end());
  }
  if (options.json) {
    std::printf("%s\n", json{{"triangles", mesh.triangles.size()}, {"rows", rows}}.dump(1).c_str());
    return;
  }
  std::printf("what,threads,rays,mrays_per_cpu_second,ratio_to_raw,ratio_to_raw_robust\n");
  for (const auto& row : rows)
    std::printf("\"%s\",%d,%d,%.3f,%.3f,%.3f\n", row["what"].get_ref<const std::string&>().c_str(), row["threads"].get<int>(),
                row["rays"].get<int>(), row["mrays_per_cpu_second"].get<double>(), row["ratio_to_raw"].get<double>(),
                row["ratio_to_raw_robust"].get<double>());
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Rays per CPU second against raw Embree on the same rays: CSV or JSON on stdout.", "ray_rate");
  app.add_option("scene", options.scene, "glTF scene")->required();
  app.add_option("--threads", options.threads, "Numbers of threads to try; may be given several times")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--lightmap-size", options.lightmap_size, "Texels along each side of the atlas")
      ->check(CLI::Range(1, plan::kMostLightmapSize))
      ->capture_default_str();
  app.add_option("--texels", options.texels, "Texels that rays start from")->check(CLI::Range(1u, 1u << 20))->capture_default_str();
  app.add_option("--rays", options.rays, "Rays per texel")->check(CLI::Range(1u, 1u << 20))->capture_default_str();
  app.add_option("--rounds", options.rounds, "Rounds; medians are reported")->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_flag("--json", options.json, "JSON instead of CSV");
  CLI11_PARSE(app, argc, argv);
  try {
    run(options);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ray_rate: %s\n", error.what());
    return 1;
  }
}
