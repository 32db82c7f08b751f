"""What the sections hold, and whether it keeps the rules of docs/format.md, section 9. `check(container)` raises ContainerError at the first breach."""
import math

from container import BYTES, ContainerError, F16, F32, I16, I8, RGB9E5, U16, U32, U8, ELEMENT_NAMES
from decoded import link_weight
from messages import ALPHA_MATERIALS, HEADERS, MessageError, parse

NONE = 0xffffffff


class _Section:
    """One section of a container: its chunks by name, with their element types and shapes checked."""

    def __init__(self, container, name):
        self.container, self.name = container, name
        self.chunks = container.sections[name].chunks if has(container, name) else {}

    def need(self, good, chunk, reason):
        if not good:
            raise ContainerError("bad_section", f"{self.name}/{chunk}", reason)

    def read(self, name, element, *shape):
        """The values; None in `shape` stands for any extent."""
        chunk = self.chunks.get(name)
        self.need(chunk is not None, name, "missing")
        if not chunk.decodable:
            self.container.decode(chunk)
        allowed = element if isinstance(element, tuple) else (element,)
        self.need(chunk.element in allowed, name, f"elements are {ELEMENT_NAMES[chunk.element]}")
        self.need(len(chunk.shape) == len(shape) and all(b in (None, a) for a, b in zip(chunk.shape, shape)), name, f"its shape is {chunk.shape}")
        return self.container.values(chunk)

    def amounts(self, name, element, *shape):
        values = self.read(name, element, *shape)
        self.need(all(0 <= v < math.inf for v in values), name, "negative or not finite")
        return values

    def finite(self, name, element, *shape):
        values = self.read(name, element, *shape)
        self.need(all(map(math.isfinite, values)), name, "not finite")
        return values

    def below(self, name, most, *shape, none=False):
        values = self.read(name, U32, *shape)
        self.need(all(v < most or (none and v == NONE) for v in values), name, "an index is out of range")
        return values

    def offsets(self, name, count, end, rising=False):
        values = self.read(name, U32, count + 1)
        self.need(values[0] == 0 and values[-1] == end and all(a < b if rising else a <= b for a, b in zip(values, values[1:])), name, "does not split what it shall")
        return values

    def normals(self, name, *shape):
        values = self.read(name, I16, *shape)
        self.need(-32768 not in values, name, "-32768 is reserved")
        return values

    def message(self, name, message_type):
        try:
            return parse(message_type, self.read(name, BYTES, None))
        except MessageError as error:
            raise ContainerError("bad_section", f"{self.name}/{name}", str(error)) from None

    def header(self):
        return self.message("header", HEADERS[self.name])

    def extent(self, name, axis=0):
        self.need(name in self.chunks and len(self.chunks[name].shape) > axis, name, "missing")
        return self.chunks[name].shape[axis]


def has(container, name):
    return name in container.sections and container.sections[name].known


def _finite(values, count):
    return len(values) == count and all(map(math.isfinite, values))


def _atlas(container):
    """Width, height, source and coverage, for the sections that refer to texels."""
    s = _Section(container, "atlas")
    h = s.header()
    s.need(1 <= h["width"] <= 16384 and 1 <= h["height"] <= 16384, "header", "its size")
    texels = h["width"] * h["height"]
    source, coverage = s.below("source", texels, h["height"], h["width"], none=True), s.read("coverage", U8, h["height"], h["width"])
    return s, h, source, coverage


def meta(container):
    s = _Section(container, "meta")
    h = s.header()
    for e in h["errors"]:
        s.need(all(math.isfinite(v) for v in e.values() if isinstance(v, float)) and min(e["relrmse"], e["texrel"], e["maximum"], e["seconds"]) >= 0, "header", "an error")
        s.need(all(e[k + "_low"] <= e[k + "_high"] for k in ("relrmse", "texrel", "bias", "maximum")) and min(e["relrmse_low"], e["texrel_low"], e["maximum_low"]) >= 0 and
               e["bias_low"] >= -1, "header", "an interval")
    s.need(all(o["type"] and o["reason"] for o in h["omitted"]), "header", "what is omitted")


