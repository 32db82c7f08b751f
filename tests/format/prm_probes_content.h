// A small sound container with a section "prm_probes", as plain data that a test may spoil before it is written.
#pragma once
#include "tests/format/content.h"

namespace lightwell::format {

/// Two probes of ranks 2 and 1 over the seven wavelets of localBasesContent(); the first links one of them twice.
struct PrmProbesContent {
  Content base;
  v1::PrmProbesHeader header;
  std::vector<float> position, coefficient_scale;
  std::vector<uint8_t> block_rank;
  std::vector<int8_t> basis, coefficient;
  std::vector<uint32_t> block_first_link, link_wavelet;
  std::vector<uint16_t> emitter;  // halfs
  std::set<std::string> left_out;
};

PrmProbesContent prmProbesContent();
Writer toWriter(const PrmProbesContent& content);

}  // namespace lightwell::format
