// PNG files of 8-bit RGB, and RGB with alpha.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace tdpt {

/// The file as bytes; `rgb`: 3 * width * height values, sRGB, row by row from the top left. The
/// same pixels give the same bytes. The kind selects the compression: drawings have few colours.
enum class PngKind { photograph, drawing };
std::string png_of_rgb8(int width, int height, const std::vector<uint8_t>& rgb,
                        PngKind kind = PngKind::photograph);
/// A photograph; `rgba`: 4 * width * height values, colours not premultiplied by alpha.
std::string png_of_rgba8(int width, int height, const std::vector<uint8_t>& rgba);

}  // namespace tdpt
