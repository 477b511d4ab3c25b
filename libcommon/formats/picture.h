// Pictures: OpenEXR with layers and attributes; PNG for viewing; Radiance.
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
  /// Coverage of each pixel; `pixels` does not contain what lies behind. Empty: 1 everywhere.
  std::vector<float> alpha{};
};

/// A channel of 32-bit numbers in the caller's memory, possibly parts of larger numbers:
/// consecutive pixels are `step` bytes apart.
struct WordChannel {
  std::string name;
  unsigned char* first;
  size_t step;
  enum Type { whole, real } type = whole;  ///< UINT, FLOAT
};
/// Additional channels by full name: one number per pixel, row by row.
using Channels = std::map<std::string, std::vector<float>>;

struct ExrFile {
  Picture picture;                                ///< channels R G B
  std::map<std::string, Picture> layers;          ///< channels <name>.R <name>.G <name>.B
  std::map<std::string, std::string> attributes;  ///< string attributes of the header
  Channels channels;                              ///< additional channels, written only
  std::vector<WordChannel> words;                 ///< likewise
  int64_t pixels_without_data = 0;  ///< when reading: black pixels outside the data window
};

/// Name of the string attribute with the provenance, its lines separated by '\n'.
inline constexpr const char* provenance_attribute = "provenance";
/// Name of the string attribute that filtered pictures have: the kind of filter.
inline constexpr const char* denoiser_attribute = "denoiser";
/// Name of the string attribute that films have, which are samples to be merged or continued.
inline constexpr const char* film_attribute = "film";
/// The provenance of `file`; empty if it has none.
Provenance provenance_of(const ExrFile& file);
/// Sets it; an empty provenance adds no attribute.
void set_provenance(ExrFile& file, const Provenance& provenance);

/// Reads channels R G B (half or float, scan lines or tiles) of the first part that has them, A if
/// it is there, and its layers. Colours of other primaries (attribute `chromaticities`) become
/// Rec.709 [primaries.h]. The picture is the display window: a larger or offset data window is
/// cropped, a smaller one padded with black. At most 65536 pixels a side. Throws InputError.
ExrFile read_exr(const std::string& path);
/// The same for a file in memory; `name` is used in messages.
ExrFile parse_exr(std::string_view bytes, const std::string& name);
/// R, G, B and A only, of a file in memory, without layers: light or reflectance, so that colours
/// of other primaries become such within the gamut of Rec.709. Checks the size of the display
/// window before allocating. Throws InputError if the data window does not cover it.
Picture parse_exr_picture(std::string_view bytes, const std::string& name, int most_width,
                          int most_height);
/// Names of all channels of the part that parse_exr() reads. Throws InputError.
std::vector<std::string> exr_channels(std::string_view bytes, const std::string& name);
/// Reads channels into the caller's memory, `width` x `height` values each. Throws InputError if
/// the file has another size or lacks one of them.
void parse_exr_words(std::string_view bytes, const std::string& name, int width, int height,
                     const std::vector<WordChannel>& words);

/// The file as bytes, in scan lines; with a channel A if the picture has alpha. The same input
/// gives the same bytes. Layers must have the picture's size; an attribute must not have the name
/// of one that OpenEXR defines with another type.
std::string exr_bytes(const ExrFile& file);
/// 8-bit sRGB PNG, clipped, as bytes; with alpha if the picture has it, colours divided by it. NaN
/// becomes black. Rendered pictures are shown by preview_bytes() [tone.h].
std::string png_bytes(const Picture& picture);

// Pictures of the Radiance system (.hdr, .pic): scan lines of RGBE, flat or run-length encoded, as
// in Radiance's filefmts document.

/// Whether the bytes begin with the signature of one.
bool is_radiance_hdr(std::string_view bytes);

/// A file in memory; `name` is used in messages. Values are divided by its EXPOSURE and COLORCORR
/// lines, the factors already applied to them, and become Rec.709 by its PRIMARIES. Orientation
/// must be "-Y H +X W". A size above `most_width` x `most_height` is refused before allocation.
/// Throws InputError.
Picture parse_radiance_hdr(std::string_view bytes, const std::string& name, int most_width,
                           int most_height);

/// The attributes of type string in the header of a file with one part, read from its beginning
/// alone; none if it is no such file or cannot be read.
std::map<std::string, std::string> string_attributes_of_file(const std::string& path);

}  // namespace tdpt
