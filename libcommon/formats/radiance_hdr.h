// Pictures of the Radiance system (.hdr, .pic): scan lines of RGBE, flat or run-length coded, as
// the system's filefmts document tells.
#pragma once
#include <string>
#include <string_view>

#include "libcommon/formats/picture.h"

namespace tdpt {

/// Whether the file begins as one does.
bool is_radiance_hdr(std::string_view bytes);

/// A file in memory; `name` stands in messages. Values are divided by its EXPOSURE and COLORCORR
/// lines, which say what they were multiplied by. Rows from the top, columns from the left
/// ("-Y H +X W"); that it is larger than `most_width` x `most_height` is seen before anything is
/// allocated. Throws InputError.
Picture parse_radiance_hdr(std::string_view bytes, const std::string& name, int most_width,
                           int most_height);

}  // namespace tdpt
