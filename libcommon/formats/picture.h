// Pictures: OpenEXR with layers and attributes; PNG for looking at.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "libcommon/base/provenance.h"
#include "libcommon/math/vec.h"

namespace tdpt {

/// Scene-linear Rec.709, row by row from the top left.
struct Picture {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;
  /// Share of each pixel that is covered; what lies behind is not in `pixels`. Empty: all of it.
  std::vector<float> alpha{};
};

/// A channel of numbers of 32 bits that lies in the caller's memory, which may be a part of larger
/// numbers: that of a pixel is `step` bytes after that of the one before.
struct WordChannel {
  std::string name;
  unsigned char* first;
  size_t step;
  enum Type { whole, real } type = whole;  ///< UINT, FLOAT
};
/// Channels of their own, by full name: a number of each pixel, row by row.
using Channels = std::map<std::string, std::vector<float>>;

struct ExrFile {
  Picture picture;                                ///< channels R G B
  std::map<std::string, Picture> layers;          ///< channels <name>.R <name>.G <name>.B
  std::map<std::string, std::string> attributes;  ///< string attributes of the header
  Channels channels;                              ///< others, written beside them; not read
  std::vector<WordChannel> words;                 ///< likewise
  int64_t pixels_without_data = 0;  ///< on reading: pixels outside the data window; they are black
};

/// Name of the string attribute that holds the provenance, its lines separated by '\n'.
inline constexpr const char* provenance_attribute = "provenance";
/// The provenance in `file`; empty when it has none.
Provenance provenance_of(const ExrFile& file);
/// Puts it there; an empty one takes no attribute.
void set_provenance(ExrFile& file, const Provenance& provenance);

/// Reads channels R G B (half or float, scan lines or tiles) of the first part that has them, and
/// its layers. The picture is the display window: an offset or larger data window is cropped and a
/// smaller one padded with black. At most 65536 pixels a side. Throws InputError.
ExrFile read_exr(const std::string& path);
/// The same for a file in memory; `name` stands in messages.
ExrFile parse_exr(std::string_view bytes, const std::string& name);
/// R, G and B alone of a file in memory, without its layers. Whether the display window is too
/// large is seen before anything is allocated. Where the data window leaves a part of it out,
/// InputError.
Picture parse_exr_picture(std::string_view bytes, const std::string& name, int most_width,
                          int most_height);
/// Names of all channels of the part that parse_exr() reads. Throws InputError.
std::vector<std::string> exr_channels(std::string_view bytes, const std::string& name);
/// Reads channels into the caller's memory, `width` x `height` of each. Throws
/// InputError where the file is of another size, or lacks one of them.
void parse_exr_words(std::string_view bytes, const std::string& name, int width, int height,
                     const std::vector<WordChannel>& words);
/// The file as bytes: float, ZIP, scan lines; a channel A where the picture has alpha, which no
/// reader here asks for. The same input gives the same bytes. Layers must be
/// as large as the picture; an attribute may not bear the name of one that OpenEXR defines with
/// another type.
std::string exr_bytes(const ExrFile& file);
/// 8-bit sRGB PNG of picture * 2^exposure, clipped, as bytes; with alpha where the picture has it,
/// colours then divided by it. NaN shows black.
std::string png_bytes(const Picture& picture, double exposure);
/// Exposure [stops] that puts the picture's 95th percentile luminance at white; 0 for a black one.
/// When more than 95 % of the pixels are black, the percentile is that of the others.
double auto_exposure(const Picture& picture);

}  // namespace tdpt
