#include "format/decode/headers.h"

#include "format/decode/wire.h"

namespace lightwell::format {
namespace {

/// Enums of the messages have values below 256 in every version so far; larger ones read as unknown.
template <class Enum>
void readEnum(WireReader& reader, Enum& value, Enum largest_known) {
  uint32_t number = 0;
  reader.read(number);
  value = number <= uint32_t(largest_known) ? Enum(number) : Enum::unknown;
}

/// A fixed-length array as a repeated field: must have all its numbers.
template <class Number, uint32_t Length>
struct Vector {
  Number (&values)[Length];
  uint32_t count = 0;
  void append(WireReader& reader) { reader.append(values, Length, count); }
  bool complete() const { return count == Length; }
};

bool parseLight(std::string_view message, Light& light) {
  WireReader reader(message);
  Vector<float, 3> position{light.position_m}, direction{light.direction}, intensity{light.intensity_rgb};
  while (reader.next()) switch (reader.field()) {
      case 1: readEnum(reader, light.type, LightType::directional); break;
      case 2: reader.read(light.name); break;
      case 3: position.append(reader); break;
      case 4: direction.append(reader); break;
      case 5: intensity.append(reader); break;
      case 6: reader.read(light.inner_cone_angle); break;
      case 7: reader.read(light.outer_cone_angle); break;
      case 8: reader.read(light.range_m); break;
    }
  return reader.ok() && position.complete() && direction.complete() && intensity.complete();
}

bool parsePortal(std::string_view message, RadiosityPortal& portal) {
  WireReader reader(message);
  Vector<float, 3> axis{portal.axis_per_m};
  while (reader.next()) switch (reader.field()) {
      case 1: reader.read(portal.name); break;
      case 2: reader.read(portal.first_gate); break;
      case 3: reader.read(portal.strips); break;
      case 4: reader.read(portal.first_triangle); break;
      case 5: reader.read(portal.triangles); break;
      case 6: axis.append(reader); break;
      case 7: reader.read(portal.offset); break;
    }
  return reader.ok() && (axis.complete() || axis.count == 0);
}

}  // namespace

bool parseAtlasHeader(const uint8_t* message, size_t bytes, AtlasHeader& header) {
  header = {};
  WireReader reader(message, bytes);
  while (reader.next()) switch (reader.field()) {
      case 1: reader.read(header.width); break;
      case 2: reader.read(header.height); break;
      case 3: reader.read(header.covered_texels); break;
      case 4: reader.read(header.charts); break;
      case 5: reader.read(header.unwrapped); break;
    }
  return reader.ok();
}

bool parsePrmHeader(const uint8_t* message, size_t bytes, PrmHeader& header) {
  header = {};
  WireReader reader(message, bytes);
  while (reader.next()) switch (reader.field()) {
      case 1:
        readEnum(reader, header.layout, PrmLayout::local_bases);
        if (header.layout != PrmLayout::panes && header.layout != PrmLayout::local_bases) header.layout = PrmLayout::unknown;  // 2 is reserved
        break;
      case 2: reader.read(header.entries); break;
      case 3: reader.read(header.clusters); break;
      case 4: reader.read(header.texels); break;
      case 5: reader.read(header.blocks); break;
      case 6: reader.read(header.max_rank); break;
      case 7: reader.read(header.brightest); break;
      case 8: reader.read(header.has_emitter); break;
      case 10: reader.read(header.has_sky); break;
      case 11: reader.read(header.sky_scale); break;
    }
  return reader.ok();
}

bool parseEnvironmentHeader(const uint8_t* message, size_t bytes, EnvironmentHeader& header) {
  header = {};
  WireReader reader(message, bytes);
  Vector<float, 3> sky_flux{header.sky_flux_rgb};
  Vector<float, 27> radiance_sh{header.radiance_sh_rgb};
  while (reader.next()) switch (reader.field()) {
      case 1: reader.read(header.cells); break;
      case 2: reader.read(header.suns); break;
      case 3: reader.read(header.face_cells); break;
      case 4: reader.read(header.node_scale); break;
      case 5: sky_flux.append(reader); break;
      case 6: radiance_sh.append(reader); break;
    }
  return reader.ok() && sky_flux.complete() && radiance_sh.complete();
}

bool parsePrmProbesHeader(const uint8_t* message, size_t bytes, PrmProbesHeader& header) {
  header = {};
  WireReader reader(message, bytes);
  while (reader.next()) switch (reader.field()) {
      case 1: reader.read(header.probes); break;
      case 2: reader.read(header.max_rank); break;
      case 3: reader.read(header.has_emitter); break;
    }
  return reader.ok();
}

bool parseLightmapHeader(const uint8_t* message, size_t bytes, LightmapHeader& header) {
  header = {};
  WireReader reader(message, bytes);
  while (reader.next()) switch (reader.field()) {
      case 1: reader.read(header.texels); break;
      case 2: reader.read(header.has_direct); break;
      case 3: reader.read(header.has_indirect); break;
      case 4: reader.read(header.has_direct_gradient); break;
      case 5: reader.read(header.has_indirect_gradient); break;
      case 6: reader.read(header.unit); break;
    }
  if (header.unit == 0) header.unit = 1;
  return reader.ok();
}

bool parseVplHeader(const uint8_t* message, size_t bytes, VplHeader& header) {
  header = {};
  WireReader reader(message, bytes);
  while (reader.next()) switch (reader.field()) {
      case 1: reader.read(header.lights); break;
      case 2: reader.read(header.vertices); break;
      case 3: reader.read(header.sources); break;
    }
  return reader.ok();
}

bool parsePointsHeader(const uint8_t* message, size_t bytes, PointsHeader& header) {
  header = {};
  WireReader reader(message, bytes);
  Vector<float, 3> first{header.first_m}, step{header.step_m};
  while (reader.next()) switch (reader.field()) {
      case 1: reader.read(header.points); break;
      case 2: reader.read(header.area_m2); break;
      case 3: first.append(reader); break;
      case 4: step.append(reader); break;
    }
  return reader.ok() && first.complete() && step.complete();
}

bool parseProbesHeader(const uint8_t* message, size_t bytes, ProbesHeader& header) {
  header = {};
  WireReader reader(message, bytes);
  uint32_t counts = 0;
  Vector<float, 3> first{header.lattice_first_m};
  while (reader.next()) switch (reader.field()) {
      case 1: reader.read(header.lattice_probes); break;
      case 2: reader.read(header.points); break;
      case 3: reader.append(header.lattice_count, 3, counts); break;
      case 4: first.append(reader); break;
      case 5: reader.read(header.lattice_spacing_m); break;
    }
  return reader.ok() && counts == first.count && (counts == 0 || counts == 3);
}

bool parseMeasuredError(const uint8_t* message, size_t bytes, MeasuredError& error) {
  error = {};
  WireReader reader(message, bytes);
  while (reader.next()) switch (reader.field()) {
      case 1: reader.read(error.section); break;
      case 2: reader.read(error.relrmse.value); break;
      case 3: reader.read(error.texrel.value); break;
      case 4: reader.read(error.bias.value); break;
      case 5: reader.read(error.against); break;
      case 6: reader.read(error.relrmse.low); break;
      case 7: reader.read(error.relrmse.high); break;
      case 8: reader.read(error.texrel.low); break;
      case 9: reader.read(error.texrel.high); break;
      case 10: reader.read(error.bias.low); break;
      case 11: reader.read(error.bias.high); break;
      case 12: reader.read(error.maximum.value); break;
      case 13: reader.read(error.maximum.low); break;
      case 14: reader.read(error.maximum.high); break;
      case 15: reader.read(error.texels); break;
      case 16: reader.read(error.seconds); break;
    }
  return reader.ok();
}

bool parseRadiosityHeader(const uint8_t* message, size_t bytes, RadiosityHeader& header, std::string_view* material_names, size_t material_capacity,
                          RadiosityPortal* portals, size_t portal_capacity) {
  header = {};
  WireReader reader(message, bytes);
  while (reader.next()) switch (reader.field()) {
      case 1: reader.read(header.patches); break;
      case 2: reader.read(header.texels); break;
      case 3: reader.read(header.has_emission); break;
      case 4: reader.read(header.has_backs); break;
      case 5: {
        std::string_view name;
        WireReader material(reader.bytes());
        while (material.next())
          if (material.field() == 1) material.read(name);
        if (!material.ok()) return false;
        if (material_names && header.material_count < material_capacity) material_names[header.material_count] = name;
        ++header.material_count;
        break;
      }
      case 6: {
        RadiosityPortal portal;
        if (!parsePortal(reader.bytes(), portal)) return false;
        if (portals && header.portal_count < portal_capacity) portals[header.portal_count] = portal;
        ++header.portal_count;
        break;
      }
    }
  return reader.ok();
}

bool parseSceneHeader(const uint8_t* message, size_t bytes, SceneHeader& header, Light* lights, size_t capacity) {
  header = {};
  WireReader reader(message, bytes);
  Vector<double, 3> origin{header.origin_m};
  Vector<float, 3> bounds_min{header.bounds_min_m}, bounds_max{header.bounds_max_m};
  while (reader.next()) switch (reader.field()) {
      case 1: origin.append(reader); break;
      case 2: bounds_min.append(reader); break;
      case 3: bounds_max.append(reader); break;
      case 4: {
        Light next;
        if (!parseLight(reader.bytes(), next)) return false;
        if (header.light_count < capacity) lights[header.light_count] = next;
        ++header.light_count;
        break;
      }
    }
  return reader.ok() && origin.complete() && bounds_min.complete() && bounds_max.complete();
}

}  // namespace lightwell::format
