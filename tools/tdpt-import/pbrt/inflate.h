// Files compressed by gzip.
#pragma once
#include <string>
#include <string_view>

namespace tdpt::foreign::pbrt {

bool is_gzip(std::string_view bytes);
/// Throws InputError with `name` for broken streams and for more than 1 GiB.
std::string inflated(std::string_view bytes, const std::string& name);

}  // namespace tdpt::foreign::pbrt
