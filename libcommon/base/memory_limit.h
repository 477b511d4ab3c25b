// The most memory that reading one file may take: --max-memory. Readers ask before they take it
// where the file's size is no bound: of what is compressed, and of what stands in many places.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tdpt {

/// Bytes; three quarters of the machine's memory until it is set.
uint64_t memory_limit();
/// Call once, before anything is read.
void limit_memory(uint64_t bytes);

/// "1.5 GiB", "700 bytes".
std::string size_words(uint64_t bytes);
/// Bytes of "1500", "200M", "1.5G": K, M, G and T are powers of 1024. None for any other text.
std::optional<uint64_t> parse_size(std::string_view text);

/// Throws InputError with `file` and `place` where `what`, in plural ("3 x 2 pixels"), takes more
/// bytes than the limit.
void expect_memory(const std::string& file, const std::string& place, const std::string& what,
                   uint64_t bytes);

}  // namespace tdpt