def scene(container):
    s = _Section(container, "scene")
    h = s.header()
    s.need(_finite(h["origin"], 3) and _finite(h["bounds_min"], 3) and _finite(h["bounds_max"], 3) and all(a <= b for a, b in zip(h["bounds_min"], h["bounds_max"])), "header", "origin or bounds")
    for l in h["lights"]:
        s.need(1 <= l["type"] <= 3 and _finite(l["position"], 3) and _finite(l["direction"], 3) and _finite(l["intensity"], 3) and min(l["intensity"]) >= 0, "header", "a light")
        s.need(l["type"] == 1 or abs(sum(v * v for v in l["direction"]) - 1) <= 1e-3, "header", "a light's direction")
        s.need(l["type"] != 2 or 0 <= l["inner_cone_angle"] < l["outer_cone_angle"] <= math.pi / 2 + 1e-6, "header", "a light's cone")
        s.need(0 <= l["range"] < math.inf, "header", "a light's range")


def geometry(container):
    s = _Section(container, "geometry")
    v, t = s.extent("position"), s.extent("index")
    s.finite("position", F32, v, 3)
    s.normals("normal", v, 2)
    s.need(all(-1e-5 <= c <= 1 + 1e-5 for c in s.read("lightmap_uv", F32, v, 2)), "lightmap_uv", "outside of the atlas")
    s.below("index", v, t, 3)
    flags = s.read("triangle_flags", U8, t)
    s.need(all(f < 8 and f & 6 != 6 for f in flags), "triangle_flags", "reserved bits")
    if not any(f & 6 for f in flags):
        return
    s.finite("alpha_uv", F32, v, 2)
    materials = s.message("alpha_material", ALPHA_MATERIALS)["materials"]
    for m in materials:
        s.need(m["mode"] in (1, 2) and 0 <= m["factor"] <= 1 and 0 <= m["cutoff"] < math.inf, "alpha_material", "a value")
        if m["texture"] is not None:
            name = f"alpha_texture_{m['texture']}"
            s.need(1 <= m["wrap_u"] <= 3 and 1 <= m["wrap_v"] <= 3, "alpha_material", "a wrap mode")
            s.need(1 <= s.extent(name) <= 16384 and 1 <= s.extent(name, 1) <= 16384, name, "its size")
            s.read(name, U8, None, None)
    for flag, alpha in zip(flags, s.read("triangle_alpha", U16, t)):
        s.need((alpha == 0xffff) == (flag & 6 == 0) and (alpha == 0xffff or (alpha < len(materials) and materials[alpha]["mode"] == (1 if flag & 2 else 2))), "triangle_alpha", "a material")


def atlas(container):
    s, h, source, coverage = _atlas(container)
    w, height = h["width"], h["height"]
    s.need(all(c < 2 for c in coverage) and sum(coverage) == h["covered_texels"], "coverage", "not 0 and 1, or another count")
    s.need(all(i == NONE or (coverage[i] and source[i] == i) for i in source), "source", "a shown texel does not show itself")
    s.need(all(i != NONE for i, c in zip(source, coverage) if c), "source", "a covered texel shows nothing")
    albedo = s.read("albedo", U8, height, w, 3)
    s.need(all(i != NONE or not any(albedo[3 * k:3 * k + 3]) for k, i in enumerate(source)), "albedo", "where nothing is shown")
    if "emission" in s.chunks:
        emission = s.read("emission", RGB9E5, height, w)
        s.need(all(i != NONE or emission[k] & 0x7ffffff == 0 for k, i in enumerate(source)), "emission", "where nothing is shown")


