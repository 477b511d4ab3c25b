// PNG files of 8-bit RGB, and RGB with alpha.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace tdpt {

/// The kind selects the compression: drawings have few colours.
enum class PngKind { photograph, drawing };
/// The file as bytes. `values`: 3 for each pixel, sRGB, or 4 with alpha, colours not premultiplied
/// by it; row by row from the top left. The same pixels give the same bytes.
std::string png_of_rgb8(int width, int height, const std::vector<uint8_t>& values,
                        PngKind kind = PngKind::photograph);

}  // namespace tdpt
