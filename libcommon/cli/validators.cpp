#include "libcommon/cli/validators.h"

#include <cerrno>
#include <cstdint>
#include <cstdlib>

#include "libcommon/base/memory_limit.h"
#include "libcommon/cli/nearest.h"

namespace tdpt::cli {

CLI::Validator whole_number() {
  return CLI::Validator(
      [](std::string& text) {
        const bool digits =
            !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
        errno = 0;
        if (digits) std::strtoull(text.c_str(), nullptr, 10);
        if (digits && errno == 0) return std::string();
        return fmt::format("'{}' given, expected a number from 0 to {}", text, ~uint64_t{0});
      },
      "");
}

CLI::Validator size() {
  return CLI::Validator(
      [](std::string& text) {
        if (parse_size(text)) return std::string();
        return fmt::format("'{}' given, expected bytes, or a number with K, M, G or T", text);
      },
      "");
}

CLI::Validator some_text() {
  return CLI::Validator(
      [](std::string& text) {
        return text.empty() ? std::string("'' given, expected a value") : std::string();
      },
      "");
}

CLI::Validator one_of(const std::vector<std::string>& words) {
  return CLI::Validator(
      [words](std::string& text) {
        for (const std::string& word : words)
          if (text == word) return std::string();
        const std::string meant = nearest(text, words);
        return fmt::format("'{}' given, expected one of {}{}", text, fmt::join(words, ", "),
                           meant.empty() ? "" : " (did you mean " + meant + "?)");
      },
      "");
}

}  // namespace tdpt::cli