def _texels(s, container, count, rising=True):
    _, h, _, coverage = _atlas(container)
    texel = s.below("texel", h["width"] * h["height"], count)
    s.need(all(coverage[i] for i in texel), "texel", "not covered")
    s.need(all(a < b for a, b in zip(texel, texel[1:])) if rising else len(set(texel)) == len(texel), "texel", "not unique, or out of order")


def prm(container):
    s = _Section(container, "prm")
    h = s.header()
    n, c, t, b = h["entries"], h["clusters"], h["texels"], h["blocks"]
    s.need(h["layout"] in (1, 3), "header", "its layout")
    s.finite("entry_position", F32, n, 3)
    s.normals("entry_normal", n, 2)
    weight, first = s.amounts("entry_weight", F32, n), s.offsets("cluster_first_entry", c, n, rising=True)
    s.need(all(abs(math.fsum(weight[i:j]) - 1) <= 1e-4 for i, j in zip(first, first[1:])), "entry_weight", "the weights of a cluster do not sum to 1")
    _texels(s, container, t, rising=False)
    for name, there in (("emitter", h["has_emitter"]), ("sky", h["has_sky"])):
        for kind in ("direct", "indirect"):
            if there:
                s.read(f"{name}_{kind}", RGB9E5, t)
    s.need(not h["has_sky"] or (0 < h["sky_scale"] <= 2.0 ** 60 and math.frexp(h["sky_scale"])[0] == 0.5), "header", "sky_scale")
    if h["layout"] == 1:
        s.need(b == 0 and h["max_rank"] == 0 and h["brightest"] <= c, "header", "a field of the other layout")
        element = s.chunks["pane"].element if "pane" in s.chunks else 0
        s.amounts("pane", (RGB9E5, F16), c, t, *([3] if element == F16 else []))
        return
    s.need(h["brightest"] == 0 and c > 0 and 1 <= b <= t and 1 <= h["max_rank"] <= 255, "header", "its counts")
    s.finite("entry_rectangle", F16, n, 3)
    leaves = s.read("tree_first_leaves", U32, c - 1)
    stack, node = [c], 0
    while stack:  # leaves of a subtree, in pre-order
        count = stack.pop()
        if count > 1:
            s.need(1 <= leaves[node] < count, "tree_first_leaves", f"node {node}")
            stack += [count - leaves[node], leaves[node]]
            node += 1
    s.need(all(v > 0 for v in s.read("tree_first_share", U16, c - 1)), "tree_first_share", "0")
    s.read("wavelet_unit", U8, 3 * c - 2)
    texels = s.offsets("block_first_texel", b, t, rising=True)
    _blocks(s, [j - i for i, j in zip(texels, texels[1:])], h["max_rank"], c)


def _blocks(s, values, most_rank, clusters):
    """Blocks of so many values each, with their links to the wavelets of so many clusters."""
    b = len(values)
    rank = s.read("block_rank", U8, b)
    s.need(all(r <= most_rank for r in rank), "block_rank", "above max_rank")
    s.need(-128 not in s.read("basis", I8, sum(n * r for n, r in zip(values, rank))), "basis", "-128 is reserved")
    s.amounts("coefficient_scale", F32, 3 * sum(rank))
    links = s.extent("link_wavelet")
    first, wavelet = s.offsets("block_first_link", b, links), s.below("link_wavelet", 3 * clusters - 2, links)
    s.need(all(wavelet[k] <= wavelet[k + 1] for j in range(b) for k in range(first[j], first[j + 1] - 1)), "link_wavelet", "falling within a block")
    s.read("coefficient", I8, 3 * sum((first[j + 1] - first[j]) * rank[j] for j in range(b)))


def prm_probes(container):
    s = _Section(container, "prm_probes")
    h, p = s.header(), _Section(container, "prm").header()
    s.need(1 <= h["probes"] <= 1 << 22 and h["max_rank"] <= 12, "header", "its counts")
    s.need(p["layout"] == 3 and p["clusters"] > 0, "header", "section prm has no local bases")
    s.finite("position", F32, h["probes"], 3)
    _blocks(s, [12] * h["probes"], h["max_rank"], p["clusters"])
    if h["has_emitter"]:
        s.finite("emitter", F16, h["probes"], 9, 3)


