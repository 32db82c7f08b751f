#include "cli/report/rays.h"

#include <time.h>

#include <algorithm>

#include "precompute/core/random.h"
#include "precompute/trace/raw_embree.h"
#include "precompute/transport/side_rays.h"

namespace lightwell::report {
namespace {

constexpr uint32_t kTexels = 512, kRays = 256, kRounds = 5;
constexpr uint64_t kSeed = 11;

double threadSeconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

template <class Work>
double secondsOf(const Work& work) {
  const double begin = threadSeconds();
  work();
  return threadSeconds() - begin;
}

}  // namespace

RayRate measureRays(const bake::BakeContext& context) {
  const scene::Mesh& mesh = context.scene().mesh;
  const transport::Sides sides = transport::surfaceSides(context.atlas());
  std::vector<trace::Ray> rays;
  for (uint32_t i = 0; i < kTexels; ++i) {
    const uint32_t side = uint32_t(mixBits(combineKeys(kSeed, i)) % context.atlas().slots.size());
    for (const auto& ray : transport::cosineRays(mesh, context.atlas(), sides, std::span(&side, 1), kRays, kSeed, i)) rays.push_back(ray);
  }
  if (rays.empty()) return {};
  const trace::RawEmbree plain(mesh, RTC_SCENE_FLAG_NONE, RTC_BUILD_QUALITY_HIGH), robust(mesh, RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_MEDIUM);
  std::vector<RTCRayHit> fresh(rays.size()), work;
  std::transform(rays.begin(), rays.end(), fresh.begin(), trace::rawRayHit);
  std::vector<trace::Hit> hits(rays.size());
  std::vector<double> tracer, raw_each, raw_stream, robust_each, robust_stream;
  for (uint32_t round = 0; round < kRounds; ++round) {
    tracer.push_back(secondsOf([&] { context.tracer()->closest(rays, hits); }));
    work = fresh, raw_each.push_back(secondsOf([&] { plain.intersectEach(work); }));
    work = fresh, raw_stream.push_back(secondsOf([&] { plain.intersectStream(work); }));
    work = fresh, robust_each.push_back(secondsOf([&] { robust.intersectEach(work); }));
    work = fresh, robust_stream.push_back(secondsOf([&] { robust.intersectStream(work); }));
  }
  const auto rate = [&](std::vector<double>& seconds) {
    std::nth_element(seconds.begin(), seconds.begin() + kRounds / 2, seconds.end());
    return 1e-6 * double(rays.size()) / std::max(seconds[kRounds / 2], 1e-9);
  };
  return {.tracer_mrays = rate(tracer), .raw_mrays = std::max(rate(raw_each), rate(raw_stream)), .raw_robust_mrays = std::max(rate(robust_each), rate(robust_stream))};
}

}  // namespace lightwell::report
