#include "tests/format/golden_files.h"

#include <google/protobuf/message.h>

#include <functional>

#include "format/decode/endian.h"
#include "format/decode/rans.h"
#include "format/encode/compress.h"
#include "format/encode/rans_encode.h"
#include "tests/format/content.h"
#include "tests/format/environment_content.h"
#include "tests/format/forge.h"
#include "tests/format/lightmap_content.h"
#include "tests/format/prm_probes_content.h"
#include "tests/format/probes_content.h"
#include "tests/format/radiosity_content.h"
#include "tests/format/points_content.h"
#include "tests/format/vpl_content.h"

namespace lightwell::format {
namespace {

using Bytes = std::vector<uint8_t>;

std::string encoded(Codec codec, ElementType element, std::string_view data) {
  const Bytes stored = encodeWith(codec, element, {reinterpret_cast<const uint8_t*>(data.data()), data.size()}, 3);
  return {stored.begin(), stored.end()};
}

/// 64 little-endian u32: 0, 3, 6 …
std::string ramp() {
  std::string bytes(256, '\0');
  for (uint32_t i = 0; i < 64; ++i) storeLittle(reinterpret_cast<uint8_t*>(&bytes[4 * i]), 3 * i);
  return bytes;
}

/// 300 small signed bytes, of sizes that rise and fall.
std::string waves() {
  std::string bytes(300, '\0');
  for (int i = 0; i < 300; ++i) bytes[size_t(i)] = char((i * i) % 13 * (i % 100) / 60 - i % 7);
  return bytes;
}

/// One section of no version of the format, not required, with one chunk per codec.
Forge everyCodec() {
  Forge forge;
  forge.section("sample");
  forge.chunk("sample", "raw", ElementType::bytes, {5}, Codec::raw, "hello");
  forge.chunk("sample", "zstd", ElementType::u32, {64}, Codec::zstd, encoded(Codec::zstd, ElementType::u32, ramp()));
  forge.chunk("sample", "planes", ElementType::u32, {4, 16}, Codec::zstd_planes, encoded(Codec::zstd_planes, ElementType::u32, ramp()));
  forge.chunk("sample", "delta", ElementType::u32, {64}, Codec::zstd_delta_planes,
              encoded(Codec::zstd_delta_planes, ElementType::u32, ramp()));
  forge.chunk("sample", "empty", ElementType::f32, {0, 3}, Codec::raw, "");
  forge.chunk("sample", "scalar", ElementType::f32, {}, Codec::raw, std::string("\0\0\x80\x3f", 4));
  forge.chunk("sample", "rans", ElementType::i8, {300}, Codec::rans, encoded(Codec::rans, ElementType::i8, waves()));
  return forge;
}

Bytes spoilt(Bytes file, const std::function<void(Bytes&)>& edit, bool fix = true) {
  edit(file);
  if (fix) fixChecksums(file);
  return file;
}

Bytes spoiltChunk(int index, const std::function<void(v1::Chunk&)>& edit) {
  Forge forge = everyCodec();
  edit(*forge.directory.mutable_chunks(index));
  return forge.build();
}

/// The chunk "zstd" with other stored bytes.
Bytes otherFrame(std::string stored, uint64_t elements = 64) {
  Forge forge;
  forge.section("sample");
  forge.chunk("sample", "zstd", ElementType::u32, {elements}, Codec::zstd, std::move(stored));
  return forge.build();
}

/// The chunk "rans" with one part of it edited: the planes of its tables, or what follows them.
Bytes otherRans(const std::function<void(rans::Encoded&)>& edit) {
  const std::string data = waves();
  rans::Encoded coding = rans::encode({reinterpret_cast<const uint8_t*>(data.data()), data.size()});
  edit(coding);
  const std::string tables = encoded(Codec::zstd, ElementType::bytes, {reinterpret_cast<const char*>(coding.planes.data()), coding.planes.size()});
  std::string stored(4, '\0');
  storeLittle(reinterpret_cast<uint8_t*>(stored.data()), uint32_t(tables.size()));
  stored += tables;
  stored.append(coding.streams.begin(), coding.streams.end());
  Forge forge;
  forge.section("sample");
  forge.chunk("sample", "rans", ElementType::i8, {data.size()}, Codec::rans, stored);
  return forge.build();
}

std::vector<GoldenFile> validFiles() {
  Forge optional = everyCodec();
  optional.section("radiosity", 7, false);
  optional.section("prm", 9, false);
  optional.chunk("radiosity", "form_factor", ElementType(200), {1, 2, 3}, Codec(77), "of a later version");
  Content halves = panesContent();
  halves.pane_half = {0, 0x3c00, 0x7bff, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  Content opaque = panesContent();
  opaque.triangle_flags = {0, 1};
  opaque.prm.set_has_emitter(false);
  opaque.left_out = {"geometry/alpha_uv", "geometry/triangle_alpha", "geometry/alpha_material", "geometry/alpha_texture_0",
                     "atlas/emission", "prm/emitter_direct", "prm/emitter_indirect", "meta"};
  Content fields = panesContent();  // a later minor version: fields and a chunk that this one does not know, in sections that it does
  const auto addField = [](google::protobuf::Message& message) { message.GetReflection()->MutableUnknownFields(&message)->AddLengthDelimited(1000, "of a later version"); };
  addField(fields.scene);
  addField(*fields.scene.mutable_lights(0));
  addField(fields.atlas);
  addField(fields.prm);
  Writer parts = toWriter(fields);
  parts.add("prm", "later", std::vector<uint8_t>{1, 2, 3});
  return {{"valid/empty.lwc", Writer().bytes()},
          {"valid/every_codec.lwc", everyCodec().build()},
          {"valid/later_optional.lwc", optional.build()},
          {"valid/later_minor.lwc", spoilt(everyCodec().build(), [](Bytes& f) { storeLittle(&f[10], uint16_t(9)); })},
          {"valid/later_parts.lwc", parts.bytes()},
          {"valid/panes.lwc", toWriter(panesContent()).bytes()},
          {"valid/panes_half.lwc", toWriter(halves).bytes()},
          {"valid/local_bases.lwc", toWriter(localBasesContent()).bytes()},
          {"valid/prm_probes.lwc", toWriter(prmProbesContent()).bytes()},
          {"valid/opaque.lwc", toWriter(opaque).bytes()},
          {"valid/environment.lwc", toWriter(environmentContent()).bytes()},
          {"valid/sky_panes.lwc", toWriter(skyPanesContent()).bytes()},
          {"valid/radiosity.lwc", toWriter(radiosityContent()).bytes()},
          {"valid/radiosity_portals.lwc", toWriter(portalsContent()).bytes()},
          {"valid/probes.lwc", toWriter(probesContent()).bytes()},
          {"valid/lightmap.lwc", toWriter(lightmapContent()).bytes()},
          {"valid/lightmap_directional.lwc", toWriter(directionalContent()).bytes()},
          {"valid/vpl.lwc", toWriter(vplContent()).bytes()},
          {"valid/points.lwc", toWriter(pointsContent()).bytes()}};
}

std::vector<GoldenFile> invalidFiles() {
  const Bytes sound = everyCodec().build();
  const auto header = [&](auto edit) { return spoilt(sound, edit); };
  std::vector<GoldenFile> files;
  const auto add = [&](std::string name, Bytes bytes) { files.push_back({"invalid/" + name + ".lwc", std::move(bytes)}); };

  add("truncated.no_bytes", {});
  add("truncated.half_header", Bytes(sound.begin(), sound.begin() + 32));
  add("truncated.last_byte", Bytes(sound.begin(), sound.end() - 1));
  add("bad_magic.newline_translated", spoilt(sound, [](Bytes& f) { f.erase(f.begin() + 4); }, false));
  add("bad_magic.text", Bytes{'g', 'l', 'T', 'F'});
  add("too_new.major_version", header([](Bytes& f) { f[8] = 2; }));
  add("bad_header.version_zero", header([](Bytes& f) { f[8] = 0; }));
  add("bad_header.reserved_12", header([](Bytes& f) { f[13] = 1; }));
  add("bad_header.reserved_48", header([](Bytes& f) { f[55] = 1; }));
  add("bad_header.directory_elsewhere", header([](Bytes& f) { f[24] = 80; }));
  add("bad_header.directory_past_end", header([](Bytes& f) { storeLittle(&f[32], uint64_t(f.size())); }));
  add("bad_header.directory_size_wraps", header([](Bytes& f) { storeLittle(&f[32], ~uint64_t(0)); }));
  add("limit_exceeded.file_bytes", header([](Bytes& f) { storeLittle(&f[16], uint64_t(1) << 62); }));
  add("bad_checksum.header", spoilt(sound, [](Bytes& f) { f[56] ^= 1; }, false));
  add("bad_checksum.directory", spoilt(sound, [](Bytes& f) { f[70] ^= 1; }, false));
  add("bad_checksum.chunk", spoilt(sound, [](Bytes& f) { f.back() ^= 1; }, false));
  add("trailing_bytes.after_end", spoilt(sound, [](Bytes& f) { f.push_back(0); }, false));
  add("trailing_bytes.unclaimed_end", header([](Bytes& f) {
        f.push_back(0);
        storeLittle(&f[16], uint64_t(f.size()));
      }));
  add("trailing_bytes.padding", spoilt(sound, [](Bytes& f) { f[kHeaderBytes + Forge::kDirectoryBytes + 5] = 1; }, false));

  add("bad_directory.cut_field", assemble("\x0a\x7f", ""));
  add("bad_directory.endless_varint", assemble(std::string(12, '\xff'), ""));
  add("bad_directory.group", assemble("\x0b\x0c", ""));
  add("bad_directory.field_zero", assemble(std::string("\x02\x00", 2), ""));
  add("bad_directory.name_traversal", spoiltChunk(0, [](v1::Chunk& c) { c.set_name("../x"); }));
  add("bad_directory.name_empty", spoiltChunk(0, [](v1::Chunk& c) { c.set_name(""); }));
  add("bad_directory.name_long", spoiltChunk(0, [](v1::Chunk& c) { c.set_name(std::string(64, 'a')); }));
  add("bad_directory.chunk_twice", spoiltChunk(1, [](v1::Chunk& c) { c.set_name("raw"); }));
  add("bad_directory.section_undeclared", spoiltChunk(0, [](v1::Chunk& c) { c.set_section("other"); }));
  add("bad_directory.element_unset", spoiltChunk(0, [](v1::Chunk& c) { c.clear_element(); }));
  add("bad_directory.codec_unset", spoiltChunk(0, [](v1::Chunk& c) { c.clear_codec(); }));
  add("bad_directory.planes_of_bytes", spoiltChunk(0, [](v1::Chunk& c) { c.set_codec(v1::CODEC_ZSTD_PLANES); }));
  add("bad_directory.delta_of_floats", spoiltChunk(3, [](v1::Chunk& c) { c.set_element(v1::ELEMENT_TYPE_F32); }));
  add("bad_directory.rank_five", spoiltChunk(0, [](v1::Chunk& c) { for (int i = 0; i < 4; ++i) c.add_shape(1); }));
  add("bad_directory.shape_wraps", spoiltChunk(1, [](v1::Chunk& c) {
        c.set_shape(0, uint64_t(1) << 62);
        c.add_shape(16);
      }));
  Forge twice = everyCodec();
  twice.section("sample");
  add("bad_directory.section_twice", twice.build());
  Forge versionless = everyCodec();
  versionless.section("prm", 0);
  add("bad_directory.section_version_zero", versionless.build());
  Forge required = everyCodec();
  required.section("caustics", 1, true);
  add("too_new.required_section", required.build());
  Forge required_version = everyCodec();
  required_version.section("prm", 2, true);
  add("too_new.required_section_version", required_version.build());

  add("bad_chunk.offset_unaligned", spoiltChunk(6, [](v1::Chunk& c) { c.set_offset(c.offset() + 1); }));
  add("bad_chunk.overlap", spoiltChunk(2, [](v1::Chunk& c) { c.set_offset(c.offset() - 16); }));
  add("bad_chunk.inside_directory", spoiltChunk(0, [](v1::Chunk& c) { c.set_offset(64); }));
  add("bad_chunk.past_end", spoiltChunk(6, [](v1::Chunk& c) { c.set_stored_bytes(c.stored_bytes() + 1); }));
  add("bad_chunk.size_wraps", spoiltChunk(6, [](v1::Chunk& c) { c.set_stored_bytes(~uint64_t(0) - 8); }));
  Forge gap;
  gap.section("sample");
  for (const char* name : {"before", "unclaimed", "after"})
    gap.chunk("sample", name, ElementType::bytes, {16}, Codec::raw, std::string(16, name[0]));
  gap.directory.mutable_chunks()->DeleteSubrange(1, 1);
  add("trailing_bytes.gap", gap.build());
  add("bad_chunk.raw_size", spoiltChunk(0, [](v1::Chunk& c) { c.set_shape(0, 6); }));
  add("bad_chunk.frame_size", otherFrame(encoded(Codec::zstd, ElementType::u32, ramp()), 63));
  add("bad_chunk.not_zstd", otherFrame(std::string(40, 'x')));
  add("bad_chunk.two_frames", otherFrame(encoded(Codec::zstd, ElementType::u32, ramp()) + encoded(Codec::zstd, ElementType::u32, ramp())));
  std::string cut = encoded(Codec::zstd, ElementType::u32, ramp());
  cut.pop_back();
  add("bad_chunk.frame_cut", otherFrame(cut));
  add("bad_chunk.rans_tables_size", otherRans([](rans::Encoded& c) { c.planes.resize(c.planes.size() + 1); }));
  add("bad_chunk.rans_frequencies", otherRans([](rans::Encoded& c) { ++c.planes[0]; }));
  add("bad_chunk.rans_context_unused", otherRans([](rans::Encoded& c) {
        for (size_t s = 0; s < rans::kSymbols; ++s) c.planes[s] = c.planes[rans::kTableBytes / 2 + s] = 0;  // the first byte's
      }));
  add("bad_chunk.rans_first_state", otherRans([](rans::Encoded& c) { storeLittle(&c.streams[16], rans::kLeastState - 1); }));
  add("bad_chunk.rans_last_state", otherRans([](rans::Encoded& c) { storeLittle(&c.streams[16], loadLittle<uint32_t>(&c.streams[16]) ^ rans::kScale << 3); }));
  add("bad_chunk.rans_stream_odd", otherRans([](rans::Encoded& c) { ++c.streams[0]; c.streams.push_back(0); }));
  add("bad_chunk.rans_stream_short", otherRans([](rans::Encoded& c) {
        storeLittle(&c.streams[12], loadLittle<uint32_t>(&c.streams[12]) - 2);
        c.streams.resize(c.streams.size() - 2);
      }));
  add("bad_chunk.rans_stream_long", otherRans([](rans::Encoded& c) {
        storeLittle(&c.streams[12], loadLittle<uint32_t>(&c.streams[12]) + 2);
        c.streams.resize(c.streams.size() + 2);
      }));
  add("bad_chunk.rans_after_streams", otherRans([](rans::Encoded& c) { c.streams.resize(c.streams.size() + 2); }));
  add("bad_directory.rans_of_words", spoiltChunk(3, [](v1::Chunk& c) { c.set_codec(v1::CODEC_RANS); }));
  add("bad_chunk.expansion", otherFrame(encoded(Codec::zstd, ElementType::u32, ramp()), uint64_t(1) << 28));
  Content weights = panesContent();
  weights.entry_weight[0] = 0.5f;
  add("bad_section.weights", toWriter(weights).bytes());
  Content tree = localBasesContent();
  tree.tree_first_leaves[1] = 2;
  add("bad_section.prm_tree", toWriter(tree).bytes());
  Content share = localBasesContent();
  share.tree_first_share[0] = 0;
  add("bad_section.prm_share", toWriter(share).bytes());
  Content wavelet = localBasesContent();
  wavelet.link_wavelet[3] = 7;
  add("bad_section.prm_wavelet", toWriter(wavelet).bytes());
  Content rectangle = localBasesContent();
  rectangle.entry_rectangle[0] = 0x7c00;
  add("bad_section.prm_rectangle", toWriter(rectangle).bytes());
  EnvironmentContent flux = environmentContent();
  flux.flux[3] *= 2;
  add("bad_section.environment_flux", toWriter(flux).bytes());
  RadiosityContent bright = radiosityContent();
  bright.row_scale[3] *= 2;
  add("bad_section.radiosity_gain", toWriter(bright).bytes());
  RadiosityContent node = radiosityContent();
  node.link_node[1] = 11;
  add("bad_section.radiosity_node", toWriter(node).bytes());
  RadiosityContent gate = portalsContent();
  gate.gate_set[0] = 4;
  add("bad_section.radiosity_gate", toWriter(gate).bytes());
  RadiosityContent leaf = portalsContent();
  leaf.header.mutable_portals(0)->set_first_triangle(9);
  add("bad_section.radiosity_leaf", toWriter(leaf).bytes());
  ProbesContent lattice = probesContent();
  lattice.lattice_point[2] = 8;
  add("bad_section.probes_lattice", toWriter(lattice).bytes());
  ProbesContent link = probesContent();
  link.link_node[1] = 11;
  add("bad_section.probes_node", toWriter(link).bytes());
  LightmapContent texel = lightmapContent();
  texel.texel[1] = 0;
  add("bad_section.lightmap_order", toWriter(texel).bytes());
  LightmapContent gradient = directionalContent();
  gradient.indirect_gradient[4] = -128;
  add("bad_section.lightmap_gradient", toWriter(gradient).bytes());
  VplContent polygon = vplContent();
  polygon.first_vertex[3] = 2;
  add("bad_section.vpl_vertices", toWriter(polygon).bytes());
  PointsContent points = pointsContent();
  points.texel[2] = 1u << 20;
  add("bad_section.points_texel", toWriter(points).bytes());
  Content missing = panesContent();
  missing.left_out = {"atlas/source"};
  add("bad_section.chunk_missing", toWriter(missing).bytes());
  return files;
}

}  // namespace

std::vector<GoldenFile> goldenFiles() {
  std::vector<GoldenFile> files = validFiles();
  for (GoldenFile& file : invalidFiles()) files.push_back(std::move(file));
  return files;
}

}  // namespace lightwell::format
