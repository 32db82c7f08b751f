"""The frame of a Lightwell container: header, directory, chunks. Written from docs/format.md, sections 4 to 8 and 10 to 13, and from nothing else.

Needs Python 3.9 and the shared libraries of zstd and xxHash, which it calls through ctypes.
"""
import ctypes
import ctypes.util
import re
import struct
import sys
from array import array
from dataclasses import dataclass, field

from messages import DIRECTORY, MessageError, parse

MAGIC = bytes.fromhex("894c57430d0a1a0a")
HEADER_BYTES, ALIGNMENT, MAX_RANK, MAX_EXPANSION = 64, 16, 4, 32768
KNOWN_SECTIONS = {name: 1 for name in ("meta", "scene", "geometry", "atlas", "prm", "environment", "radiosity", "probes", "lightmap", "vpl", "points", "prm_probes")}

BYTES, U8, I8, U16, I16, U32, F16, F32, RGB9E5 = range(1, 10)
ELEMENT_NAMES = ["", "BYTES", "U8", "I8", "U16", "I16", "U32", "F16", "F32", "RGB9E5"]
ELEMENT_BYTES = [0, 1, 1, 1, 2, 2, 4, 2, 4, 4]
RAW, ZSTD, ZSTD_PLANES, ZSTD_DELTA_PLANES, RANS = range(1, 6)
CODEC_NAMES = ["", "RAW", "ZSTD", "ZSTD_PLANES", "ZSTD_DELTA_PLANES", "RANS"]
RANS_PARTS, RANS_WINDOW, RANS_CONTEXTS, RANS_SCALE = 4, 16, 23, 4096


class ContainerError(Exception):
    """`status` is a name of section 12, `place` a part of the file."""

    def __init__(self, status, place, reason):
        super().__init__(f"{status}: {place}: {reason}")
        self.status, self.place, self.reason = status, place, reason


@dataclass
class Limits:
    """Section 13."""
    file_bytes: int = 1 << 40
    directory_bytes: int = 16 << 20
    sections: int = 256
    chunks: int = 65536
    decoded_bytes: int = 2 << 30


@dataclass
class Chunk:
    section: str
    name: str
    element: int
    codec: int
    shape: list
    offset: int
    stored_bytes: int
    checksum: int
    raw_bytes: int = 0
    decodable: bool = True
    padding: int = 0  # after it

    @property
    def place(self):
        return f"{self.section}/{self.name}"


@dataclass
class Section:
    type: str
    version: int
    required: bool
    chunks: dict = field(default_factory=dict)

    @property
    def known(self):
        return self.version <= KNOWN_SECTIONS.get(self.type, 0)


def _library(name):
    return ctypes.CDLL(ctypes.util.find_library(name) or f"lib{name}.so")


_zstd, _xxhash = _library("zstd"), _library("xxhash")
_xxhash.XXH3_64bits.restype = ctypes.c_uint64
_xxhash.XXH3_64bits.argtypes = [ctypes.c_char_p, ctypes.c_size_t]
for _name, _result, _arguments in (("decompress", ctypes.c_size_t, [ctypes.c_char_p, ctypes.c_size_t] * 2),
                                   ("findFrameCompressedSize", ctypes.c_size_t, [ctypes.c_char_p, ctypes.c_size_t]),
                                   ("getFrameContentSize", ctypes.c_uint64, [ctypes.c_char_p, ctypes.c_size_t]),
                                   ("getDictID_fromFrame", ctypes.c_uint, [ctypes.c_char_p, ctypes.c_size_t])):
    _function = getattr(_zstd, "ZSTD_" + _name)
    _function.restype, _function.argtypes = _result, _arguments


def checksum(data):
    return _xxhash.XXH3_64bits(data, len(data))


