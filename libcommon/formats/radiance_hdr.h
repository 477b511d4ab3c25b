// Pictures of the Radiance system (.hdr, .pic): scan lines of RGBE, flat or run-length encoded, as
// in Radiance's filefmts document.
#pragma once
#include <string>
#include <string_view>

#include "libcommon/formats/picture.h"

namespace tdpt {

/// Whether the bytes begin with the signature of one.
bool is_radiance_hdr(std::string_view bytes);

/// A file in memory; `name` is used in messages. Values are divided by its EXPOSURE and COLORCORR
/// lines, the factors already applied to them, and become Rec.709 by its PRIMARIES. Orientation
/// must be "-Y H +X W". A size above `most_width` x `most_height` is refused before allocation.
/// Throws InputError.
Picture parse_radiance_hdr(std::string_view bytes, const std::string& name, int most_width,
                           int most_height);

}  // namespace tdpt
