// The virtual lights of a container. docs/format.md gives the meaning of its arrays.
#pragma once
#include "format/decode/headers.h"
#include "runtime/src/host.h"

struct lw_virtual_lights {
  template <class T>
  using Array = lightwell::runtime::Array<T>;

  lightwell::runtime::Host host;
  lightwell::format::VplHeader header;
  Array<uint8_t> type, bounce;
  Array<uint32_t> source, first_vertex;
  Array<float> position_m, normal, flux_rgb, radius_m, vertex_m;
  Array<float> area_m2;
};
