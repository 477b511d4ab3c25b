// Content hashes that tie the files of one pipeline together.
#pragma once
#include <string>
#include <string_view>

namespace tdpt {

/// 128-bit content hash (XXH3) of `bytes` as 32 lower-case hexadecimal digits. Detects mix-ups, is
/// no protection against malice.
std::string content_hash(std::string_view bytes);

/// The same of the file `path`, which is not held in memory. Throws InputError when it cannot be
/// read.
std::string content_hash_of_file(const std::string& path);

}  // namespace tdpt
