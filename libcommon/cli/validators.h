// CLI11 validators for the values of options. Internal to this room.
#pragma once
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace tdpt::cli {

/// From 0 to 2^64 - 1. CLI11 alone reads -1 and too large numbers as 2^64 - 1.
CLI::Validator whole_number();

/// Bytes, as parse_size() reads them.
CLI::Validator size();

/// Not empty: an unset shell variable must not count as an option that was not given.
CLI::Validator some_text();

/// One of `words`; the error suggests the nearest.
CLI::Validator one_of(const std::vector<std::string>& words);

/// std::to_string and CLI11's own text would print 1e18 in full; people read these bounds.
template <class T>
CLI::Validator within(T lowest, T highest) {
  return CLI::Validator(
      [lowest, highest](std::string& text) {
        T value{};
        if (!CLI::detail::lexical_cast(text, value) || !(value >= lowest && value <= highest))
          return fmt::format("'{}' given, expected a number from {} to {}", text, lowest, highest);
        return std::string();
      },
      "");
}

}  // namespace tdpt::cli
