#include "runtime/src/texel_surface.h"

#include <algorithm>
#include <cmath>

#include "format/decode/pixel.h"
#include "format/decode/texels.h"
#include "runtime/src/form_factor.h"
#include "runtime/src/geometry.h"

namespace lightwell::runtime {
namespace {

Float3 vertex(const Array<float>& values, uint32_t index) { return {values[size_t(index) * 3], values[size_t(index) * 3 + 1], values[size_t(index) * 3 + 2]}; }
float lengthOf(Float3 v) { return std::sqrt(dot(v, v)); }

/// Meyer et al., "On Floating-Point Normal Vectors" (EGSR 2010): the unit sphere folded from an octahedron.
void packNormal(Float3 n, float* packed) {
  const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z), scale = sum > 0 ? 1 / sum : 0;
  packed[0] = n.x * scale, packed[1] = n.y * scale;
  if (n.z >= 0) return;
  const float x = packed[0], y = packed[1];
  packed[0] = std::copysign(1 - std::abs(y), x), packed[1] = std::copysign(1 - std::abs(x), y);
}

/// Sums over a texel's pieces of surface, weighted by area.
struct Sum {
  double position_m[3], area_m2;
  double square_m2[6];              // xx, yy, zz, xy, yz, zx
  Float3 shading, surface, along_u;
};

class Finder {
 public:
  Finder(const lw_container& container, TexelSurface& out) : container_(container), out_(out) {}

  lw_result find(bool fill) {
    lw_result result = decodeArray(&container_, LW_ARRAY_POSITION, position_m_);
    if (!result) result = decodeArray(&container_, LW_ARRAY_NORMAL, normal_);
    if (!result) result = decodeArray(&container_, LW_ARRAY_LIGHTMAP_UV, uv_);
    if (!result) result = decodeArray(&container_, LW_ARRAY_INDEX, index_);
    lw_atlas_info atlas;
    if (!result) result = lw_get_atlas_info(&container_, &atlas);
    if (!result) result = number(atlas, fill);
    if (result) return result;
    if (!sum_.allocate(container_.host, values_)) return container_.host.fail(LW_OUT_OF_MEMORY, "no memory for the surfaces of %u texels", values_);
    std::fill(sum_.begin(), sum_.end(), Sum{});
    for (size_t t = 0; t < index_.size() / 3; ++t) addTriangle(&index_[t * 3]);
    return pack();
  }

 private:
  /// Numbers the texels with a value; own_ is the value of a texel's own surface.
  lw_result number(const lw_atlas_info& atlas, bool fill) {
    out_.width = atlas.width, out_.height = atlas.height;
    Array<uint32_t> source;
    Array<uint8_t> coverage;
    lw_result result = decodeArray(&container_, LW_ARRAY_ATLAS_SOURCE, source);
    if (!result) result = decodeArray(&container_, LW_ARRAY_ATLAS_COVERAGE, coverage);
    if (result) return result;
    if (!own_.allocate(container_.host, source.size()) || !out_.value_of_texel.allocate(container_.host, source.size()))
      return container_.host.fail(LW_OUT_OF_MEMORY, "no memory for an atlas of %zu texels", source.size());
    for (size_t texel = 0; texel < source.size(); ++texel) own_[texel] = (fill ? source[texel] == texel : coverage[texel] != 0) ? values_++ : kNone;
    for (size_t texel = 0; texel < source.size(); ++texel)
      out_.value_of_texel[texel] = fill ? (source[texel] == kNone ? kNone : own_[source[texel]]) : own_[texel];
    return LW_OK;
  }

  /// A triangle's mean square is (Σ corner² + 9 middle²) / 12.
  static void addSquare(Sum& sum, const double (&p)[3], double weight, double* total) {
    for (int k = 0; k < 3; ++k) {
      sum.square_m2[k] += weight * p[k] * p[k];
      sum.square_m2[3 + k] += weight * p[k] * p[(k + 1) % 3];
      if (total) total[k] += p[k];
    }
  }

  void addTriangle(const uint32_t* corner) {
    Float3 position[3], normal[3];
    format::ClipVertex clip[3];
    for (int c = 0; c < 3; ++c) {
      position[c] = vertex(position_m_, corner[c]), normal[c] = vertex(normal_, corner[c]);
      const float* uv = &uv_[size_t(corner[c]) * 2];
      clip[c] = {format::toTexels(uv[0], int(out_.width)), format::toTexels(uv[1], int(out_.height)), c == 1 ? 1.0 : 0.0, c == 2 ? 1.0 : 0.0};
    }
    const Float3 ab = position[1] - position[0], ac = position[2] - position[0], twice = cross(ab, ac);
    // The way that the light map's u goes on the surface.
    Float3 along_u = ab * float(clip[2].y - clip[0].y) - ac * float(clip[1].y - clip[0].y);
    if ((clip[1].x - clip[0].x) * (clip[2].y - clip[0].y) < (clip[2].x - clip[0].x) * (clip[1].y - clip[0].y)) along_u = along_u * -1;
    along_u = along_u * (1 / std::max(lengthOf(along_u), 1e-30f));
    const double area_m2 = std::max(0.5 * double(lengthOf(twice)), 1e-30);  // that every triangle has some
    format::clipToCells(clip, {0, long(out_.width), 0, long(out_.height)}, [&](long x, long y, const format::ClipPolygon& piece) {
      const uint32_t value = own_[size_t(y) * out_.width + size_t(x)];
      if (value == kNone || format::isNegligible(piece)) return;
      double share = 0, u = 0, v = 0;
      Sum& sum = sum_[value];
      for (int i = 2; i < piece.count; ++i) {
        const double part = piece.fanShare(i);
        const format::ClipVertex* fan[3] = {&piece.vertex[0], &piece.vertex[i - 1], &piece.vertex[i]};
        share += part;
        double middle_m[3] = {};
        for (const format::ClipVertex* c : fan) {
          u += part * c->u / 3, v += part * c->v / 3;
          const Float3 at = position[0] + ab * float(c->u) + ac * float(c->v);
          addSquare(sum, {double(at.x), double(at.y), double(at.z)}, area_m2 * part / 12, middle_m);
        }
        for (int k = 0; k < 3; ++k) sum.position_m[k] += area_m2 * part * middle_m[k] / 3;
        for (double& m : middle_m) m /= 3;
        addSquare(sum, {middle_m[0], middle_m[1], middle_m[2]}, area_m2 * part * 0.75, nullptr);
      }
      if (!(share > 0)) return;
      const float s = float(u / share), t = float(v / share), weight = float(area_m2 * share);
      sum.area_m2 += double(weight);
      const Float3 shading = normal[0] * (1 - s - t) + normal[1] * s + normal[2] * t;
      sum.shading = sum.shading + shading * (weight / std::max(lengthOf(shading), 1e-20f));
      sum.surface = sum.surface + twice * float(0.5 * share);
      sum.along_u = sum.along_u + along_u * weight;
    });
  }

