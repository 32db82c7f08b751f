#pragma once

#include <cstdint>
#include <span>

namespace lightwell::scene::gltf {

/// Whether every Huffman table that a decoder meets in a JPEG file has room for its symbols: the counts of its 16 code lengths add up to at most 256.
/// (ITU-T T.81, B.2.4.2; stb_image of 2022 takes the sum on trust and writes behind its tables.)
/// @param bytes  a file that begins with FF D8. Where its markers stop making sense the answer is true: a decoder refuses it there.
bool jpegTablesFit(std::span<const uint8_t> bytes);

}  // namespace lightwell::scene::gltf
