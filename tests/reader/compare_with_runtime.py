"""The Python reader of samples/reader against the C runtime, on the golden containers: the same refusals, the same values bit for bit. What no public function of the runtime shows comes
from decoded_values.

  compare_with_runtime.py LIBLIGHTWELL.so DECODED_VALUES GOLDEN_FOLDER READER_FOLDER
"""
import ctypes
import math
import pathlib
import struct
import subprocess
import sys
from ctypes import POINTER, Structure, byref, c_char, c_double, c_float, c_int32, c_size_t, c_uint16, c_uint32, c_uint64, c_uint8, c_void_p

library, program, golden = ctypes.CDLL(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
sys.path.insert(0, sys.argv[4])
from container import Container, ContainerError  # noqa: E402
from decoded import decoded, f32  # noqa: E402
from messages import ALPHA_MATERIALS, HEADERS, parse  # noqa: E402
from sections import NONE, check  # noqa: E402

library.lw_result_name.restype = library.lw_radiosity_material_name.restype = ctypes.c_char_p
failures, compared = [], 0


class SceneInfo(Structure):
    _fields_ = [("origin", c_double * 3), ("bounds_min", c_float * 3), ("bounds_max", c_float * 3), ("light_count", c_uint32)]


class Light(Structure):
    _fields_ = [("type", c_uint32), ("position", c_float * 3), ("direction", c_float * 3), ("intensity", c_float * 3), ("inner_cone_angle", c_float),
                ("outer_cone_angle", c_float), ("range", c_float)]


class AtlasInfo(Structure):
    _fields_ = [(name, c_uint32) for name in ("width", "height", "covered_texels", "charts", "unwrapped")]


class ArrayInfo(Structure):
    _fields_ = [("elements", c_uint64), ("components", c_uint32), ("component_bytes", c_uint32), ("bytes", c_size_t)]


class AlphaMaterial(Structure):
    _fields_ = [("mode", c_uint32), ("cutoff", c_float), ("factor", c_float), ("texture", c_int32), ("wrap_u", c_uint32), ("wrap_v", c_uint32),
                ("width", c_uint32), ("height", c_uint32)]


class PrmInfo(Structure):
    _fields_ = [(name, c_uint32) for name in ("layout", "entries", "clusters", "texels", "blocks", "max_rank", "brightest", "has_emitter", "has_sky", "width", "height")]


class PrmEntries(Structure):
    _fields_ = [("position", POINTER(c_float)), ("normal", POINTER(c_float)), ("weight", POINTER(c_float)), ("first", POINTER(c_uint32))]


class RadiosityInfo(Structure):
    _fields_ = [(name, c_uint32) for name in ("patches", "nodes", "links", "texels", "materials", "portals", "gates", "has_emission", "has_backs", "width", "height")]


class RadiosityPortal(Structure):
    _fields_ = [("name", ctypes.c_char_p)] + [(name, c_uint32) for name in ("first_gate", "strips", "first_triangle", "triangles")] + [("axis", c_float * 3), ("offset", c_float)]


class RadiosityPatches(Structure):
    _fields_ = [("area", POINTER(c_float)), ("position", POINTER(c_float)), ("normal", POINTER(c_float)), ("albedo", POINTER(c_float)),
                ("emission", POINTER(c_float)), ("material", POINTER(c_uint16))]


class RadiosityTexels(Structure):
    _fields_ = [("texel", POINTER(c_uint32)), ("patch", POINTER(c_uint32)), ("weight", POINTER(c_uint8)), ("exposed", POINTER(c_uint8)), ("back", POINTER(c_uint32))]


class LightmapShading(Structure):
    _fields_ = [("size", c_size_t), ("light", c_uint32), ("fill", c_uint32)]


class VirtualLightsInfo(Structure):
    _fields_ = [("lights", c_uint32), ("sources", c_uint32)]


class ProbesInfo(Structure):
    _fields_ = [("probes", c_uint32), ("lattice_probes", c_uint32), ("links", c_uint32), ("lattice_count", c_uint32 * 3), ("lattice_first", c_float * 3), ("lattice_spacing", c_float),
                ("position", POINTER(c_float))]


class VirtualLight(Structure):
    _fields_ = [("type", c_uint32), ("source", c_uint32), ("bounce", c_uint32), ("position", c_float * 3), ("normal", c_float * 3), ("flux", c_float * 3),
                ("radius", c_float), ("area", c_float), ("vertex_count", c_uint32), ("vertices", POINTER(c_float))]


class PointsInfo(Structure):
    _fields_ = [("points", c_uint32), ("area", c_float), ("position", POINTER(c_float)), ("normal", POINTER(c_float)), ("texel", POINTER(c_uint32))]


class EnvironmentCells(Structure):
    _fields_ = [(name, POINTER(c_float)) for name in ("direction", "flux", "solid_angle", "cos_radius", "spread", "covariance", "tangent")]


class Estimate(Structure):
    _fields_ = [("value", c_double), ("low", c_double), ("high", c_double)]


class MeasuredError(Structure):
    _fields_ = [("section", c_char * 64), ("against", c_char * 256)] + [(n, Estimate) for n in ("relrmse", "texrel", "bias", "maximum")] + [("seconds", c_double), ("texels", c_uint32)]


def decoded_values(file):
    """The arrays that decoded_values writes, by name."""
    output, at, arrays = subprocess.run([program, file], check=True, capture_output=True).stdout, 0, {}
    while at < len(output):
        end = output.index(b"\n", at)
        name, kind, count = output[at:end].decode().split()
        arrays[name] = struct.unpack_from(f"={count}{kind}", output, end + 1)
        at = end + 1 + int(count) * struct.calcsize("=" + kind)
    return arrays


def name_of(result):
    name = library.lw_result_name(c_int32(result)).decode()
    return "ok" if name == "LW_OK" else name.removeprefix("LW_").lower()


class Comparison:
    def __init__(self, file):
        self.place, self.data = f"{file.parent.name}/{file.name}", file.read_bytes()
        self.handle = c_void_p()
        self.opened = name_of(library.lw_open_memory(self.data, c_size_t(len(self.data)), None, byref(self.handle)))

    def same(self, what, ours, theirs, tolerance=0.0):
        """Sequences of numbers; bits, unless a relative tolerance is given."""
        global compared
        ours, theirs = list(ours), list(theirs)
        compared += len(ours)
        equal = len(ours) == len(theirs) and (ours == theirs if tolerance == 0 else all(math.isclose(a, b, rel_tol=tolerance, abs_tol=1e-30) for a, b in zip(ours, theirs)))
        if not equal:
            failures.append(f"{self.place}: {what}: {ours[:8]} here, {theirs[:8]} in the runtime")

    def inside(self, section, pairs, tolerance=0.0):
        """Values of the reader against arrays of decoded_values, {its name: values}; an array that is missing there is a failure, too."""
        for name, values in pairs.items():
            self.same(f"{section}/{name}", values, self.dump.pop(f"{section}.{name}", ()), tolerance)

    def load(self, function, *more):
        handle = c_void_p()
        result = getattr(library, function)(self.handle, *more, byref(handle))
        if result:
            failures.append(f"{self.place}: {function}: {name_of(result)}")
        return handle if result == 0 else None

    def get(self, function, structure, *arguments):
        value = structure()
        if getattr(library, function)(*arguments, byref(value)):
            failures.append(f"{self.place}: {function} fails")
        return value

    def values(self, section, name):
        return self.container.values(self.container.sections[section].chunks[name])

    def header(self, section):
        return parse(HEADERS[section], self.values(section, "header"))

    def run(self, file):
        self.container = Container(self.data)
        check(self.container)
        self.dump = decoded_values(file)
        for chunk in self.container.chunks:
            if chunk.decodable:
                self.same(chunk.place, self.container.decode(chunk), self.dump.pop(chunk.place, ()))
        for name, section in self.container.sections.items():
            if section.known:
                getattr(self, name)(section.chunks)
        if self.dump:
            failures.append(f"{self.place}: not compared: {', '.join(self.dump)}")

    # ---- one method per section

    def array(self, number, kind, section, name, expected):
        info = self.get("lw_get_array_info", ArrayInfo, self.handle, number)
        buffer = ctypes.create_string_buffer(info.bytes)
        if library.lw_decode_array(self.handle, number, buffer, info.bytes):
            failures.append(f"{self.place}: {section}/{name} does not decode")
        self.same(f"{section}/{name}", expected, struct.unpack(f"={info.bytes // struct.calcsize(kind)}{kind}", buffer.raw))

    def arrays(self, section, names):
        """{lw_array: (its struct kind, the chunk)}."""
        _, values = decoded(self.container, section)
        for number, (kind, name) in names.items():
            if name in values:
                self.array(number, kind, section, name, values[name])

    def meta(self, _):
        kinds = ("relrmse", "texrel", "bias", "maximum")
        for i, error in enumerate(self.header("meta")["errors"]):
            e = self.get("lw_get_measured_error", MeasuredError, self.handle, None, i)
            self.same("meta errors", [error[k + suffix] for k in kinds for suffix in ("", "_low", "_high")] + [error["seconds"], error["texels"]],
                      [v for k in kinds for v in (getattr(e, k).value, getattr(e, k).low, getattr(e, k).high)] + [e.seconds, e.texels])
            self.same("meta error's texts", [error["section"].encode(), error["against"].encode()], [e.section, e.against])

    def scene(self, _):
        h, info = self.header("scene"), self.get("lw_get_scene_info", SceneInfo, self.handle)
        self.same("scene", h["origin"] + h["bounds_min"] + h["bounds_max"] + [len(h["lights"])], [*info.origin, *info.bounds_min, *info.bounds_max, info.light_count])
        for i, l in enumerate(h["lights"]):
            light = self.get("lw_get_light", Light, self.handle, i)
            self.same(f"light {i}", [l["type"], *l["position"], *l["direction"], *l["intensity"], l["inner_cone_angle"], l["outer_cone_angle"], l["range"]],
                      [light.type, *light.position, *light.direction, *light.intensity, light.inner_cone_angle, light.outer_cone_angle, light.range])

    def geometry(self, chunks):
        self.arrays("geometry", {1: ("f", "position"), 2: ("f", "normal"), 3: ("f", "lightmap_uv"), 4: ("I", "index"), 5: ("B", "triangle_flags"), 6: ("f", "alpha_uv"), 7: ("H", "triangle_alpha")})
        if "alpha_material" not in chunks:
            return
        for i, m in enumerate(parse(ALPHA_MATERIALS, self.values("geometry", "alpha_material"))["materials"]):
            got = self.get("lw_get_alpha_material", AlphaMaterial, self.handle, i)
            texture = -1 if m["texture"] is None else m["texture"]
            height, width = (0, 0) if texture < 0 else chunks[f"alpha_texture_{texture}"].shape
            self.same("alpha material", [m["mode"], m["cutoff"], m["factor"], texture, m["wrap_u"], m["wrap_v"], width, height], [getattr(got, name) for name, _ in AlphaMaterial._fields_])
            if texture >= 0:
                buffer = ctypes.create_string_buffer(got.width * got.height)
                library.lw_decode_alpha_texture(self.handle, texture, buffer, c_size_t(len(buffer)))
                self.same("alpha texture", self.values("geometry", f"alpha_texture_{texture}"), buffer.raw)

    def atlas(self, _):
        h, info = self.header("atlas"), self.get("lw_get_atlas_info", AtlasInfo, self.handle)
        self.same("atlas", [int(h[name]) for name, _ in AtlasInfo._fields_], [getattr(info, name) for name, _ in AtlasInfo._fields_])
        self.arrays("atlas", {16: ("I", "source"), 17: ("B", "coverage"), 18: ("B", "albedo"), 19: ("f", "emission")})

    def prm(self, _):
        prm = self.load("lw_prm_load")
        if not prm:
            return
        (h, values), info = decoded(self.container, "prm"), self.get("lw_prm_get_info", PrmInfo, prm)
        names = ("layout", "entries", "clusters", "texels", "blocks", "max_rank", "brightest", "has_emitter", "has_sky")
        self.same("prm", [min(int(h[name]), 2) if name == "layout" else int(h[name]) for name in names], [getattr(info, name) for name in names])
        entries, n = self.get("lw_prm_get_entries", PrmEntries, prm), h["entries"]
        for name, got in (("entry_position", entries.position[:3 * n]), ("entry_normal", entries.normal[:3 * n]), ("entry_weight", entries.weight[:n]),
                          ("cluster_first_entry", entries.first[:h["clusters"] + 1])):
            self.same("prm/" + name, values[name], got)
        library.lw_prm_release(prm)
        self.inside("prm", {"source": self.values("atlas", "source"), "texel": values["texel"]})
        self.inside("prm", {name: values.get(name, []) for name in ("emitter_direct", "emitter_indirect", "sky_direct", "sky_indirect")})
        if h["layout"] == 1:
            return self.inside("prm", {"pane": values["pane"]})
        self.inside("prm", {name: values[name] for name in ("entry_rectangle", "block_first_texel", "block_rank", "basis", "coefficient_scale")})
        self.transport(h["clusters"], values)

    def prm_probes(self, _):
        _, values = decoded(self.container, "prm_probes")
        names = ("position", "block_rank", "basis", "coefficient_scale", "block_first_link", "link_wavelet", "coefficient")
        self.inside("prm_probes", {**{name: values[name] for name in names}, "emitter": values.get("emitter", [])})

    def transport(self, clusters, values):
        """Clusters to wavelets, with the last bit of the C library's exp2, and the integers between wavelets and blocks."""
        wavelets_of_clusters, sums_of_wavelets, children = [], [], values["tree_children"]
        for cluster in range(clusters):
            mean, difference = [0.0] * (2 * clusters - 1), [0.0] * (clusters - 1)
            mean[cluster] = 1.0
            for node in reversed(range(clusters - 1)):
                first, second, share = mean[children[2 * node]], mean[children[2 * node + 1]], values["tree_first_share"][node] / 65536
                mean[clusters + node], difference[node] = f32(f32(share * first) + f32((1 - share) * second)), f32(first - second)
            wavelets_of_clusters += [f32(v / unit) for v, unit in zip(mean + difference, values["unit"])]
        ranks, first_link, at = values["block_rank"], values["block_first_link"], [0]
        for j, rank in enumerate(ranks):
            at.append(at[j] + 3 * rank * (first_link[j + 1] - first_link[j]))
        for wavelet in range(3 * clusters - 2):
            for j, rank in enumerate(ranks):
                links = [k for k in range(first_link[j + 1] - first_link[j]) if values["link_wavelet"][first_link[j] + k] == wavelet]
                sums_of_wavelets += [sum(values["coefficient"][at[j] + 3 * rank * k + i] for k in links) for i in range(3 * rank)]
        self.inside("prm", {"wavelets_of_clusters": wavelets_of_clusters}, 2e-7)
        self.inside("prm", {"sums_of_wavelets": sums_of_wavelets})

    def environment(self, _):
        environment = self.load("lw_environment_load")
        if not environment:
            return
        (h, values), cells = decoded(self.container, "environment"), self.get("lw_environment_get_cells", EnvironmentCells, environment)
        for name, count in (("direction", 3), ("flux", 3), ("solid_angle", 1), ("spread", 1), ("covariance", 3)):
            self.same(f"environment/cell_{name}", values["cell_" + name], getattr(cells, name)[:count * h["cells"]])
        self.inside("environment", {"counts": [h["cells"], h["suns"], h["face_cells"]], "sky_flux": h["sky_flux"], "radiance_sh": h["radiance_sh"],
                                    "tangent": values["tangent"], "mass": values["mass"]})
        self.inside("environment", {"cos_radius": [f32(1 - f32(v * f32(1 / (2 * math.pi)))) for v in values["cell_solid_angle"]]})
        self.reflections(environment, h, values["mass"])
        library.lw_environment_release(environment)

    def reflections(self, environment, header, mass):
        """Where the nodes lie: integrals of radiance times a wide lobe, as exact as so few nodes allow."""
        m, node = header["face_cells"], 0
        directions = []
        for face in range(6):
            for j in range(m + 1):
                for i in range(m + 1):
                    d = [0.0, 0.0, 0.0]
                    d[face // 2] = 1.0 - 2 * (face % 2)
                    for k, at in ((1, i), (2, j)):
                        d[(face // 2 + k) % 3] = math.tan((2 * at / m - 1) * math.pi / 4)
                    directions.append([v / math.sqrt(sum(c * c for c in d)) for v in d])
        visibility = (c_float * header["cells"])(*([0.0] * header["suns"] + [1.0] * (header["cells"] - header["suns"])))
        for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 0, 0), (0, -1, 0), (0, 0, -1), (0.6, 0, 0.8), (-0.6, 0.8, 0)):
            rgb, mirror = (c_float * 3)(), (c_float * 3)(*axis)
            if library.lw_environment_phong(environment, mirror, c_float(2), visibility, rgb):
                failures.append(f"{self.place}: lw_environment_phong fails")
            lobes = [max(0.0, sum(a * b for a, b in zip(axis, d))) ** 2 for d in directions]
            self.same(f"environment reflected about {axis}", [sum(mass[3 * n + k] * lobe for n, lobe in enumerate(lobes)) for k in range(3)], rgb, 0.01)

    def radiosity(self, _):
        radiosity = self.load("lw_radiosity_load")
        if not radiosity:
            return
        (h, values), info = decoded(self.container, "radiosity"), self.get("lw_radiosity_get_info", RadiosityInfo, radiosity)
        p, t, gates = h["patches"], h["texels"], sum(portal["strips"] for portal in h["portals"])
        self.same("radiosity", [p, values["level_first"][-1], len(values["link_node"]), t, len(h["materials"]), len(h["portals"]), gates, h["has_emission"], h["has_backs"]],
                  [getattr(info, name) for name, _ in RadiosityInfo._fields_[:9]])
        for i, material in enumerate(h["materials"]):
            self.same("material", [material["name"].encode()], [library.lw_radiosity_material_name(radiosity, i)])
        for i, portal in enumerate(h["portals"]):
            got = self.get("lw_radiosity_get_portal", RadiosityPortal, radiosity, i)
            self.same("portal", [portal["name"].encode(), portal["first_gate"], portal["strips"], portal["first_triangle"], portal["triangles"], *(portal["axis"] or [0, 0, 0]), portal["offset"]],
                      [got.name, got.first_gate, got.strips, got.first_triangle, got.triangles, *got.axis, got.offset])
        patches = self.get("lw_radiosity_get_patches", RadiosityPatches, radiosity)
        for name, count in (("area", 1), ("position", 3), ("normal", 3), ("albedo", 3), ("emission", 3), ("material", 1)):
            self.same(f"radiosity/patch_{name}", values.get("patch_" + name, [0] * count * p), getattr(patches, name)[:count * p])
        texels = self.get("lw_radiosity_get_texels", RadiosityTexels, radiosity)
        for name, got in (("texel", texels.texel[:t]), ("texel_patch", texels.patch[:4 * t]), ("texel_weight", texels.weight[:4 * t]), ("texel_exposed", texels.exposed[:t]),
                          ("texel_back_patch", texels.back[:t] if texels.back else [])):
            self.same(f"radiosity/{name}", values.get(name, []), got)
        library.lw_radiosity_release(radiosity)
        self.inside("radiosity", {"source": self.values("atlas", "source")})
        self.inside("radiosity", {name: values.get(name, []) for name in ("level_first", "link_first", "link_node", "link_weight", "link_gates", "row_scale", "gate_set_first", "gate_set")})
        self.inside("radiosity", {"node_share": values["node_share"] + values["top_area"]}, 1e-7)

    def probes(self, _):
        radiosity = self.load("lw_radiosity_load")
        probes = self.load("lw_probes_load", radiosity)
        if not probes:
            return
        (h, values), info = decoded(self.container, "probes"), self.get("lw_probes_get_info", ProbesInfo, probes)
        n, lattice = h["lattice_probes"] + h["points"], h["lattice_count"] or [0, 0, 0]
        self.same("probes", [n, h["lattice_probes"], len(values["link_node"]), *lattice, *(h["lattice_first"] or [0, 0, 0]), h["lattice_spacing"]],
                  [info.probes, info.lattice_probes, info.links, *info.lattice_count, *info.lattice_first, info.lattice_spacing])
        self.same("probes/position", values["position"], info.position[:3 * n])
        library.lw_probes_release(probes)
        library.lw_radiosity_release(radiosity)
        self.inside("probes", {name: values.get(name, []) for name in ("nearness", "scale", "link_first", "link_node", "link_weight", "link_gates", "gate_set_first", "gate_set")})
        at_point = [NONE] * math.prod(lattice)
        for probe, point in enumerate(values.get("lattice_point", [])):
            at_point[point] = probe
        self.inside("probes", {"at_point": at_point, "offset": values.get("offset", [])})

    def lightmap(self, _):
        lightmap = self.load("lw_lightmap_load")
        if not lightmap:
            return
        (h, values), atlas = decoded(self.container, "lightmap"), self.header("atlas")
        texels = atlas["width"] * atlas["height"]
        for bit, kind in ((1, "direct"), (2, "indirect")):
            light, gradient = [0.0] * (4 * texels), [0.0] * (3 * texels)
            for i, texel in enumerate(values["texel"]):
                light[4 * texel:4 * texel + 4] = [*(values[kind][3 * i:3 * i + 3] if h["has_" + kind] else (0, 0, 0)), 1.0]
                if h[f"has_{kind}_gradient"]:
                    gradient[3 * texel:3 * texel + 3] = [f32(f32(4 / 127) * v) for v in values[kind + "_gradient"][3 * i:3 * i + 3]]
            shading = LightmapShading(ctypes.sizeof(LightmapShading), bit, 0)
            for function, expected in ((library.lw_lightmap_shade, light), (library.lw_lightmap_shade_gradients, gradient)):
                got = (c_float * len(expected))()
                if function(lightmap, byref(shading), got):
                    failures.append(f"{self.place}: shading a light map fails")
                self.same(f"lightmap/{kind}", expected, got)
        library.lw_lightmap_release(lightmap)
        self.inside("lightmap", {"source": self.values("atlas", "source"), "texel": values["texel"]})

    def vpl(self, _):
        lights = self.load("lw_virtual_lights_load")
        if not lights:
            return
        h, values = decoded(self.container, "vpl")
        first, info = values["first_vertex"], self.get("lw_virtual_lights_get_info", VirtualLightsInfo, lights)
        self.same("vpl", [h["lights"], h["sources"]], [info.lights, info.sources])
        for i in range(h["lights"]):
            light = self.get("lw_virtual_lights_get", VirtualLight, lights, i)
            self.same(f"virtual light {i}", [values[name][i] for name in ("type", "source", "bounce", "radius")], [light.type, light.source, light.bounce, light.radius])
            for name in ("position", "normal", "flux"):
                self.same(f"virtual light {i} {name}", values[name][3 * i:3 * i + 3], getattr(light, name))
            self.same(f"virtual light {i} vertices", values.get("vertex", [])[3 * first[i]:3 * first[i + 1]], light.vertices[:3 * light.vertex_count] if light.vertex_count else [])
        library.lw_virtual_lights_release(lights)

    def points(self, _):
        points = self.load("lw_points_load")
        if not points:
            return
        (h, values), info = decoded(self.container, "points"), self.get("lw_points_get_info", PointsInfo, points)
        n = h["points"]
        self.same("points", [n, h["area"]], [info.points, info.area])
        for name, got in (("position", info.position[:3 * n]), ("normal", info.normal[:3 * n]), ("texel", info.texel[:n])):
            self.same("points/" + name, values[name], got)
        library.lw_points_release(points)


FOUND_IN_CHUNKS = {"bad_checksum.chunk", "trailing_bytes.padding", "bad_chunk.frame_cut", "bad_chunk.frame_size", "bad_chunk.not_zstd", "bad_chunk.two_frames"}
files = sorted(golden.glob("**/*.lwc"))
for file in files:
    comparison, wanted = Comparison(file), file.name.split(".")[0] if file.parent.name == "invalid" else "ok"
    try:
        comparison.run(file)
        status = "ok"
    except ContainerError as error:
        status = error.status
    if status != wanted:
        failures.append(f"{comparison.place}: {status}, not {wanted}")
    # Header and directory are judged on opening, by both; the rest when a chunk is read.
    name = file.name.removesuffix(".lwc")
    opened = "ok" if wanted == "bad_section" or name in FOUND_IN_CHUNKS or name.startswith("bad_chunk.rans_") else wanted
    if comparison.opened != opened:
        failures.append(f"{comparison.place}: the runtime says {comparison.opened}")
    library.lw_close(comparison.handle)
for failure in failures:
    print(failure)
print(f"{len(files)} files, {compared} values compared, {len(failures)} differences")
sys.exit(1 if failures or compared < 1000 else 0)
