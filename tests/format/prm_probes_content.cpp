#include "tests/format/prm_probes_content.h"

namespace lightwell::format {

PrmProbesContent prmProbesContent() {
  PrmProbesContent c;
  c.base = localBasesContent();
  c.header.set_probes(2);
  c.header.set_max_rank(2);
  c.header.set_has_emitter(true);
  c.position = {0.5f, 1.5f, 0.25f, -1, 2, 3};
  c.block_rank = {2, 1};
  for (int i = 0; i < 36; ++i) c.basis.push_back(int8_t(i * 7 - 126));
  c.coefficient_scale = {0.25f, 0.5f, 0.125f, 1, 2, 3, 0.75f, 0.5f, 0.25f};
  c.block_first_link = {0, 3, 5};
  c.link_wavelet = {0, 4, 4, 3, 6};
  for (int i = 0; i < 3 * 3 * 2 + 2 * 3; ++i) c.coefficient.push_back(int8_t(100 - 11 * i));
  for (int i = 0; i < 54; ++i) c.emitter.push_back(uint16_t(i % 9 == 0 ? 0x3c00 : i % 2 ? 0x2400 + i : 0xa400 + i));
  return c;
}

Writer toWriter(const PrmProbesContent& c) {
  Writer writer = toWriter(c.base);
  const auto array = [&]<class T>(const char* name, const std::vector<T>& values, std::initializer_list<uint64_t> shape = {}) {
    if (!c.left_out.contains(name)) writer.add("prm_probes", name, values, shape);
  };
  writer.addSection("prm_probes");
  if (!c.left_out.contains("header")) writer.addMessage("prm_probes", "header", c.header);
  array("position", c.position, {c.position.size() / 3, 3});
  array("block_rank", c.block_rank);
  array("basis", c.basis);
  array("coefficient_scale", c.coefficient_scale);
  array("block_first_link", c.block_first_link);
  array("link_wavelet", c.link_wavelet);
  array("coefficient", c.coefficient);
  if (!c.emitter.empty()) writer.add("prm_probes", "emitter", c.emitter, {c.emitter.size() / 27, 9, 3}, ElementType::f16);
  return writer;
}

}  // namespace lightwell::format
