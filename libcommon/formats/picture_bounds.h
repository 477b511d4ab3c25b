// What an OpenEXR file may declare. The library makes room for what a header says before it has
// seen a pixel, and takes a chunk without bytes for pixels that it leaves as they were: both are
// refused here.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartInputFile.h>

#include "libcommon/math/vec.h"

namespace tdpt::exr {

inline constexpr int largest_side = 65536;

/// Width and height of a window; 0 when it is empty.
Vec3<int64_t> extent(const Imath::Box2i& box);
/// Rows that are read at once: those of a chunk or tile, of several where rows are short, so that a
/// file cut short fails before its picture is allocated. `layers`: of three floats a pixel.
int rows_at_once(const Imf::Header& header, size_t layers);

/// Throws InputError where the part of this header has more pixels than `bytes`, the whole file,
/// can hold, or asks for more than memory_limit() when `layers` of R, G and B are read.
void check_size(const Imf::Header& header, size_t layers, std::string_view bytes,
                const std::string& name);
/// Throws InputError where a chunk of the part has no bytes, or lies nowhere.
void check_chunks(Imf::MultiPartInputFile& file, int part, std::string_view bytes,
                  const std::string& name);

}  // namespace tdpt::exr
