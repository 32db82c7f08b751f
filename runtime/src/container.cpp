// Opening, and what the headers say.
#include "runtime/src/container.h"

#include <cerrno>
#include <cmath>
#include <cstring>

#include "runtime/src/light.h"

using namespace lightwell;
using namespace lightwell::runtime;

namespace lightwell::runtime {

lw_result findChunk(const lw_container& container, std::string_view section, std::string_view name, const format::ChunkInfo*& chunk) {
  const format::SectionInfo* info = container.view.findSection(section);
  if (!info)
    return container.host.fail(LW_NOT_FOUND, "the container has no section \"%.*s\"", int(section.size()), section.data());
  if (!info->known)
    return container.host.fail(LW_TOO_NEW, "section \"%.*s\" has version %u, which this library does not know", int(section.size()),
                               section.data(), info->version);
  chunk = container.view.findChunk(section, name);
  if (!chunk)
    return container.host.fail(LW_NOT_FOUND, "the container has no chunk %.*s/%.*s", int(section.size()), section.data(), int(name.size()),
                               name.data());
  if (!chunk->decodable)
    return container.host.fail(LW_TOO_NEW, "%.*s/%.*s is stored in a way of a later version", int(section.size()), section.data(),
                               int(name.size()), name.data());
  return LW_OK;
}

lw_result findChunk(const lw_container& container, std::string_view section, std::string_view name, format::ElementType element,
                    const format::ChunkInfo*& chunk) {
  const lw_result result = findChunk(container, section, name, chunk);
  // A section that is there promises the chunk, so that its absence is damage.
  if (result == LW_NOT_FOUND) return container.view.findSection(section) ? LW_BAD_SECTION : LW_NOT_FOUND;
  if (result) return result;
  return chunk->element == element ? LW_OK : badSection(container, *chunk, "it has another element type than its section demands");
}

lw_result badSection(const lw_container& container, const format::ChunkInfo& chunk, const char* reason) {
  return container.host.fail(LW_BAD_SECTION, "%.*s/%.*s: %s", int(chunk.section.size()), chunk.section.data(), int(chunk.name.size()),
                             chunk.name.data(), reason);
}

bool isSourceMap(const uint32_t* source, uint64_t texels) {
  for (uint64_t i = 0; i < texels; ++i)
    if (source[i] != kNone && (source[i] >= texels || source[source[i]] != source[i])) return false;
  return true;
}

void fillFromSources(const uint32_t* source, size_t texels, float* rgba) {
  for (size_t i = 0; i < texels; ++i) {
    if (source[i] == kNone) std::memset(rgba + i * 4, 0, 4 * sizeof(float));
    else if (source[i] != i) std::memcpy(rgba + i * 4, rgba + size_t(source[i]) * 4, 4 * sizeof(float));
  }
}

namespace {

bool inRange(const lw_container& container, uint32_t width, uint32_t height) {
  if (width && height && uint64_t(width) * height < kNone) return true;
  container.host.fail(LW_BAD_SECTION, "atlas/header: an atlas of %u x %u texels cannot be", width, height);
  return false;
}

}  // namespace

lw_result readAtlasHeader(const lw_container& container, format::AtlasHeader& header) {
  if (const lw_result result = readHeader(container, "atlas", [&](const Array<uint8_t>& message) {
        return format::parseAtlasHeader(message.data(), message.size(), header);
      }))
    return result;
  return inRange(container, header.width, header.height) ? LW_OK : LW_BAD_SECTION;
}

lw_result readEnvironmentHeader(const lw_container& container, format::EnvironmentHeader& header) {
  return readHeader(container, "environment", [&](const Array<uint8_t>& message) {
    return format::parseEnvironmentHeader(message.data(), message.size(), header);
  });
}

lw_result readPrmHeader(const lw_container& container, format::PrmHeader& header) {
  return readHeader(container, "prm",
                    [&](const Array<uint8_t>& message) { return format::parsePrmHeader(message.data(), message.size(), header); });
}

namespace {

/// Fails for want of memory or of the file. Whatever else is wrong with the section is told when somebody asks for it.
lw_result readScene(lw_container& container) {
  const format::SectionInfo* section = container.view.findSection("scene");
  const format::ChunkInfo* chunk = container.view.findChunk("scene", "header");
  if (!section || !section->known || !chunk || !chunk->decodable || chunk->element != format::ElementType::bytes) return LW_OK;
  Array<uint8_t> message;
  format::SceneHeader header;
  Array<format::Light>& lights = container.scene_lights;
  if (!message.allocate(container.host, size_t(chunk->raw_bytes))) return container.host.fail(LW_OUT_OF_MEMORY, "no memory for the scene's header");
  if (const format::Fault fault = container.view.decode(*chunk, message.data(), message.bytes()))
    return fault.status == format::Status::io_error || fault.status == format::Status::out_of_memory ? container.host.fail(fault) : LW_OK;
  if (!format::parseSceneHeader(message.data(), message.size(), header, nullptr, 0)) return LW_OK;
  if (!lights.allocate(container.host, header.light_count)) return container.host.fail(LW_OUT_OF_MEMORY, "no memory for %u lights", header.light_count);
  format::parseSceneHeader(message.data(), message.size(), header, lights.data(), lights.size());
  for (format::Light& light : lights) light.name = {};
  container.scene = header;
  container.scene_is_read = true;
  return LW_OK;
}

lw_result makeContainer(const lw_config* given, lw_container** out, lw_container*& container, format::OpenOptions& options) {
  static constexpr lw_config kDefault = LW_CONFIG_INIT;
  const lw_config& config = given ? *given : kDefault;
  if (!out || config.size < sizeof(lw_config) || !config.allocate != !config.release) return LW_INVALID_ARGUMENT;
  options.allocator = {config.allocate, config.release, config.allocator_user};
  if (config.max_file_bytes) options.limits.file_bytes = config.max_file_bytes;
  if (config.max_decoded_bytes) options.limits.decoded_bytes = config.max_decoded_bytes;
  const Host host(options.allocator, config.message, config.message_user);
  container = createHandle<lw_container>(host);
  return container ? LW_OK : host.fail(LW_OUT_OF_MEMORY, "no memory for the container's handle");
}

lw_result finishOpen(lw_container* container, const format::Source& source, const format::OpenOptions& options, lw_container** out) {
  if (const format::Fault fault = container->view.open(source, options)) {
    const lw_result result = container->host.fail(fault);
    destroyHandle(container);
    return result;
  }
  if (const lw_result result = readScene(*container)) {
    destroyHandle(container);
    return result;
  }
  *out = container;
  return LW_OK;
}

}  // namespace
}  // namespace lightwell::runtime