def environment(container):
    s = _Section(container, "environment")
    h = s.header()
    n, m = h["cells"], h["face_cells"]
    s.need(1 <= n <= 4096 and h["suns"] <= n and m % 2 == 0 and 4 <= m <= 256, "header", "its counts")
    s.need(0 < h["node_scale"] <= 2.0 ** 80 and math.frexp(h["node_scale"])[0] == 0.5, "header", "node_scale")
    s.need(_finite(h["sky_flux"], 3) and min(h["sky_flux"]) >= 0 and _finite(h["radiance_sh"], 27), "header", "sky_flux or radiance_sh")
    for direction in _triples(s.finite("cell_direction", F32, n, 3)):
        s.need(abs(sum(v * v for v in direction) - 1) <= 1e-5, "cell_direction", "not a unit vector")
    flux = s.amounts("cell_flux", F32, n, 3)
    angle = s.amounts("cell_solid_angle", F32, n)
    s.need(min(angle) > 0 and abs(math.fsum(angle) / (4 * math.pi) - 1) <= 1e-4, "cell_solid_angle", "not 4 pi together")
    s.need(all(v <= 1 for v in s.amounts("cell_spread", F32, n)), "cell_spread", "above 1")
    s.finite("cell_covariance", F32, n, 3)
    node = s.finite("node", F16, 6, m + 1, m + 1, 3)
    for k in range(3):
        sky = h["sky_flux"][k]
        s.need(abs(math.fsum(flux[3 * h["suns"] + k::3]) - sky) <= 1e-4 * max(sky, 1e-30), "cell_flux", "the cells do not add to sky_flux")
        mass = h["node_scale"] * 4 * math.pi / (6 * m * m)
        s.need(abs(mass * math.fsum(node[k::3]) - sky) <= 1e-3 * max(mass * math.fsum(map(abs, node[k::3])), 1e-30), "node", "the nodes do not add to sky_flux")
        s.need(abs(h["radiance_sh"][k] - sky / math.sqrt(4 * math.pi)) <= 1e-4 * max(sky, 1e-30), "header", "radiance_sh does not begin with sky_flux")


