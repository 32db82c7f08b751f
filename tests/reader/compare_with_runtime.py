"""The Python reader of samples/reader against the C runtime, on the golden containers: the same refusals, the same values bit for bit.

  compare_with_runtime.py LIBLIGHTWELL.so GOLDEN_FOLDER READER_FOLDER
"""
import ctypes
import pathlib
import struct
import sys
from ctypes import POINTER, Structure, byref, c_char, c_double, c_float, c_int32, c_size_t, c_uint16, c_uint32, c_uint64, c_uint8, c_void_p

library, golden, reader = ctypes.CDLL(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
sys.path.insert(0, reader)
from container import Container, ContainerError, rgb9e5  # noqa: E402
from messages import ALPHA_MATERIALS, HEADERS, parse  # noqa: E402
from sections import NONE, check, octahedral  # noqa: E402

library.lw_result_name.restype = ctypes.c_char_p
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


class RadiosityPatches(Structure):
    _fields_ = [("area", POINTER(c_float)), ("position", POINTER(c_float)), ("normal", POINTER(c_float)), ("albedo", POINTER(c_float)),
                ("emission", POINTER(c_float)), ("material", POINTER(c_uint16))]


class RadiosityTexels(Structure):
    _fields_ = [("texel", POINTER(c_uint32)), ("patch", POINTER(c_uint32)), ("weight", POINTER(c_uint8)), ("exposed", POINTER(c_uint8)), ("back", POINTER(c_uint32))]


class LightmapShading(Structure):
    _fields_ = [("size", c_size_t), ("light", c_uint32), ("fill", c_uint32)]


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


def float32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def name_of(result):
    name = library.lw_result_name(c_int32(result)).decode()
    return "ok" if name == "LW_OK" else name.removeprefix("LW_").lower()


class Comparison:
    def __init__(self, file):
        self.place, self.data = f"{file.parent.name}/{file.name}", file.read_bytes()
        self.handle = c_void_p()
        self.opened = name_of(library.lw_open_memory(self.data, c_size_t(len(self.data)), None, byref(self.handle)))

    def same(self, what, ours, theirs, tolerance=0.0):
        """Sequences of numbers; bits, unless a tolerance is given."""
        global compared
        ours, theirs = list(ours), list(theirs)
        compared += len(ours)
        equal = len(ours) == len(theirs) and (ours == theirs if tolerance == 0 else all(abs(a - b) <= tolerance for a, b in zip(ours, theirs)))
        if not equal:
            failures.append(f"{self.place}: {what}: {ours[:8]} here, {theirs[:8]} in the runtime")

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

    def normals(self, section, name):
        packed = self.values(section, name)
        return [v for x, y in zip(packed[::2], packed[1::2]) for v in octahedral(x, y)]

    def run(self):
        self.container = Container(self.data)
        check(self.container)
        for name, section in self.container.sections.items():
            if section.known:
                getattr(self, name)(section.chunks)

    # ---- one method per section

    def array(self, number, kind, section, name, expected=None, tolerance=0.0):
        info = self.get("lw_get_array_info", ArrayInfo, self.handle, number)
        buffer = ctypes.create_string_buffer(info.bytes)
        if library.lw_decode_array(self.handle, number, buffer, info.bytes):
            failures.append(f"{self.place}: {section}/{name} does not decode")
        got = struct.unpack(f"={info.bytes // struct.calcsize(kind)}{kind}", buffer.raw)
        self.same(f"{section}/{name}", self.values(section, name) if expected is None else expected, got, tolerance)

    def meta(self, _):
        for i, error in enumerate(self.header("meta")["errors"]):
            e = self.get("lw_get_measured_error", MeasuredError, self.handle, None, i)
            self.same("meta errors", [error[k + suffix] for k in ("relrmse", "texrel", "bias", "maximum") for suffix in ("", "_low", "_high")],
                      [v for k in ("relrmse", "texrel", "bias", "maximum") for v in (getattr(e, k).value, getattr(e, k).low, getattr(e, k).high)])
            self.same("meta error's section", error["section"].encode(), e.section)

    def scene(self, _):
        h, info = self.header("scene"), self.get("lw_get_scene_info", SceneInfo, self.handle)
        self.same("scene", h["origin"] + h["bounds_min"] + h["bounds_max"] + [len(h["lights"])], [*info.origin, *info.bounds_min, *info.bounds_max, info.light_count])
        for i, l in enumerate(h["lights"]):
            light = self.get("lw_get_light", Light, self.handle, i)
            self.same(f"light {i}", [l["type"], *l["position"], *l["direction"], *l["intensity"], l["inner_cone_angle"], l["outer_cone_angle"], l["range"]],
                      [light.type, *light.position, *light.direction, *light.intensity, light.inner_cone_angle, light.outer_cone_angle, light.range])

    def geometry(self, chunks):
        self.array(1, "f", "geometry", "position")
        self.array(2, "f", "geometry", "normal", self.normals("geometry", "normal"), 3e-7)
        self.array(3, "f", "geometry", "lightmap_uv")
        self.array(4, "I", "geometry", "index")
        self.array(5, "B", "geometry", "triangle_flags")
        if "alpha_material" not in chunks:
            return
        self.array(6, "f", "geometry", "alpha_uv")
        self.array(7, "H", "geometry", "triangle_alpha")
        for i, m in enumerate(parse(ALPHA_MATERIALS, self.values("geometry", "alpha_material"))["materials"]):
            got = self.get("lw_get_alpha_material", AlphaMaterial, self.handle, i)
            texture = -1 if m["texture"] is None else m["texture"]
            self.same("alpha material", [m["mode"], m["cutoff"], m["factor"], texture], [got.mode, got.cutoff, got.factor, got.texture])
            if texture >= 0:
                buffer = ctypes.create_string_buffer(got.width * got.height)
                library.lw_decode_alpha_texture(self.handle, texture, buffer, c_size_t(len(buffer)))
                self.same("alpha texture", self.values("geometry", f"alpha_texture_{texture}"), buffer.raw)

    def atlas(self, chunks):
        h, info = self.header("atlas"), self.get("lw_get_atlas_info", AtlasInfo, self.handle)
        self.same("atlas", [int(h[name]) for name, _ in AtlasInfo._fields_], [getattr(info, name) for name, _ in AtlasInfo._fields_])
        self.array(16, "I", "atlas", "source")
        self.array(17, "B", "atlas", "coverage")
        self.array(18, "B", "atlas", "albedo")
        if "emission" in chunks:
            self.array(19, "f", "atlas", "emission", [v for p in self.values("atlas", "emission") for v in rgb9e5(p)])

    def prm(self, _):
        prm = self.load("lw_prm_load")
        if not prm:
            return
        h, info = self.header("prm"), self.get("lw_prm_get_info", PrmInfo, prm)
        names = ("entries", "clusters", "texels", "blocks", "max_rank", "brightest", "has_emitter", "has_sky")
        self.same("prm", [int(h[name]) for name in names], [getattr(info, name) for name in names])
        entries, n = self.get("lw_prm_get_entries", PrmEntries, prm), h["entries"]
        self.same("prm/entry_position", self.values("prm", "entry_position"), entries.position[:3 * n])
        self.same("prm/entry_normal", self.normals("prm", "entry_normal"), entries.normal[:3 * n], 3e-7)
        self.same("prm/entry_weight", self.values("prm", "entry_weight"), entries.weight[:n])
        self.same("prm/cluster_first_entry", self.values("prm", "cluster_first_entry"), entries.first[:h["clusters"] + 1])
        library.lw_prm_release(prm)

    def environment(self, _):
        environment = self.load("lw_environment_load")
        if not environment:
            return
        cells, n = self.get("lw_environment_get_cells", EnvironmentCells, environment), self.header("environment")["cells"]
        for name, count in (("direction", 3), ("flux", 3), ("solid_angle", 1), ("spread", 1), ("covariance", 3)):
            self.same(f"environment/cell_{name}", self.values("environment", "cell_" + name), getattr(cells, name)[:count * n])
        library.lw_environment_release(environment)

    def radiosity(self, chunks):
        radiosity = self.load("lw_radiosity_load")
        if not radiosity:
            return
        h = self.header("radiosity")
        p, t = h["patches"], h["texels"]
        patches = self.get("lw_radiosity_get_patches", RadiosityPatches, radiosity)
        for name, count in (("area", 1), ("position", 3), ("albedo", 3), ("material", 1)):
            self.same(f"radiosity/patch_{name}", self.values("radiosity", "patch_" + name), getattr(patches, name)[:count * p])
        self.same("radiosity/patch_normal", self.normals("radiosity", "patch_normal"), patches.normal[:3 * p], 3e-7)
        if h["has_emission"]:
            self.same("radiosity/patch_emission", [v for e in self.values("radiosity", "patch_emission") for v in rgb9e5(e)], patches.emission[:3 * p])
        texels = self.get("lw_radiosity_get_texels", RadiosityTexels, radiosity)
        self.same("radiosity/texel", self.values("radiosity", "texel"), texels.texel[:t])
        self.same("radiosity/texel_patch", self.values("radiosity", "texel_patch"), texels.patch[:4 * t])
        self.same("radiosity/texel_weight", self.values("radiosity", "texel_weight"), texels.weight[:4 * t])
        self.same("radiosity/texel_exposed", self.values("radiosity", "texel_exposed"), texels.exposed[:t])
        if "probes" in self.container.sections:
            probes = self.load("lw_probes_load", radiosity)
            library.lw_probes_release(probes)
        library.lw_radiosity_release(radiosity)

    def probes(self, _):
        """Loaded with radiosity."""

    def lightmap(self, _):
        lightmap = self.load("lw_lightmap_load")
        if not lightmap:
            return
        h, atlas = self.header("lightmap"), self.header("atlas")
        for bit, kind in ((1, "direct"), (2, "indirect")):
            expected = [0.0] * (4 * atlas["width"] * atlas["height"])
            for i, texel in enumerate(self.values("lightmap", "texel")):
                rgb = rgb9e5(self.values("lightmap", kind)[i]) if h["has_" + kind] else (0, 0, 0)
                expected[4 * texel:4 * texel + 4] = [*((h["unit"] or 1) * v for v in rgb), 1.0]
            got = (c_float * len(expected))()
            library.lw_lightmap_shade(lightmap, byref(LightmapShading(ctypes.sizeof(LightmapShading), bit, 0)), got)
            self.same(f"lightmap/{kind}", expected, got)
        library.lw_lightmap_release(lightmap)

    def vpl(self, _):
        lights = self.load("lw_virtual_lights_load")
        if not lights:
            return
        n, first = self.header("vpl")["lights"], self.values("vpl", "first_vertex")
        for i in range(n):
            light = self.get("lw_virtual_lights_get", VirtualLight, lights, i)
            self.same(f"virtual light {i}", [self.values("vpl", name)[i] for name in ("type", "source", "bounce", "radius")], [light.type, light.source, light.bounce, light.radius])
            for name in ("position", "normal", "flux"):
                self.same(f"virtual light {i} {name}", self.values("vpl", name)[3 * i:3 * i + 3], getattr(light, name))
            if first[i] < first[i + 1]:
                self.same(f"virtual light {i} vertices", self.values("vpl", "vertex")[3 * first[i]:3 * first[i + 1]], light.vertices[:3 * light.vertex_count])
        library.lw_virtual_lights_release(lights)

    def points(self, _):
        points = self.load("lw_points_load")
        if not points:
            return
        h, info = self.header("points"), self.get("lw_points_get_info", PointsInfo, points)
        n = h["points"]
        position = [float32(h["first"][i % 3] + float32(h["step"][i % 3] * v)) for i, v in enumerate(self.values("points", "position"))]
        self.same("points/position", position, info.position[:3 * n])
        self.same("points/normal", self.normals("points", "normal"), info.normal[:3 * n], 3e-7)
        self.same("points/texel", self.values("points", "texel"), info.texel[:n])
        library.lw_points_release(points)


FOUND_IN_CHUNKS = {"bad_checksum.chunk", "trailing_bytes.padding", "bad_chunk.frame_cut", "bad_chunk.frame_size", "bad_chunk.not_zstd", "bad_chunk.two_frames"}
files = sorted(golden.glob("**/*.lwc"))
for file in files:
    comparison, wanted = Comparison(file), file.name.split(".")[0] if file.parent.name == "invalid" else "ok"
    try:
        comparison.run()
        status = "ok"
    except ContainerError as error:
        status = error.status
    if status != wanted:
        failures.append(f"{comparison.place}: {status}, not {wanted}")
    # Header and directory are judged on opening, by both; the rest when a chunk is read.
    opened = "ok" if wanted == "bad_section" or file.name.removesuffix(".lwc") in FOUND_IN_CHUNKS else wanted
    if comparison.opened != opened:
        failures.append(f"{comparison.place}: the runtime says {comparison.opened}")
    library.lw_close(comparison.handle)
for failure in failures:
    print(failure)
print(f"{len(files)} files, {compared} values compared, {len(failures)} differences")
sys.exit(1 if failures or compared < 1000 else 0)
