// The header messages of the known sections as plain structs, for readers that have no protobuf library. Field meanings: container.proto.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace lightwell::format {

struct AtlasHeader {
  uint32_t width = 0, height = 0, covered_texels = 0, charts = 0;
  bool unwrapped = false;
};

enum class PrmLayout : uint8_t { unknown = 0, panes = 1, local_bases = 3 };

struct PrmHeader {
  PrmLayout layout = PrmLayout::unknown;
  uint32_t entries = 0, clusters = 0, texels = 0;
  uint32_t blocks = 0, max_rank = 0;  // local bases only
  uint32_t brightest = 0;             // panes: recommended K, 0: all
  bool has_emitter = false;
  bool has_sky = false;
  float sky_scale = 0;
};

struct SceneHeader {
  double origin_m[3] = {};
  float bounds_min_m[3] = {}, bounds_max_m[3] = {};  // relative to the origin
  uint32_t light_count = 0;
};

enum class LightType : uint8_t { unknown = 0, point = 1, spot = 2, directional = 3 };

struct Light {
  LightType type = LightType::unknown;
  std::string_view name;       // into the message's bytes
  float position_m[3] = {}, direction[3] = {}, intensity_rgb[3] = {};
  float inner_cone_angle = 0, outer_cone_angle = 0, range_m = 0;
};

struct EnvironmentHeader {
  uint32_t cells = 0, suns = 0;
  uint32_t face_cells = 0;
  float node_scale = 0;
  float sky_flux_rgb[3] = {}, radiance_sh_rgb[27] = {};
};

struct RadiosityPortal {
  std::string_view name;       // into the message's bytes
  uint32_t first_gate = 0, strips = 0;
  uint32_t first_triangle = 0, triangles = 0;
  float axis_per_m[3] = {}, offset = 0;
};

struct RadiosityHeader {
  uint32_t patches = 0, texels = 0;
  bool has_emission = false, has_backs = false;
  uint32_t material_count = 0, portal_count = 0;
};

struct LightmapHeader {
  uint32_t texels = 0;
  bool has_direct = false, has_indirect = false, has_direct_gradient = false, has_indirect_gradient = false;
  float unit = 1;  // never 0
};

struct VplHeader {
  uint32_t lights = 0, vertices = 0, sources = 0;
};

struct PointsHeader {
  uint32_t points = 0;
  float area_m2 = 0, first_m[3] = {}, step_m[3] = {};
};

struct ProbesHeader {
  uint32_t lattice_probes = 0, points = 0;
  uint64_t lattice_count[3] = {};      // all 0 without a lattice
  float lattice_first_m[3] = {};
  float lattice_spacing_m = 0;
};

struct PrmProbesHeader {
  uint32_t probes = 0, max_rank = 0;
  bool has_emitter = false;
};

/// Of section meta.
struct MeasuredError {
  struct Estimate {
    double value = 0, low = 0, high = 0;
  };
  std::string_view section, against;  // into the message's bytes
  Estimate relrmse, texrel, bias, maximum;
  double seconds = 0;
  uint32_t texels = 0;
};

/// Each parses the decoded bytes of a chunk "header". False when they are not a valid message of that kind (wire format, array lengths).
/// Values are not judged further; `verify` does that.
bool parseAtlasHeader(const uint8_t* message, size_t bytes, AtlasHeader& header);
bool parsePrmHeader(const uint8_t* message, size_t bytes, PrmHeader& header);
bool parsePrmProbesHeader(const uint8_t* message, size_t bytes, PrmProbesHeader& header);
bool parseEnvironmentHeader(const uint8_t* message, size_t bytes, EnvironmentHeader& header);
bool parseLightmapHeader(const uint8_t* message, size_t bytes, LightmapHeader& header);
bool parseVplHeader(const uint8_t* message, size_t bytes, VplHeader& header);
bool parsePointsHeader(const uint8_t* message, size_t bytes, PointsHeader& header);
bool parseProbesHeader(const uint8_t* message, size_t bytes, ProbesHeader& header);
/// One of a MetaHeader's errors (its field 3), whose text refers to `message`.
bool parseMeasuredError(const uint8_t* message, size_t bytes, MeasuredError& error);
/// `lights` receives the first `capacity` of them; it may be null when that is 0.
bool parseSceneHeader(const uint8_t* message, size_t bytes, SceneHeader& header, Light* lights, size_t capacity);

/// The same for the names of materials and for portals.
bool parseRadiosityHeader(const uint8_t* message, size_t bytes, RadiosityHeader& header, std::string_view* material_names, size_t material_capacity,
                          RadiosityPortal* portals, size_t portal_capacity);

}  // namespace lightwell::format
