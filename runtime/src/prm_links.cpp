#include "runtime/src/prm_links.h"

#include "runtime/src/prm_links_sum.h"

namespace lightwell::runtime {
namespace {

struct Eight {
  static void add(float* sum, const int8_t* coefficient, const float* light) {
    for (int i = 0; i < 8; ++i) sum[i] += float(coefficient[i]) * light[i];
  }
};

}  // namespace

LinkArrays PrmLinks::arrays() const { return {power_.size(), power_.data(), first_piece_.data(), place_.data(), coefficient_.data()}; }

size_t PrmLinks::update(const LinkChange& change, float tolerance) const {
  const LinkArrays links = arrays();
  size_t read = 0;
  return addChangesAvx2(links, change, tolerance, read) ? read : addChanges<Eight>(links, change, tolerance);
}

}  // namespace lightwell::runtime
