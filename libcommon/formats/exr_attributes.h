// Whether the attributes of an OpenEXR header are as long as they say, and lie in the file.
#pragma once
#include <string>
#include <string_view>

namespace tdpt {

/// What is wrong with the first attribute, of all headers, whose size is not that of its type or of
/// what it holds; "" when none is. The library makes room for whatever size an attribute declares
/// before it reads it, and reads on where its values end: it must see none of these.
std::string fault_of_exr_attributes(std::string_view bytes);
/// Where the headers of such a file end, and the tables of offsets begin.
size_t end_of_exr_headers(std::string_view bytes);

}  // namespace tdpt
