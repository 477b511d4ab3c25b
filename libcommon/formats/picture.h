// Pictures: OpenEXR with layers and attributes; PNG for looking at.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"

namespace tdpt {

/// Scene-linear Rec.709, row by row from the top left.
struct Picture {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;
};

struct ExrFile {
  Picture picture;                           ///< channels R G B
  std::map<std::string, Picture> layers;     ///< channels <name>.R <name>.G <name>.B
  std::map<std::string, std::string> attributes;  ///< string attributes of the header
};

/// Reads channels R G B (half or float, scan lines or tiles, any data window). Throws InputError.
ExrFile read_exr(const std::string& path);
/// The file as bytes: float, ZIP, scan lines.
std::string exr_bytes(const ExrFile& file);
/// 8-bit sRGB PNG of picture * 2^exposure, clipped, as bytes.
std::string png_bytes(const Picture& picture, double exposure);
/// Exposure that puts the picture's 95th percentile luminance near white.
double auto_exposure(const Picture& picture);

}  // namespace tdpt
