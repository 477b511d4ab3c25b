// --max-memory: the most memory that reading one file, or one result, may take. Programs check
// before they allocate, wherever the file's size is no bound: compressed data, and data that is
// referenced many times.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tdpt {

/// Bytes; three quarters of the machine's memory unless set.
uint64_t memory_limit();
/// Call once, before anything is read.
void limit_memory(uint64_t bytes);

/// "1.5 GiB", "700 bytes".
std::string size_words(uint64_t bytes);
/// Bytes of "1500", "200M", "1.5G": K, M, G and T are powers of 1024. Empty for any other text.
std::optional<uint64_t> parse_size(std::string_view text);

/// Throws InputError with `file` and `place` if `what`, a plural noun ("3 x 2 pixels"), takes more
/// bytes than the limit.
void expect_memory(const std::string& file, const std::string& place, const std::string& what,
                   uint64_t bytes);
/// Throws UsageError if what the options ask for, likewise, takes more: "640 x 480 pixels (--width,
/// --height)".
void expect_memory(const std::string& what, uint64_t bytes);

}  // namespace tdpt
