#include "precompute/transport/radiosity/patch_bytes.h"

#include "precompute/transport/stage_bytes.h"

namespace lightwell::transport {

Bytes patchBytes(const ExposedPatches& all) {
  const Patches& patches = all.patches;
  ByteWriter writer;
  writer.array(all.exposed);
  writer.array(patches.texels_per_side);
  writer.array(patches.first_side);
  writer.array(patches.side);
  writer.array(patches.patch_of_side);
  writer.array(patches.area);
  writer.array(patches.exposed_share);
  writer.array(patches.position);
  writer.array(patches.normal);
  writer.array(patches.material);
  return writer.take();
}

ExposedPatches readPatches(ByteView bytes, size_t sides) {
  ByteReader reader(bytes);
  ExposedPatches all;
  Patches& patches = all.patches;
  all.exposed = reader.array<float>();
  patches.texels_per_side = reader.array<uint8_t>();
  patches.first_side = reader.array<uint32_t>();
  patches.side = reader.array<uint32_t>();
  patches.patch_of_side = reader.array<uint32_t>();
  patches.area = reader.array<float>();
  patches.exposed_share = reader.array<float>();
  patches.position = reader.array<Vec3>();
  patches.normal = reader.array<Vec3>();
  patches.material = reader.array<uint32_t>();
  const size_t count = patches.area.size();
  requireRows(patches.first_side, patches.side.size());
  require(patches.first_side.size() == count + 1 && all.exposed.size() == sides && patches.patch_of_side.size() == sides);
  for (const size_t size : {patches.texels_per_side.size(), patches.exposed_share.size(), patches.position.size(), patches.normal.size(), patches.material.size()})
    require(size == count);
  for (const uint32_t side : patches.side) require(side < sides);
  for (const uint32_t patch : patches.patch_of_side) require(patch == kNone || patch < count);
  return all;
}

}  // namespace lightwell::transport
