// Pictures of other renderers' scenes: decoding, scaling, and what glTF wants of them.
#pragma once
#include <string>
#include <string_view>

#include "tools/tdpt-import/described.h"

namespace tdpt::foreign {

/// Texels of an image as linear or encoded numbers.
struct Texels {
  int width = 0, height = 0;
  bool is_8bit = false;  ///< values were bytes: 0..1, encoded as in the file
  std::vector<Rgb> rgb{};
  std::vector<float> alpha{};  ///< empty: 1 everywhere

  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }
};

/// Decodes PNG, JPEG, TGA, BMP, PNM, PSD, GIF, Radiance .hdr, PFM and OpenEXR. Throws InputError.
Texels decode(std::string_view bytes, const std::string& name);
/// The texels of an image, decoded from its file if it has one.
Texels decode(const Image& image, const Source& source);

/// A colour of an 8-bit file, 0..1, decoded from sRGB.
Rgb linear_of(const Rgb& coded);

/// A PNG or JPEG without what glTF does not allow and readers ignore: of a PNG the pixels alone, in
/// square pixels without colour profiles, of a JPEG everything but its profile and density. Other
/// bytes are returned as they are.
std::string plain_file(const std::string& bytes);

}  // namespace tdpt::foreign
