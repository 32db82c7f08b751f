// Probes on the GPU: their links, the light that they have, and where they may be looked at from.
#include <bit>
#include <cstring>

#include "runtime/src/container.h"
#include "runtime/src/gl/list_uploader.h"
#include "runtime/src/gl/radiosity_gl.h"
#include "runtime/src/gl/shaders.h"
#include "runtime/src/probes.h"

struct lw_gl_probes {
  using Name = lightwell::runtime::gl::Name;
  template <class T>
  using Array = lightwell::runtime::Array<T>;

  lightwell::runtime::Host host;
  lw_gl_radiosity* radiosity = nullptr;
  uint32_t probes = 0, groups = 2, gate_sets = 1;
  uint32_t portals_uploaded = 0;           // lw_gl_radiosity::portals_uploaded when `gate` was made
  uint64_t texture_bytes = 0;
  float lattice[4][4] = {};                // lw_probe_lattice
  Array<uint32_t> gate_set_first;
  Array<uint16_t> gate_set;
  Name link = 0, probe = 0, run = 0, gate = 0, data = 0;
  lightwell::runtime::gl::Target light;
};

namespace lightwell::runtime::gl {
namespace {

constexpr uint32_t kNearnessWords = (kNearnessNodes + 3) / 4;

class Uploader : ListUploader {
 public:
  Uploader(lw_gl_probes& out, const lw_probes& probes) : ListUploader(out.radiosity->context->api, out.host, out.texture_bytes), out_(out), p_(probes) {}

  lw_result upload() {
    api_.clearErrors();
    if (uint64_t(out_.probes) * out_.groups > kMaxTargetElements)
      return out_.host.fail(LW_LIMIT_EXCEEDED, "more than %llu probes", static_cast<unsigned long long>(kMaxTargetElements / out_.groups));
    links();
    data();
    if (!result_) result_ = createLayeredTarget(api_, out_.host, kTexelRgba32f, uint64_t(out_.probes) * out_.groups, out_.light, out_.texture_bytes);
    if (!result_) {
      constexpr float kZero[4] = {};
      for (int32_t layer = 0; layer < 4; ++layer) api_.ClearBufferfv(kColor, layer, kZero);
      if (const Enum error = api_.GetError(); error != kNoError)
        return out_.host.fail(error == kOutOfMemory ? LW_OUT_OF_MEMORY : LW_GL_FAILED, "uploading the probes: GL error 0x%04x", error);
    }
    return result_;
  }

 private:
  void links() {
    Array<uint32_t> row;
    if (!allocate(row, size_t(out_.probes) * 4)) return;
    uint32_t link = 0;
    for (size_t i = 0; i < out_.probes; ++i) {
      const uint32_t values[4] = {p_.first_run[i], p_.first_run[i + 1], link, std::bit_cast<uint32_t>(p_.scale[i])};
      std::memcpy(&row[i * 4], values, sizeof values);
      if (values[1] > values[0]) link = p_.run[values[1] - 1].end_link;
    }
    static_assert(sizeof(ProbeLink) == 8 && sizeof(LinkRun) == 8);
    list(out_.link, kTexelRg32ui, p_.link.size(), p_.link.data());
    list(out_.probe, kTexelRgba32ui, out_.probes, row.data());
    list(out_.run, kTexelRg32ui, p_.run.size(), p_.run.data());
    list(out_.gate, kTexelR32f, out_.gate_sets, nullptr);
    if (p_.gate_set_first.empty() || !allocate(out_.gate_set_first, p_.gate_set_first.size()) || !allocate(out_.gate_set, p_.gate_set.size())) return;
    std::memcpy(out_.gate_set_first.data(), p_.gate_set_first.data(), p_.gate_set_first.bytes());
    std::memcpy(out_.gate_set.data(), p_.gate_set.data(), p_.gate_set.bytes());
  }

