// Content hashes that tie the files of one pipeline together.
#pragma once
#include <string>
#include <string_view>

namespace tdpt {

/// 128-bit content hash (XXH3) of `bytes` as 32 lower-case hexadecimal digits. It detects mix-ups;
/// it is not cryptographic.
std::string content_hash(std::string_view bytes);

/// The same for the file `path`, read in pieces. Throws InputError if it cannot be read.
std::string content_hash_of_file(const std::string& path);

}  // namespace tdpt
