#include "libcommon/base/words.h"

#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

namespace tdpt {

std::string number_words(double value, int digits) {
  const std::string short_form = fmt::format("{:.{}g}", value, digits);
  const double rounded = std::strtod(short_form.c_str(), nullptr);
  const double size = std::abs(rounded);
  // Printing the rounded value with its shortest digits gives the significant digits, padded with
  // zeros.
  return size >= 1e-4 && size < 1e7 ? fmt::format("{}", rounded) : short_form;
}

std::string duration_words(double seconds) {
  if (seconds < 100) return number_words(seconds, 2) + " s";
  if (seconds < 6000) return number_words(seconds / 60, 2) + " minutes";
  return number_words(seconds / 3600, 2) + " hours";
}

std::string percent_words(double share, int digits) {
  return number_words(100 * share, digits) + " %";
}

std::string shell_quoted(const std::string& word) {
  const char* const plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

}  // namespace tdpt