  void data() {
    const auto& h = p_.header;
    const size_t bricks = p_.brick.size(), block = bricks, offset = block + p_.brick_probe.size(), nearness = offset + h.lattice_probes,
                 words = nearness + size_t(h.lattice_probes) * kNearnessWords;
    Array<uint32_t> data;
    if (!allocate(data, words + 1)) return;
    std::memset(data.data(), 0, data.bytes());
    if (bricks > 0) std::memcpy(data.data(), p_.brick.data(), p_.brick.bytes());
    if (p_.brick_probe.size() > 0) std::memcpy(&data[block], p_.brick_probe.data(), p_.brick_probe.bytes());
    for (size_t i = 0; i < h.lattice_probes; ++i) {
      data[offset + i] = p_.offset_biased[i];
      for (size_t k = 0; k < kNearnessNodes; ++k) data[nearness + i * kNearnessWords + k / 4] |= uint32_t(p_.nearness[i * kNearnessNodes + k]) << (8 * (k % 4));
    }
    list(out_.data, kTexelR32ui, words + 1, data.data());
    for (int k = 0; k < 3; ++k) {
      out_.lattice[0][k] = h.lattice_first_m[k];
      out_.lattice[1][k] = float(h.lattice_count[k]);
      out_.lattice[2][k] = float(p_.brick_count[k]);
    }
    out_.lattice[0][3] = h.lattice_spacing_m;
    out_.lattice[1][3] = float(out_.groups);
    out_.lattice[2][3] = float(block);
    out_.lattice[3][0] = float(offset);
    out_.lattice[3][1] = float(nearness);
  }

  lw_gl_probes& out_;
  const lw_probes& p_;
};

lw_result updateGates(lw_gl_probes& p) {
  const lw_gl_radiosity& r = *p.radiosity;
  if (p.portals_uploaded == r.portals_uploaded) return LW_OK;
  Array<float> factor;
  if (!factor.allocate(p.host, p.gate_sets)) return p.host.fail(LW_OUT_OF_MEMORY, "no memory for %u gate sets", p.gate_sets);
  factor[0] = 1;
  for (uint32_t s = 1; s < p.gate_sets; ++s) {
    factor[s] = 1;
    for (uint32_t e = p.gate_set_first[s]; e < p.gate_set_first[s + 1]; ++e) {
      const float open = r.gate_open[p.gate_set[e] / 2];
      factor[s] *= p.gate_set[e] & 1 ? 1 - open : open;
    }
  }
  r.context->api.ActiveTexture(kTexture0);
  uploadList(r.context->api, p.gate, kTexelR32f, p.gate_sets, factor.data());
  p.portals_uploaded = r.portals_uploaded;
  return LW_OK;
}

}  // namespace
}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;
using namespace lightwell::runtime::gl;

lw_result lw_gl_probes_create(lw_gl_radiosity* radiosity, const lw_probes* probes, const lw_gl_probes_options* given, lw_gl_probes** out) {
  if (!radiosity || !probes || !out) return LW_INVALID_ARGUMENT;
  const lw_gl_probes_options options = given ? *given : lw_gl_probes_options LW_GL_PROBES_OPTIONS_INIT;
  if (options.size < sizeof options || (options.coefficients != 4 && options.coefficients != 9))
    return radiosity->host.fail(LW_INVALID_ARGUMENT, "lw_gl_probes_options: a value is out of range");
  if (probes->patches != radiosity->patches || probes->nodes != radiosity->level_first[radiosity->levels] || probes->gates != radiosity->gate_open.size())
    return radiosity->host.fail(LW_INVALID_ARGUMENT, "the probes are of other form factors");
  lw_gl_probes* gl_probes = createHandle<lw_gl_probes>(radiosity->host);
  if (!gl_probes) return radiosity->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the probes");
  gl_probes->radiosity = radiosity;
  gl_probes->probes = probes->probes();
  gl_probes->groups = options.coefficients == 9 ? 2 : 1;
  gl_probes->gate_sets = probes->gate_sets;
  lw_result result;
  {
    const StateGuard guard(radiosity->context->api);
    result = prepareProbes(*radiosity->context);
    if (!result) result = Uploader(*gl_probes, *probes).upload();
    radiosity->context->api.clearErrors();
  }
  if (result) {
    lw_gl_probes_destroy(gl_probes);
    return result;
  }
  *out = gl_probes;
  return LW_OK;
}

void lw_gl_probes_destroy(lw_gl_probes* p) {
  if (!p) return;
  const Api& api = p->radiosity->context->api;
  destroyTarget(api, p->light);
  for (const Name name : {p->link, p->probe, p->run, p->gate, p->data})
    if (name) api.DeleteTextures(1, &name);
  destroyHandle(p);
}

uint64_t lw_gl_probes_texture_bytes(const lw_gl_probes* p) { return p ? p->texture_bytes : 0; }