  lw_result pack() {
    if (!out_.place.allocate(container_.host, size_t(values_) * 4) || !out_.normal.allocate(container_.host, size_t(values_) * 4) ||
        !out_.axes.allocate(container_.host, size_t(values_) * 8))
      return container_.host.fail(LW_OUT_OF_MEMORY, "no memory for the surfaces of %u texels", values_);
    for (size_t i = 0; i < values_; ++i) {
      const Sum& sum = sum_[i];
      if (!(sum.area_m2 > 0)) return container_.host.fail(LW_BAD_SECTION, "atlas/coverage: a covered texel lies under no triangle");
      for (size_t k = 0; k < 3; ++k) out_.place[i * 4 + k] = float(sum.position_m[k] / sum.area_m2);
      out_.place[i * 4 + 3] = 0.5f * float(std::sqrt(sum.area_m2));
      // Where a texel is folded over, its normals may cancel: then either counts for both.
      const bool has_shading = lengthOf(sum.shading) > 1e-3f * float(sum.area_m2), has_surface = lengthOf(sum.surface) > 1e-3f * float(sum.area_m2);
      packNormal(has_shading || !has_surface ? sum.shading : sum.surface, &out_.normal[i * 4]);
      packNormal(has_surface ? sum.surface : sum.shading, &out_.normal[i * 4 + 2]);
      packAxes(sum, has_surface ? sum.surface : sum.shading, &out_.place[i * 4], &out_.axes[i * 8]);
    }
    return LW_OK;
  }

  /// Cholesky's factors of the covariance in the tangent plane, the first along the light map's u: a whole texel is their parallelogram, as are those that a chart's straight border cuts.
  static void packAxes(const Sum& sum, Float3 normal, const float* place, uint16_t* axes) {
    normal = normal * (1 / std::max(lengthOf(normal), 1e-30f));
    Float3 tangent = sum.along_u - normal * dot(normal, sum.along_u);
    if (!(lengthOf(tangent) > 1e-3f * float(sum.area_m2))) tangent = std::abs(normal.x) > 0.5f ? Float3{normal.y, -normal.x, 0} : Float3{0, normal.z, -normal.y};
    tangent = tangent * (1 / std::max(lengthOf(tangent), 1e-30f));
    const Float3 bitangent = cross(normal, tangent);
    const double t[3] = {double(tangent.x), double(tangent.y), double(tangent.z)}, b[3] = {double(bitangent.x), double(bitangent.y), double(bitangent.z)};
    const double n[3] = {double(normal.x), double(normal.y), double(normal.z)};
    double tt = 0, tb = 0, bb = 0, nn = 0;
    for (int k = 0; k < 3; ++k)
      for (int l = 0; l < 3; ++l) {
        const double square = sum.square_m2[k == l ? k : (k + 1) % 3 == l ? 3 + k : 3 + l] / sum.area_m2, covariance = square - sum.position_m[k] * sum.position_m[l] / (sum.area_m2 * sum.area_m2);
        tt += t[k] * t[l] * covariance, tb += t[k] * b[l] * covariance, bb += b[k] * b[l] * covariance, nn += n[k] * n[l] * covariance;
      }
    const double scale = 1 / std::max(double(place[3]), 1e-30), first = std::sqrt(std::max(tt, 0.0)), along = first > 0 ? tb / first : 0, second = std::sqrt(std::max(bb - along * along, 0.0));
    for (int k = 0; k < 3; ++k) {
      axes[k] = format::packHalf(float(std::clamp((first * t[k] + along * b[k]) * scale, -1e3, 1e3)));
      axes[4 + k] = format::packHalf(float(std::clamp(second * b[k] * scale, -1e3, 1e3)));
    }
    axes[3] = format::packHalf(float(std::clamp(std::sqrt(std::max(3 * nn, 0.0)) * scale, 0.0, 1e3)));
    axes[7] = 0;
  }

  const lw_container& container_;
  TexelSurface& out_;
  Array<float> position_m_, normal_, uv_;
  Array<uint32_t> index_, own_;
  Array<Sum> sum_;
  uint32_t values_ = 0;
};

}  // namespace

lw_result findTexelSurface(const lw_container& container, bool fill, TexelSurface& surface) { return Finder(container, surface).find(fill); }

}  // namespace lightwell::runtime
