"""Protobuf messages of the container, read without a library: docs/format.md section 7, fields of schemas/lightwell/v1/container.proto.

A message type is {number: (name, kind)}; kind is a scalar type, another message type in a tuple, or a list of one of these when repeated.
"""
import struct


class MessageError(Exception):
    pass


SECTION = {1: ("type", "string"), 2: ("version", "uint32"), 3: ("required", "bool")}
CHUNK = {1: ("section", "string"), 2: ("name", "string"), 3: ("element", "enum"), 4: ("shape", ["uint64"]), 5: ("codec", "enum"),
         6: ("offset", "uint64"), 7: ("stored_bytes", "uint64"), 8: ("checksum", "fixed64")}
DIRECTORY = {1: ("sections", [(SECTION,)]), 2: ("chunks", [(CHUNK,)])}

OMITTED = {1: ("type", "string"), 2: ("reason", "string"), 3: ("decoded_bytes", "uint64"), 4: ("rays", "uint64")}
MEASURED_ERROR = {1: ("section", "string"), 2: ("relrmse", "double"), 3: ("texrel", "double"), 4: ("bias", "double"), 5: ("against", "string"),
                  6: ("relrmse_low", "double"), 7: ("relrmse_high", "double"), 8: ("texrel_low", "double"), 9: ("texrel_high", "double"),
                  10: ("bias_low", "double"), 11: ("bias_high", "double"), 12: ("maximum", "double"), 13: ("maximum_low", "double"),
                  14: ("maximum_high", "double"), 15: ("texels", "uint32"), 16: ("seconds", "double")}
PROVENANCE = {1: ("tool_version", "string"), 2: ("scene_name", "string"), 3: ("scene_hash", "fixed64"), 4: ("settings_json", "string"),
              5: ("time_limited", "bool"), 6: ("warnings", ["string"]), 7: ("environment_name", "string"), 8: ("environment_hash", "fixed64")}
META = {1: ("provenance", (PROVENANCE,)), 2: ("omitted", [(OMITTED,)]), 3: ("errors", [(MEASURED_ERROR,)])}
LIGHT = {1: ("type", "enum"), 2: ("name", "string"), 3: ("position", ["float"]), 4: ("direction", ["float"]), 5: ("intensity", ["float"]),
         6: ("inner_cone_angle", "float"), 7: ("outer_cone_angle", "float"), 8: ("range", "float")}
SCENE = {1: ("origin", ["double"]), 2: ("bounds_min", ["float"]), 3: ("bounds_max", ["float"]), 4: ("lights", [(LIGHT,)])}
ALPHA_MATERIAL = {1: ("mode", "enum"), 2: ("cutoff", "float"), 3: ("factor", "float"), 4: ("texture", "optional uint32"), 5: ("wrap_u", "enum"),
                  6: ("wrap_v", "enum")}
ALPHA_MATERIALS = {1: ("materials", [(ALPHA_MATERIAL,)])}
ATLAS = {1: ("width", "uint32"), 2: ("height", "uint32"), 3: ("covered_texels", "uint32"), 4: ("charts", "uint32"), 5: ("unwrapped", "bool")}
PRM = {1: ("layout", "enum"), 2: ("entries", "uint32"), 3: ("clusters", "uint32"), 4: ("texels", "uint32"), 5: ("blocks", "uint32"),
       6: ("max_rank", "uint32"), 7: ("brightest", "uint32"), 8: ("has_emitter", "bool"), 10: ("has_sky", "bool"), 11: ("sky_scale", "float")}
PRM_PROBES = {1: ("probes", "uint32"), 2: ("max_rank", "uint32"), 3: ("has_emitter", "bool")}
ENVIRONMENT = {1: ("cells", "uint32"), 2: ("suns", "uint32"), 3: ("face_cells", "uint32"), 4: ("node_scale", "float"), 5: ("sky_flux", ["float"]),
               6: ("radiance_sh", ["float"]), 7: ("rotation_deg", "float"), 8: ("intensity", "float"), 9: ("ground_radiance", ["float"])}
MATERIAL = {1: ("name", "string")}
PORTAL = {1: ("name", "string"), 2: ("first_gate", "uint32"), 3: ("strips", "uint32"), 4: ("first_triangle", "uint32"), 5: ("triangles", "uint32"),
          6: ("axis", ["float"]), 7: ("offset", "float")}
RADIOSITY = {1: ("patches", "uint32"), 2: ("texels", "uint32"), 3: ("has_emission", "bool"), 4: ("has_backs", "bool"), 5: ("materials", [(MATERIAL,)]),
             6: ("portals", [(PORTAL,)]), 7: ("raw_transfers", "uint64"), 8: ("dark_patches", "uint32")}
