// What an OpenEXR file may declare, checked before the library sees it: the library allocates what
// a header declares before it has read a pixel, reads past an attribute's end, and accepts an empty
// chunk, leaving its pixels unchanged. Internal to the reader and writer of pictures.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartInputFile.h>

#include "libcommon/math/vec.h"

namespace tdpt {

/// String attribute with the version of our format; absent in pictures of other programs.
inline constexpr const char* kVersionAttribute = "tdptFormat";

}  // namespace tdpt

namespace tdpt::exr {

/// The attributes of all headers of a file.
struct Headers {
  /// Describes the first attribute whose declared size does not match its type or contents, or says
  /// that the file ends; "" if all are sound.
  std::string fault{};
  size_t end = 0;              ///< where the headers end and the tables of offsets begin
  std::string compressions{};  ///< one byte of each header [Imf::Compression, and what comes after]
  std::map<std::string, std::string> strings{};
};
Headers headers_of(std::string_view bytes);

inline constexpr int largest_side = 65536;

/// Width and height of a window; 0 when it is empty.
Vec3<int64_t> extent(const Imath::Box2i& box);
/// Rows that are read at once: those of a chunk or tile, or of several if rows are short. So a
/// truncated file fails before its picture is allocated. `layers`: of three floats per pixel.
int rows_at_once(const Imf::Header& header, size_t layers);

/// Throws InputError if the part with this header has more pixels than `bytes`, the whole file, can
/// hold, or needs more than memory_limit() when `layers` of R, G and B are read.
void check_size(const Imf::Header& header, size_t layers, std::string_view bytes,
                const std::string& name);
/// Throws InputError if a chunk of the part is empty or lies outside the file.
void check_chunks(Imf::MultiPartInputFile& file, int part, std::string_view bytes,
                  const std::string& name);

}  // namespace tdpt::exr