def _node_count(patches):
    total = level = patches
    while level > 8:
        level = -(-level // 8)
        total += level
    return total


def _gates(s, links, first, gates):
    """The gate set of each link, and what share of it light gets through with all portals shut and all open."""
    if "link_gates" not in s.chunks:
        return [0] * links, [(1, 1)]
    sets = s.extent("gate_set_first") - 1
    s.need(1 <= sets <= 65536, "gate_set_first", "its length")
    entries = s.extent("gate_set")
    begin, entry = s.offsets("gate_set_first", sets, entries), s.read("gate_set", U16, entries)
    s.need(begin[1] == 0, "gate_set_first", "set 0 is not empty")
    s.need(all(e // 2 < gates for e in entry) and all(entry[k] < entry[k + 1] for j in range(sets) for k in range(begin[j], begin[j + 1] - 1)), "gate_set", "an entry")
    link_gates = s.read("link_gates", U16, links)
    s.need(all(g < sets for g in link_gates) and all(link_gates[k] <= link_gates[k + 1] for i in range(len(first) - 1) for k in range(first[i], first[i + 1] - 1)), "link_gates", "a set")
    return link_gates, [(int(all(e & 1 for e in entry[i:j])), int(not any(e & 1 for e in entry[i:j]))) for i, j in zip(begin, begin[1:])]


def _links(s, rows, nodes, gates, first_name, scale_name, most):
    links = s.extent("link_node")
    first, node = s.offsets(first_name, rows, links), s.below("link_node", nodes, links)
    code, scale = s.read("link_code", U8, links), s.amounts(scale_name, F32, rows)
    link_gates, through = _gates(s, links, first, gates)
    for i in range(rows):
        row = range(first[i], first[i + 1])
        s.need(all(link_gates[k] != link_gates[k + 1] or node[k] < node[k + 1] for k in row[:-1]), "link_node", "not rising")
        for portals in (0, 1):
            s.need(scale[i] * sum(link_weight(code[k]) * through[link_gates[k]][portals] for k in row) <= most, scale_name, f"row {i} receives more than there is")


def radiosity(container):
    s = _Section(container, "radiosity")
    h = s.header()
    p, t, materials = h["patches"], h["texels"], len(h["materials"])
    s.need(p >= 1 and t >= 1 and 1 <= materials <= 65536 and _node_count(p) <= 1 << 24, "header", "its counts")
    gates, last, triangles = 0, 0, _Section(container, "geometry").extent("index")
    for portal in h["portals"]:
        s.need(portal["first_gate"] == gates and portal["strips"] >= 1, "header", "gates of a portal")
        gates += portal["strips"]
        s.need(math.isfinite(portal["offset"]) and (not portal["triangles"] or (_finite(portal["axis"], 3) and any(portal["axis"]))), "header", "the axis of a portal")
        if portal["triangles"]:
            s.need(last <= portal["first_triangle"] and portal["first_triangle"] + portal["triangles"] <= triangles, "header", "the leaf of a portal")
            last = portal["first_triangle"] + portal["triangles"]
    s.need(gates <= 32768, "header", "its gates")
    s.need(min(s.amounts("patch_area", F32, p)) > 0, "patch_area", "0")
    s.finite("patch_position", F32, p, 3)
    s.normals("patch_normal", p, 2)
    s.need(all(m < materials for m in s.read("patch_material", U16, p)), "patch_material", "no material")
    s.need(all(a <= 0.99900001 for a in s.amounts("patch_albedo", F32, p, 3)), "patch_albedo", "above 0.999")
    if h["has_emission"]:
        s.read("patch_emission", RGB9E5, p)
    _links(s, p, _node_count(p), gates, "link_first", "row_scale", 1 + 1e-4 + 1e-6)
    _texels(s, container, t)
    patch, weight = s.below("texel_patch", p, t, 4, none=True), s.read("texel_weight", U8, t, 4)
    for i in range(t):
        mine = range(4 * i, 4 * i + 4)
        s.need(patch[4 * i] != NONE and sum(weight[k] for k in mine) == 255 and all(patch[k] != NONE or weight[k] == 0 for k in mine), "texel_weight", f"texel {i}")
    s.read("texel_exposed", U8, t)
    if h["has_backs"]:
        s.below("texel_back_patch", p, t, none=True)


def lightmap(container):
    s = _Section(container, "lightmap")
    h = s.header()
    t = h["texels"]
    s.need(t >= 1 and (h["unit"] == 0 or (2.0 ** -126 <= h["unit"] <= 2.0 ** 126 and math.frexp(h["unit"])[0] == 0.5)), "header", "texels or unit")
    _texels(s, container, t)
    for kind in ("direct", "indirect"):
        if h["has_" + kind]:
            s.read(kind, RGB9E5, t)
        if h[f"has_{kind}_gradient"]:
            s.need(h["has_" + kind], "header", "a gradient without its light")
            s.need(-128 not in s.read(kind + "_gradient", I8, t, 3), kind + "_gradient", "-128")


def vpl(container):
    s = _Section(container, "vpl")
    h = s.header()
    l, v = h["lights"], h["vertices"]
    s.need(l >= 1, "header", "no lights")
    if has(container, "scene"):
        lamps = len(_Section(container, "scene").header()["lights"])
        s.need(h["sources"] in (lamps + 1, lamps + 2), "header", "sources")
    kind, source, bounce = s.read("type", U8, l), s.below("source", h["sources"], l), s.read("bounce", U8, l)
    s.need(all(1 <= k <= 4 for k in kind), "type", "unknown")
    s.need(all(source[i] <= source[i + 1] and (source[i] < source[i + 1] or bounce[i] <= bounce[i + 1]) for i in range(l - 1)), "source", "out of order")
    s.finite("position", F32, l, 3)
    s.need(all(abs(sum(c * c for c in n) - 1) <= 1e-3 for n in _triples(s.finite("normal", F32, l, 3))), "normal", "not a unit vector")
    s.amounts("flux", F32, l, 3)
    s.need(all((r > 0) == (k in (2, 3)) for r, k in zip(s.amounts("radius", F32, l), kind)), "radius", "of another type")
    first = s.offsets("first_vertex", l, v)
    s.need(all(3 <= first[i + 1] - first[i] <= 8 if kind[i] == 4 else first[i + 1] == first[i] for i in range(l)), "first_vertex", "of another type")
    if v > 0:
        s.finite("vertex", F32, v, 3)


def points(container):
    s = _Section(container, "points")
    h = s.header()
    n = h["points"]
    s.need(1 <= n <= 1 << 22 and 0 < h["area"] < math.inf and _finite(h["first"], 3) and _finite(h["step"], 3) and min(h["step"]) >= 0, "header", "a value")
    s.read("position", U16, n, 3)
    s.normals("normal", n, 2)
    texel = s.read("texel", U32, n)
    if has(container, "atlas"):
        _, _, source, _ = _atlas(container)
        s.need(all(i == NONE or (i < len(source) and source[i] == i) for i in texel), "texel", "does not show itself")


def probes(container):
    s = _Section(container, "probes")
    h = s.header()
    g, m = h["lattice_probes"], h["points"]
    s.need(1 <= g + m <= 1 << 22, "header", "its counts")
    if h["lattice_count"]:
        lattice = math.prod(h["lattice_count"])
        s.need(len(h["lattice_count"]) == 3 and lattice <= 1 << 22 and _finite(h["lattice_first"], 3) and 0 < h["lattice_spacing"] < math.inf, "header", "the lattice")
        point = s.below("lattice_point", lattice, g)
        s.need(all(a < b for a, b in zip(point, point[1:])), "lattice_point", "not rising")
        s.need(-128 not in s.read("offset", I8, g, 3), "offset", "-128 is reserved")
        s.read("nearness", U8, g, 289)
    else:
        s.need(g == 0, "header", "probes of no lattice")
    if m > 0:
        s.finite("point_position", F32, m, 3)
    r = _Section(container, "radiosity").header()
    _links(s, g + m, _node_count(r["patches"]), sum(p["strips"] for p in r["portals"]), "link_first", "scale", math.inf)


def _triples(values):
    return zip(values[::3], values[1::3], values[2::3])


_NEEDS = {"geometry": ["scene", "atlas"], "prm": ["scene", "atlas"], "radiosity": ["scene", "atlas", "geometry"], "lightmap": ["atlas"], "probes": ["radiosity"], "prm_probes": ["prm"]}
_CHECKS = {f.__name__: f for f in (meta, scene, atlas, geometry, prm, prm_probes, environment, radiosity, probes, lightmap, vpl, points)}


def check(container):
    """Every checksum, then every section of a known version. Returns notes on what could not be checked."""
    notes = []
    for chunk in container.chunks:
        container.stored(chunk)
        if not chunk.decodable:
            notes.append(f"{chunk.place}: of a later version")
    for name, section in container.sections.items():
        if not section.known:
            notes.append(f"section {name}: of a later version, values not checked")
            continue
        for other in _NEEDS.get(name, []):
            if not has(container, other):
                raise ContainerError("bad_section", name, f"needs section {other}")
        _CHECKS[name](container)
    for chunk in container.chunks:  # what no table names
        if chunk.decodable:
            container.decode(chunk)
    return notes