lw_result lw_open_memory(const void* data, size_t bytes, const lw_config* config, lw_container** out) {
  if (!data) return LW_INVALID_ARGUMENT;
  lw_container* container = nullptr;
  format::OpenOptions options;
  if (const lw_result result = makeContainer(config, out, container, options)) return result;
  return finishOpen(container, format::memorySource(data, bytes), options, out);
}

lw_result lw_open_file(const char* path, const lw_config* config, lw_container** out) {
  if (!path) return LW_INVALID_ARGUMENT;
  lw_container* container = nullptr;
  format::OpenOptions options;
  if (const lw_result result = makeContainer(config, out, container, options)) return result;
  if (!container->file.open(path)) {
    const lw_result result = container->host.fail(LW_IO_ERROR, "%s: %s", path, std::strerror(errno));
    destroyHandle(container);
    return result;
  }
  return finishOpen(container, container->file.source(), options, out);
}

lw_result lw_open_reader(const lw_reader* reader, const lw_config* config, lw_container** out) {
  if (!reader || !reader->read) return LW_INVALID_ARGUMENT;
  lw_container* container = nullptr;
  format::OpenOptions options;
  if (const lw_result result = makeContainer(config, out, container, options)) return result;
  container->reader = *reader;
  format::Source source;
  source.read = [](void* user, uint64_t offset, void* destination, size_t bytes) {
    const auto& r = *static_cast<const lw_reader*>(user);
    return r.read(r.user, offset, destination, bytes) == 0;
  };
  source.user = &container->reader;
  source.bytes = reader->file_bytes;
  return finishOpen(container, source, options, out);
}

