// Bounds on what an OpenEXR file may declare. The library allocates what a header declares before
// it has read a pixel, and accepts an empty chunk, leaving its pixels unchanged: both are refused
// here.
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
