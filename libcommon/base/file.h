// Whole files in memory; "-" is standard input.
#pragma once
#include <string>

namespace tdpt {

/// Contents of the file `path`, or of standard input for "-". Of a pipe or device that begins with
/// what no program here can read, which may never end, the beginning alone. Throws InputError if it
/// cannot be read, or if that takes more than memory_limit().
std::string read_file(const std::string& path);

/// How messages name `path`: the path itself, or "(standard input)" for "-".
std::string display_name(const std::string& path);

}  // namespace tdpt