void lw_close(lw_container* container) { destroyHandle(container); }

int lw_has_section(const lw_container* container, const char* section) {
  if (!container || !section) return 0;
  const format::SectionInfo* info = container->view.findSection(section);
  return info && info->known;
}

namespace {

/// That the section scene is there and sound, or what is wrong.
lw_result checkScene(const lw_container& container) {
  if (!container.scene_is_read) {
    format::SceneHeader header;
    const lw_result result = readHeader(container, "scene", [&](const Array<uint8_t>& message) {
      return format::parseSceneHeader(message.data(), message.size(), header, nullptr, 0);
    });
    return result ? result : LW_BAD_SECTION;
  }
  const format::SceneHeader& header = container.scene;
  bool finite = allFinite(header.bounds_min_m, 3) && allFinite(header.bounds_max_m, 3);
  for (const double o : header.origin_m) finite = finite && std::isfinite(o);
  return finite ? LW_OK : container.host.fail(LW_BAD_SECTION, "scene/header: the origin or the bounds are not finite");
}

}  // namespace

lw_result lw_get_scene_info(const lw_container* container, lw_scene_info* info) {
  if (!container || !info) return LW_INVALID_ARGUMENT;
  if (const lw_result result = checkScene(*container)) return result;
  const format::SceneHeader& header = container->scene;
  lw_scene_info scene{};
  std::memcpy(scene.origin_m, header.origin_m, sizeof scene.origin_m);
  std::memcpy(scene.bounds_min_m, header.bounds_min_m, sizeof scene.bounds_min_m);
  std::memcpy(scene.bounds_max_m, header.bounds_max_m, sizeof scene.bounds_max_m);
  scene.light_count = header.light_count;
  *info = scene;
  return LW_OK;
}

lw_result lw_get_light(const lw_container* container, uint32_t index, lw_light* light) {
  if (!container || !light) return LW_INVALID_ARGUMENT;
  if (const lw_result result = checkScene(*container)) return result;
  if (index >= container->scene_lights.size()) return container->host.fail(LW_NOT_FOUND, "the scene has no light %u", index);
  const format::Light& from = container->scene_lights[index];
  if (from.type == format::LightType::unknown)
    return container->host.fail(LW_TOO_NEW, "scene/header: light %u is of an unknown type", index);
  lw_light to{};
  to.type = uint32_t(from.type);
  std::memcpy(to.position_m, from.position_m, sizeof to.position_m);
  std::memcpy(to.direction, from.direction, sizeof to.direction);
  std::memcpy(to.intensity_rgb, from.intensity_rgb, sizeof to.intensity_rgb);
  to.inner_cone_angle_rad = from.inner_cone_angle;
  to.outer_cone_angle_rad = from.outer_cone_angle;
  to.range_m = from.range_m;
  PackedLight packed;
  if (const char* reason = packLight(to, packed)) return container->host.fail(LW_BAD_SECTION, "scene/header: light %u: %s", index, reason);
  *light = to;
  return LW_OK;
}

lw_result lw_get_atlas_info(const lw_container* container, lw_atlas_info* info) {
  if (!container || !info) return LW_INVALID_ARGUMENT;
  format::AtlasHeader header;
  if (const lw_result result = readAtlasHeader(*container, header)) return result;
  *info = {header.width, header.height, header.covered_texels, header.charts, header.unwrapped ? 1u : 0u};
  return LW_OK;
}