LIGHTMAP = {1: ("texels", "uint32"), 2: ("has_direct", "bool"), 3: ("has_indirect", "bool"), 4: ("has_direct_gradient", "bool"),
            5: ("has_indirect_gradient", "bool"), 6: ("unit", "float")}
VPL = {1: ("lights", "uint32"), 2: ("vertices", "uint32"), 3: ("sources", "uint32"), 4: ("points", "uint64")}
POINTS = {1: ("points", "uint32"), 2: ("area", "float"), 3: ("first", ["float"]), 4: ("step", ["float"])}
PROBES = {1: ("lattice_probes", "uint32"), 2: ("points", "uint32"), 3: ("lattice_count", ["uint32"]), 4: ("lattice_first", ["float"]),
          5: ("lattice_spacing", "float"), 6: ("moved", "uint32"), 7: ("inside", "uint32"), 8: ("sealed", "uint32")}
HEADERS = {"meta": META, "scene": SCENE, "atlas": ATLAS, "prm": PRM, "prm_probes": PRM_PROBES, "environment": ENVIRONMENT, "radiosity": RADIOSITY, "lightmap": LIGHTMAP,
           "vpl": VPL, "points": POINTS, "probes": PROBES}

_WIRE_TYPES = {"uint32": 0, "uint64": 0, "bool": 0, "enum": 0, "fixed64": 1, "double": 1, "string": 2, "float": 5}
_MOST = {"uint32": 1 << 32, "uint64": 1 << 64, "bool": 2, "enum": 1 << 31}


def parse(message_type, data):
    """Bytes to a dict with every field of the type; those that are absent have their defaults. Raises MessageError."""
    result = {name: [] if isinstance(kind, list) else parse(kind[0], b"") if isinstance(kind, tuple) else _default(kind)
              for name, kind in message_type.values()}
    seen, at = set(), 0
    while at < len(data):
        key, at = _varint(data, at)
        number, wire_type = key >> 3, key & 7
        if number == 0 or key >= 1 << 32:
            raise MessageError("a field's number")
        value, at = _wire_value(data, at, wire_type)
        if number not in message_type:
            continue
        name, kind = message_type[number]
        repeated = isinstance(kind, list)
        kind = kind[0] if repeated else kind.removeprefix("optional ") if isinstance(kind, str) else kind
        if repeated and isinstance(kind, str) and kind != "string" and wire_type == 2:
            result[name].extend(_packed(kind, value))
            continue
        if wire_type != (2 if isinstance(kind, tuple) else _WIRE_TYPES[kind]):
            raise MessageError(f"{name} has another wire type")
        value = parse(kind[0], value) if isinstance(kind, tuple) else _scalar(kind, value)
        if repeated:
            result[name].append(value)
        else:
            if number in seen:
                raise MessageError(f"{name} is there twice")
            seen.add(number)
            result[name] = value
    return result


def _default(kind):
    return None if kind.startswith("optional") else "" if kind == "string" else False if kind == "bool" else 0


def _varint(data, at):
    value = 0
    for i in range(10):
        if at + i >= len(data):
            raise MessageError("ends inside of a number")
        value |= (data[at + i] & 0x7f) << 7 * i
        if data[at + i] < 0x80:
            if value >= 1 << 64:
                break
            return value, at + i + 1
    raise MessageError("a number of more than 64 bits")


def _wire_value(data, at, wire_type):
    if wire_type == 0:
        return _varint(data, at)
    if wire_type not in (1, 2, 5):
        raise MessageError("a group")
    size, at = _varint(data, at) if wire_type == 2 else (8 if wire_type == 1 else 4, at)
    if size > len(data) - at:
        raise MessageError("ends inside of a field")
    return data[at:at + size], at + size


def _scalar(kind, value):
    if kind in _MOST:
        if value >= _MOST[kind]:
            raise MessageError(f"{value} is beyond {kind}")
        return bool(value) if kind == "bool" else value
    if kind == "string":
        return value.decode("utf-8", "replace")
    return struct.unpack({"fixed64": "<Q", "double": "<d", "float": "<f"}[kind], value)[0]


def _packed(kind, data):
    if kind in _MOST:
        at = 0
        while at < len(data):
            value, at = _varint(data, at)
            yield _scalar(kind, value)
        return
    size = 4 if kind == "float" else 8
    if len(data) % size:
        raise MessageError("ends inside of a number")
    for at in range(0, len(data), size):
        yield _scalar(kind, data[at:at + size])
