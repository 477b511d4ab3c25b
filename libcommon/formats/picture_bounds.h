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

/// Describes the first attribute, of all headers, whose declared size does not match its type or
/// contents; "" if there is none.
std::string fault_of_exr_attributes(std::string_view bytes);
/// Value of the attribute `compression` of each header [Imf::Compression, and what comes after].
std::string exr_compressions(std::string_view bytes);
/// Offset where the headers of such a file end and the tables of offsets begin.
size_t end_of_exr_headers(std::string_view bytes);

}  // namespace tdpt

namespace tdpt::exr {

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
