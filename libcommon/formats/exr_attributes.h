// Checks that the attributes of an OpenEXR header have plausible sizes and lie within the file.
#pragma once
#include <map>
#include <string>
#include <string_view>

namespace tdpt {

/// String attribute with the version of our format; absent in pictures of other programs.
inline constexpr const char* kVersionAttribute = "tdptFormat";

/// Describes the first attribute, of all headers, whose declared size does not match its type or
/// contents; "" if there is none. The OpenEXR library allocates whatever size an attribute declares
/// before reading it, and reads past its end: it must not see such a file.
std::string fault_of_exr_attributes(std::string_view bytes);
/// Value of the attribute `compression` of each header [Imf::Compression, and what comes after].
std::string exr_compressions(std::string_view bytes);
/// Offset where the headers of such a file end and the tables of offsets begin.
size_t end_of_exr_headers(std::string_view bytes);
/// The attributes of type string in the header of a file with one part, read from its beginning
/// alone; none if it is no such file or cannot be read.
std::map<std::string, std::string> string_attributes_of_file(const std::string& path);

}  // namespace tdpt
