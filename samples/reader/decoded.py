"""What the numbers of a section stand for: docs/format.md, sections 4 and 9. Where the document states an arithmetic, bit for bit.

`decoded(container, section)` gives the chunks of one section by name, as lists of numbers: normals and colours unpacked, links with their weights. Call `check` of sections.py first: nothing is
checked here.
"""
import math
import struct

from container import BYTES, RGB9E5, rgb9e5
from messages import HEADERS, parse

def f32(value):
    """Rounded to binary32."""
    return struct.unpack("<f", struct.pack("<f", value))[0]


def octahedral(x, y):
    """Section 4, each operation rounded to binary32."""
    px, py = f32(x / 32767), f32(y / 32767)
    z = f32(f32(1 - abs(px)) - abs(py))
    fold = max(-z, 0.0)
    px, py = (f32(p - fold) if p >= 0 else f32(p + fold) for p in (px, py))
    scale = f32(1 / f32(math.sqrt(f32(f32(f32(px * px) + f32(py * py)) + f32(z * z)))))
    return f32(px * scale), f32(py * scale), f32(z * scale)


def link_weight(code):
    return (16 + (code & 15)) << (code >> 4)


def decoded(container, section):
    chunks = container.sections[section].chunks
    header = parse(HEADERS[section], container.decode(chunks["header"])) if section in HEADERS else {}
    values = {}
    for name, chunk in chunks.items():
        if not chunk.decodable or chunk.element == BYTES:
            continue
        numbers = container.values(chunk)
        if chunk.element == RGB9E5:
            values[name] = [f32(v * _scale(section, name, header)) for packed in numbers for v in rgb9e5(packed)]
        elif name.endswith("normal") and section != "vpl":
            values[name] = [v for x, y in zip(numbers[::2], numbers[1::2]) for v in octahedral(x, y)]
        else:
            values[name] = list(numbers)
    if section in _MORE:
        _MORE[section](header, values)
    return header, values


def _scale(section, name, header):
    """What stored colours are in."""
    return header["sky_scale"] if section == "prm" and name.startswith("sky_") else header["unit"] or 1.0 if section == "lightmap" else 1.0


def _prm(header, values):
    if header["layout"] != 3:
        return
    clusters = header["clusters"]
    values["unit"] = [f32(2.0 ** ((code - 160) / 8)) for code in values.pop("wavelet_unit")]
    # The wavelets that are the means of a node's children: leaves in order, inner nodes in pre-order.
    values["tree_children"], stack = [], [(0, clusters)] if clusters > 1 else []
    node = 0
    while stack:
        first_leaf, leaves = stack.pop()
        first = values["tree_first_leaves"][node]
        children = [(first_leaf, first, node + 1), (first_leaf + first, leaves - first, node + first)]
        values["tree_children"] += [leaf if count == 1 else clusters + inner for leaf, count, inner in children]
        stack += [(leaf, count) for leaf, count, _ in reversed(children) if count > 1]
        node += 1
    _blocks(values)


def _blocks(values):
    # [G, R - G, B - G][link] to [link][R, G, B], with 8 bits.
    coefficients, at, wrapped = [], 0, lambda v: (v + 128 & 255) - 128
    for j, rank in enumerate(values["block_rank"]):
        links = values["block_first_link"][j + 1] - values["block_first_link"][j]
        stored = values["coefficient"][at:at + 3 * rank * links]
        at += len(stored)
        for link in range(links):
            for m in range(rank):
                green, red, blue = (stored[(3 * m + k) * links + link] for k in range(3))
                coefficients += [wrapped(green + red), green, wrapped(green + blue)]
    values["coefficient"] = coefficients


def _environment(header, values):
    cells = header["face_cells"]
    values["mass"] = [header["node_scale"] * 4 * math.pi / (6.0 * cells * cells) * v for v in values.pop("node")]
    values["tangent"] = []
    for x, y, z in zip(*(values["cell_direction"][k::3] for k in range(3))):
        g = math.copysign(1.0, z)
        a = f32(-1 / f32(g + z))
        values["tangent"] += [f32(1 + f32(f32(g * x * x) * a)), f32(f32(g * x * y) * a), -g * x]


def _radiosity(header, values):
    _links(values)
    # Nodes above the patches, eight by eight: the share of each in the area of the one above.
    level, areas = values["patch_area"], []
    values["node_share"], values["level_first"] = [], [0]
    while True:
        values["level_first"].append(values["level_first"][-1] + len(level))
        if len(level) <= 8:
            break
        areas = [math.fsum(level[i:i + 8]) for i in range(0, len(level), 8)]
        values["node_share"] += [area / areas[i // 8] for i, area in enumerate(level)]
        level = areas
    values["top_area"] = list(level)


def _links(values):
    values["link_weight"] = [link_weight(code) for code in values.pop("link_code")]
    values.setdefault("link_gates", [0] * len(values["link_weight"]))


def _probes(header, values):
    _links(values)
    values["position"] = []
    if header["lattice_count"]:
        count, first, spacing = header["lattice_count"], header["lattice_first"], header["lattice_spacing"]
        for i, point in enumerate(values["lattice_point"]):
            at = point % count[0], point // count[0] % count[1], point // count[0] // count[1]
            values["position"] += [f32(first[k] + f32(spacing * f32(at[k] + f32(values["offset"][3 * i + k] / 254)))) for k in range(3)]
    values["position"] += values.pop("point_position", [])


def _points(header, values):
    values["position"] = [f32(header["first"][i % 3] + f32(header["step"][i % 3] * v)) for i, v in enumerate(values["position"])]


_MORE = {"prm": _prm, "prm_probes": lambda header, values: _blocks(values), "environment": _environment, "radiosity": _radiosity, "probes": _probes, "points": _points}