lw_result lw_gl_probes_evaluate(lw_gl_probes* p, uint32_t light) {
  if (!p) return LW_INVALID_ARGUMENT;
  if (!light || light > (LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS)) return p->host.fail(LW_INVALID_ARGUMENT, "no such kind of light");
  const lw_gl_radiosity& r = *p->radiosity;
  const lw_gl& context = *r.context;
  const Api& api = context.api;
  const StateGuard guard(api);
  if (const lw_result result = updateGates(*p)) return result;
  updateNodes(r, light);
  const Program& program = context.probes;
  api.UseProgram(program.name);
  api.Uniform1i(program.uniform[probes_uniform::probes], int32_t(p->probes));
  api.Uniform1i(program.uniform[probes_uniform::groups], int32_t(p->groups));
  bind(api, 0, kTexture2dArray, p->link);
  bind(api, 1, kTexture2dArray, p->probe);
  bind(api, 2, kTexture2dArray, p->run);
  bind(api, 3, kTexture2dArray, p->gate);
  bind(api, 4, kTexture2d, r.node.texture);
  drawInto(r, p->light, 0, p->probes * p->groups);
  return LW_OK;
}

lw_result lw_gl_bind_probes(lw_gl_probes* p, uint32_t program, uint32_t first_unit) {
  if (!p || !program) return LW_INVALID_ARGUMENT;
  const Api& api = p->radiosity->context->api;
  const int32_t location = api.GetUniformLocation(program, "lw_probe_lattice");
  if (location < 0) return p->host.fail(LW_NOT_FOUND, "the program does not use lwProbeLight");
  int32_t previous_program = 0, active_texture = 0;
  api.GetIntegerv(kCurrentProgram, &previous_program);
  api.GetIntegerv(kActiveTexture, &active_texture);
  api.UseProgram(program);
  api.Uniform4fv(location, 4, &p->lattice[0][0]);
  const struct {
    const char* sampler;
    Name texture;
  } textures[] = {{"lw_probe_light", p->light.texture}, {"lw_probe_data", p->data}};
  uint32_t unit = first_unit;
  for (const auto& t : textures) {
    api.Uniform1i(api.GetUniformLocation(program, t.sampler), int32_t(unit));
    bind(api, unit, kTexture2dArray, t.texture);
    api.BindSampler(unit++, 0);
  }
  api.UseProgram(Name(previous_program));
  api.ActiveTexture(Enum(active_texture));
  return LW_OK;
}

lw_result lw_gl_probes_read(lw_gl_probes* p, float* radiance_sh) {
  if (!p || !radiance_sh) return LW_INVALID_ARGUMENT;
  const Api& api = p->radiosity->context->api;
  const size_t texels = size_t(p->light.width) * size_t(p->light.height);
  Array<float> part[4];
  for (auto& layer : part)
    if (!layer.allocate(p->host, texels * 4)) return p->host.fail(LW_OUT_OF_MEMORY, "no memory to read back %u probes", p->probes);
  {
    const StateGuard guard(api);
    api.clearErrors();
    api.BindFramebuffer(kReadFramebuffer, p->light.framebuffer);
    for (uint32_t layer = 0; layer < 4; ++layer) {
      api.ReadBuffer(kColorAttachment0 + layer);
      api.ReadPixels(0, 0, p->light.width, p->light.height, kRgba, kFloat, part[layer].data());
    }
    api.ReadBuffer(kColorAttachment0);
    if (const Enum error = api.GetError(); error != kNoError) return p->host.fail(LW_GL_FAILED, "reading back: GL error 0x%04x", error);
  }
  // From the polynomial back to the harmonics: lw_sh_irradiance's factors undone.
  constexpr float pi = 3.14159265f, y0 = 1 / (0.28209479f * pi), y1 = 1 / (0.48860251f * 2 * pi / 3), y2 = 4 / (1.09254843f * pi), y20 = 4 / (0.31539157f * pi);
  std::memset(radiance_sh, 0, size_t(p->probes) * 27 * sizeof(float));
  for (size_t i = 0; i < p->probes; ++i)
    for (size_t c = 0; c < 3; ++c) {
      const float* a = &part[c][i * p->groups * 4];
      float* sh = radiance_sh + i * 27 + c;
      float mean = a[3];
      if (p->groups == 2) {
        const float *b = a + 4, d = part[3][i * p->groups * 4 + c];
        mean += b[2] / 3;
        sh[12] = b[0] * y2, sh[15] = b[1] * y2, sh[18] = b[2] / 3 * y20, sh[21] = b[3] * y2, sh[24] = d * 2 * y2;
      }
      sh[0] = mean * y0, sh[3] = a[1] * y1, sh[6] = a[2] * y1, sh[9] = a[0] * y1;
    }
  return LW_OK;
}
