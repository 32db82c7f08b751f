#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace lightwell::scene::gltf {

/// What is wrong with the tables of a JPEG file; empty when a decoder may read it. Looked for, because stb_image of 2022 takes all of it on trust:
/// - a Huffman table with more than 256 symbols (ITU-T T.81, B.2.4.2): it writes behind its tables;
/// - a scan that names a Huffman or quantisation table that the file has not defined (B.2.3, B.2.2): it decodes to noise.
/// @param bytes  a file that begins with FF D8. Where its markers stop making sense the answer is empty: a decoder refuses it there.
std::string jpegTableDefect(std::span<const uint8_t> bytes);

}  // namespace lightwell::scene::gltf
