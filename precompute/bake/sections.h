// The sections of a container from the things of the bake. Element types and meanings: docs/format.md.
#pragma once
#include <string>
#include <vector>

#include "format/encode/writer.h"
#include "lightwell/v1/container.pb.h"
#include "precompute/atlas/atlas.h"
#include "precompute/bake/sky_tasks.h"
#include "precompute/bake/vpl_tasks.h"
#include "precompute/plan/settings.h"
#include "precompute/scene/scene.h"
#include "precompute/transport/environment/environment.h"
#include "precompute/transport/lightmap/bake_lightmap.h"
#include "precompute/transport/many_lights/surface_points.h"
#include "precompute/transport/prm/prm.h"
#include "precompute/transport/radiosity/bake_probes.h"
#include "precompute/transport/radiosity/radiosity.h"

namespace lightwell::bake {

void addSceneSection(format::Writer& writer, const scene::Scene& scene);
/// `scene` as buildAtlas left it: one vertex per atlas.uv.
void addGeometrySection(format::Writer& writer, const scene::Scene& scene, const atlas::Atlas& atlas);
void addAtlasSection(format::Writer& writer, const atlas::Atlas& atlas);
/// `metres_per_unit` of the scene. The fit has quantised the transport.
void addPrmSection(format::Writer& writer, const transport::PrmResult& prm, const SkyPanes& sky, double metres_per_unit);
/// `placement` is how the map was read: --exact answers need it again.
void addEnvironmentSection(format::Writer& writer, const transport::Environment& environment, const plan::EnvironmentPlacement& placement);
/// `scene`: its materials' names and its unit of length.
void addRadiositySection(format::Writer& writer, const transport::RadiosityResult& radiosity, const scene::Scene& scene);
/// `metres_per_unit` of the scene.
void addProbesSection(format::Writer& writer, const transport::ProbeResult& probes, double metres_per_unit);
/// Every number is rounded here to nine bits and a shared exponent.
void addLightmapSection(format::Writer& writer, const transport::Lightmap& lightmap, const atlas::Atlas& atlas);
/// `scene`: its lights and its unit of length. There is at least one virtual light.
void addVplSection(format::Writer& writer, const VplResult& vpl, const scene::Scene& scene);
/// `scene`: its bounds and its unit of length. There is at least one point.
void addPointsSection(format::Writer& writer, const transport::SurfacePoints& surface, const scene::Scene& scene);
/// Of at least one probe.
void addPrmProbesSection(format::Writer& writer, const transport::PrmProbes& probes, double metres_per_unit);
void addMetaSection(format::Writer& writer, const v1::MetaHeader& header);

}  // namespace lightwell::bake