def align_up(offset):
    return -(-offset // ALIGNMENT) * ALIGNMENT


def codec_allowed(codec, element):
    if codec == ZSTD_PLANES:
        return ELEMENT_BYTES[element] in (2, 4)
    if codec == ZSTD_DELTA_PLANES:
        return element in (U8, I8, U16, I16, U32)
    if codec == RANS:
        return ELEMENT_BYTES[element] == 1
    return True


def rgb9e5(packed):
    scale = 2.0 ** ((packed >> 27) - 24)
    return tuple((packed >> shift & 511) * scale for shift in (0, 9, 18))


class Container:
    """Reads and checks header and directory; decodes chunks when asked. `data` is the whole file."""

    def __init__(self, data, limits=None):
        self.data, self.limits = bytes(data), limits or Limits()
        self.sections, self.chunks = {}, []
        self._read_header()
        self._read_directory()

    def _read_header(self):
        data = self.data
        need = lambda good, status, reason: _need(good, status, "header", reason)
        need(data[:8] == MAGIC[:len(data)], "bad_magic", "not a container")
        need(len(data) >= HEADER_BYTES, "truncated", "ends inside of the header")
        major, self.version_minor, reserved, file_bytes, offset, size, directory_sum, reserved_2, header_sum = struct.unpack_from("<HHIQQQQQQ", data, 8)
        need(major <= 1, "too_new", f"version {major}")
        need(checksum(data[:56]) == header_sum, "bad_checksum", "of bytes 0 to 55")
        need(major == 1, "bad_header", "version 0")
        need(reserved == 0 and reserved_2 == 0, "bad_header", "reserved bits")
        need(file_bytes <= self.limits.file_bytes, "limit_exceeded", f"{file_bytes} bytes")
        need(file_bytes <= len(data), "truncated", f"{len(data)} of {file_bytes} bytes")
        need(file_bytes == len(data), "trailing_bytes", f"{len(data)} bytes, not {file_bytes}")
        need(offset == HEADER_BYTES and size <= file_bytes - HEADER_BYTES, "bad_header", "the directory's place")
        need(size <= self.limits.directory_bytes, "limit_exceeded", "the directory's size")
        self.directory_bytes = size
        _need(checksum(data[HEADER_BYTES:HEADER_BYTES + size]) == directory_sum, "bad_checksum", "directory", "")

    def _read_directory(self):
        need = lambda good, reason, status="bad_directory": _need(good, status, "directory", reason)
        try:
            directory = parse(DIRECTORY, self.data[HEADER_BYTES:HEADER_BYTES + self.directory_bytes])
        except MessageError as error:
            raise ContainerError("bad_directory", "directory", str(error)) from None
        need(len(directory["sections"]) <= self.limits.sections and len(directory["chunks"]) <= self.limits.chunks, "too many entries", "limit_exceeded")
        for entry in directory["sections"]:
            section = Section(entry["type"], entry["version"], entry["required"])
            need(_is_name(section.type) and section.type not in self.sections and section.version >= 1, f"section {section.type!r}")
            need(section.known or not section.required, f"section {section.type} version {section.version} is required", "too_new")
            self.sections[section.type] = section
        end, decoded = HEADER_BYTES + self.directory_bytes, 0
        for entry in directory["chunks"]:
            chunk = Chunk(**entry)
            self._check_chunk(chunk, end)
            end = chunk.offset + chunk.stored_bytes
            decoded += chunk.raw_bytes
            need(decoded <= self.limits.decoded_bytes, "decoded bytes", "limit_exceeded")
            if self.chunks:
                self.chunks[-1].padding = chunk.offset - self.chunks[-1].offset - self.chunks[-1].stored_bytes
            else:
                before = self.data[HEADER_BYTES + self.directory_bytes:chunk.offset]
                need(not any(before), "padding after it is not zero", "trailing_bytes")
            self.sections[chunk.section].chunks[chunk.name] = chunk
            self.chunks.append(chunk)
        need(end == len(self.data), "bytes after the last chunk", "trailing_bytes")

    def _check_chunk(self, chunk, end):
        need = lambda good, reason, status="bad_directory": _need(good, status, chunk.place, reason)
        need(chunk.section in self.sections, "of a section that is not there")
        need(_is_name(chunk.name) and chunk.name not in self.sections[chunk.section].chunks, "its name")
        need(chunk.element != 0 and chunk.codec != 0, "element or codec is 0")
        chunk.decodable = chunk.element <= RGB9E5 and chunk.codec <= RANS
        need(not chunk.decodable or codec_allowed(chunk.codec, chunk.element), "the codec may not hold such elements")
        need(len(chunk.shape) <= MAX_RANK, "more than 4 extents")
        elements = 1
        for extent in chunk.shape:
            elements *= extent
        chunk.raw_bytes = elements * ELEMENT_BYTES[chunk.element] if chunk.decodable else 0
        need(elements < 1 << 64 and chunk.raw_bytes < 1 << 64, "its size")
        need(chunk.offset >= align_up(end) and chunk.offset % ALIGNMENT == 0, "its place", "bad_chunk")
        need(chunk.offset == align_up(end), "a gap before it", "trailing_bytes")
        need(chunk.offset + chunk.stored_bytes <= len(self.data), "leaves the file", "bad_chunk")
        if not chunk.decodable:
            return
        if chunk.codec == RAW:
            need(chunk.stored_bytes == chunk.raw_bytes, "stored and decoded size differ", "bad_chunk")
        else:
            need(0 < chunk.raw_bytes <= MAX_EXPANSION * chunk.stored_bytes, "cannot expand to its size", "bad_chunk")

    def stored(self, chunk):
        """The stored bytes, after their checksum and the padding behind them."""
        end = chunk.offset + chunk.stored_bytes
        stored = self.data[chunk.offset:end]
        _need(checksum(stored) == chunk.checksum, "bad_checksum", chunk.place, "")
        _need(not any(self.data[end:end + chunk.padding]), "trailing_bytes", chunk.place, "padding that is not zero")
        return stored

    def decode(self, chunk):
        """The elements as little-endian bytes."""
        stored = self.stored(chunk)
        _need(chunk.decodable, "too_new", chunk.place, f"element type {chunk.element}, codec {chunk.codec}")
        if chunk.codec == RAW:
            return stored
        need = lambda good, reason: _need(good, "bad_chunk", chunk.place, reason)
        if chunk.codec == RANS:
            need(len(stored) >= 4, "no size of its tables")
            end = 4 + struct.unpack_from("<I", stored)[0]
            need(end <= len(stored), "its tables leave it")
            tables = _rans_tables(_from_planes(self._frame(stored[4:end], RANS_CONTEXTS * 512, need), 2, False), need)
            return _from_rans(stored[end:], tables, chunk.raw_bytes, need)
        raw = self._frame(stored, chunk.raw_bytes, need)
        return raw if chunk.codec == ZSTD else _from_planes(raw, ELEMENT_BYTES[chunk.element], chunk.codec == ZSTD_DELTA_PLANES)

    @staticmethod
    def _frame(stored, raw_bytes, need):
        """What the one Zstandard frame holds that `stored` must be."""
        need(stored[:4] == b"\x28\xb5\x2f\xfd", "no Zstandard frame")
        need(_zstd.ZSTD_getFrameContentSize(stored, len(stored)) == raw_bytes, "the frame states another size, or none")
        need(_zstd.ZSTD_getDictID_fromFrame(stored, len(stored)) == 0, "needs a dictionary")
        need(_zstd.ZSTD_findFrameCompressedSize(stored, len(stored)) == len(stored), "not exactly one frame")
        buffer = ctypes.create_string_buffer(raw_bytes)
        need(_zstd.ZSTD_decompress(buffer, raw_bytes, stored, len(stored)) == raw_bytes, "does not decode")
        return buffer.raw

    def values(self, chunk):
        """The elements as numbers (F16 as floats, RGB9E5 packed), BYTES as bytes."""
        raw = self.decode(chunk)
        if chunk.element == BYTES:
            return raw
        if chunk.element == F16:
            return list(struct.unpack(f"<{len(raw) // 2}e", raw))
        values = array({U8: "B", I8: "b", U16: "H", I16: "h", U32: "I", F32: "f", RGB9E5: "I"}[chunk.element])
        values.frombytes(raw)
        if sys.byteorder == "big":
            values.byteswap()
        return values


def _from_planes(planes, size, differences):
    count = len(planes) // size
    raw = bytearray(len(planes))
    for k in range(size):
        raw[k::size] = planes[k * count:(k + 1) * count]
    if differences:
        value, mask = 0, (1 << 8 * size) - 1
        for i in range(count):
            value = (value + int.from_bytes(raw[i * size:(i + 1) * size], "little")) & mask
            raw[i * size:(i + 1) * size] = value.to_bytes(size, "little")
    return bytes(raw)


def _rans_tables(frequencies, need):
    """Per context, for each remainder of the state: symbol, its frequency, the first remainder that is its own. None for contexts without a table."""
    tables = []
    for context in range(RANS_CONTEXTS):
        table = []
        for symbol, frequency in enumerate(struct.unpack_from("<256H", frequencies, context * 512)):
            need(frequency <= RANS_SCALE - len(table), "frequencies that exceed their sum")
            table += [(symbol, frequency, len(table))] * frequency
        need(len(table) in (0, RANS_SCALE), "frequencies that do not reach their sum")
        tables.append(table or None)
    return tables


def _rans_context(size_sum):
    if size_sum < 2:
        return size_sum
    octave = size_sum.bit_length() - 1
    return 2 * octave + (size_sum >> octave - 1 & 1)


def _from_rans(streams, tables, count, need):
    need(len(streams) >= 4 * RANS_PARTS, "no sizes of its streams")
    sizes, at, each, out = struct.unpack_from("<4I", streams), 4 * RANS_PARTS, -(-count // RANS_PARTS), bytearray()
    for part, size in enumerate(sizes):
        need(size >= 4 and size % 2 == 0 and size <= len(streams) - at, "the size of a stream")
        state, words, next_word = struct.unpack_from("<I", streams, at)[0], struct.unpack_from(f"<{(size - 4) // 2}H", streams, at + 4), 0
        need(state >= 1 << 16, "a stream's first state")
        at += size
        window, size_sum = [0] * RANS_WINDOW, 0
        for i in range(min(count, each * (part + 1)) - min(count, each * part)):
            table = tables[_rans_context(size_sum)]
            need(table is not None, "a context without a table")
            symbol, frequency, first = table[state % RANS_SCALE]
            state = frequency * (state // RANS_SCALE) + state % RANS_SCALE - first
            out.append(symbol)
            size_sum -= window[i % RANS_WINDOW]
            window[i % RANS_WINDOW] = min(symbol, 256 - symbol)
            size_sum += window[i % RANS_WINDOW]
            if state < 1 << 16:
                need(next_word < len(words), "a stream that ends early")
                state = state << 16 | words[next_word]
                next_word += 1
        need(state == 1 << 16 and next_word == len(words), "a stream that does not end with its part")
    need(at == len(streams), "bytes after the streams")
    return bytes(out)


def _is_name(name):
    return re.fullmatch("[a-z0-9_]{1,63}", name) is not None


def _need(good, status, place, reason):
    if not good:
        raise ContainerError(status, place, reason)
