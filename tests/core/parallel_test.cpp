#include "precompute/core/parallel.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace lightwell {
namespace {

TEST(ParallelFor, VisitsEveryIndexOnce) {
  for (const int threads : {0, 1, 3, 8})
    for (const size_t grain : {size_t(0), size_t(1), size_t(7), size_t(5000)}) {
      std::vector<int> visits(1000);
      parallelFor(visits.size(), grain, threads, nullptr, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) ++visits[i];
      });
      EXPECT_EQ(visits, std::vector<int>(1000, 1)) << threads << " threads, grain " << grain;
    }
}

TEST(ParallelFor, PassesAnExceptionOn) {
  EXPECT_THROW(parallelFor(100, 1, 4, nullptr, [](size_t begin, size_t) {
                 if (begin == 50) throw std::runtime_error("fifty");
               }),
               std::runtime_error);
}

TEST(ParallelFor, StopsWhenCancelled) {
  CancelFlag cancel;
  std::atomic<size_t> done{0};
  EXPECT_THROW(parallelFor(1000000, 1, 2, &cancel, [&](size_t, size_t) {
                 if (++done == 10) cancel.cancel();
               }),
               Cancelled);
  EXPECT_LT(done, 1000u);
}

}  // namespace
}  // namespace lightwell
