#include "libcommon/base/memory_limit.h"

#include <array>
#include <atomic>
#include <charconv>
#include <cmath>

#include <unistd.h>

#include <fmt/format.h>

#include "libcommon/base/counted.h"
#include "libcommon/base/error.h"
#include "libcommon/base/number_words.h"

namespace tdpt {
namespace {

constexpr std::string_view kPrefixes = "KMGT";

uint64_t three_quarters_of_the_machine() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), size = ::sysconf(_SC_PAGESIZE);
  if (pages <= 0 || size <= 0) return uint64_t{1} << 32;
  return static_cast<uint64_t>(pages) * static_cast<uint64_t>(size) / 4 * 3;
}

std::atomic<uint64_t>& limit() {
  static std::atomic<uint64_t> bytes{three_quarters_of_the_machine()};
  return bytes;
}

// Empty if they are within the limit.
std::string excess_of(const std::string& what, uint64_t bytes) {
  if (bytes <= limit()) return "";
  return fmt::format("{} take {} of memory, expected at most the {} of --max-memory", what,
                     size_words(bytes), size_words(limit()));
}

}  // namespace

uint64_t memory_limit() {
  return limit();
}

void limit_memory(uint64_t bytes) {
  limit() = bytes;
}

std::string size_words(uint64_t bytes) {
  if (bytes < 1024) return counted(bytes, "byte");
  double size = static_cast<double>(bytes) / 1024;
  size_t prefix = 0;
  for (; size >= 1000 && prefix + 1 < kPrefixes.size(); ++prefix) size /= 1024;
  return fmt::format("{} {}iB", number_words(size), kPrefixes[prefix]);
}

std::optional<uint64_t> parse_size(std::string_view text) {
  double value = 0;
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value, std::chars_format::fixed);
  if (error != std::errc() || last - end > 1) return {};
  if (end != last) {
    const size_t prefix = kPrefixes.find(*end);
    if (prefix == kPrefixes.npos) return {};
    value = std::ldexp(value, 10 * (static_cast<int>(prefix) + 1));
  }
  if (!(value >= 1 && value < 0x1p63)) return {};
  return static_cast<uint64_t>(value);
}

void expect_memory(const std::string& file, const std::string& place, const std::string& what,
                   uint64_t bytes) {
  if (const std::string excess = excess_of(what, bytes); !excess.empty())
    throw InputError(file, place, excess);
}

void expect_memory(const std::string& what, uint64_t bytes) {
  if (const std::string excess = excess_of(what, bytes); !excess.empty()) throw UsageError(excess);
}

}  // namespace tdpt
