// Reads text files of whitespace-separated words, line by line with strict numbers: every error
// message names the line, what was found and what was expected.
#pragma once
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/format_version.h"

namespace tdpt {

class TextLines {
 public:
  /// `file` is the name in messages. Keeps a view of `text`.
  TextLines(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  /// Refuses binary files at once, which would otherwise be quoted at length; `expected` describes
  /// the right kind of file.
  void expect_text(const std::string& expected) const {
    if (text_.find('\0') != std::string_view::npos)
      fail_file("is a binary file, expected " + expected);
  }

  /// Refuses a last line without an end: of a number that is cut short its digits are left.
  void expect_whole_lines() const {
    if (!text_.empty() && text_.back() != '\n') fail_file("is cut short: its last line has no end");
  }

  /// Moves to the next line that is not blank; false at the end of the text.
  bool next() {
    while (at_ < text_.size()) {
      const size_t end = std::min(text_.find('\n', at_), text_.size());
      line_ = text_.substr(at_, end - at_);
      at_ = end + 1;
      ++number_;
      if (more()) return true;
    }
    return false;
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(file_, "line " + std::to_string(number_), message);
  }
  [[noreturn]] void fail_file(const std::string& message) const {
    throw InputError(file_, "", message);
  }

  /// Next word of the line; empty at the end.
  std::string_view word() {
    skip_blanks();
    size_t size = 0;
    while (size < line_.size() && !is_blank(line_[size])) ++size;
    const std::string_view w = line_.substr(0, size);
    line_.remove_prefix(size);
    return w;
  }

  bool more() {
    skip_blanks();
    return !line_.empty();
  }

  /// The rest of the line, trimmed.
  std::string_view rest() {
    skip_blanks();
    size_t size = line_.size();
    while (size > 0 && is_blank(line_[size - 1])) --size;
    return line_.substr(0, size);
  }

  /// A whole number within [lowest, highest]; `what` names it in the message.
  int64_t integer(const char* what, int64_t lowest, int64_t highest) {
    const std::string_view w = word();
    int64_t value = 0;
    const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
    if (w.empty() || error != std::errc() || end != w.data() + w.size() || value < lowest ||
        value > highest)
      fail(found(w) + " as " + what + ", expected a whole number from " + std::to_string(lowest) +
           " to " + std::to_string(highest));
    return value;
  }

  /// A finite number.
  double real(const char* what) {
    const std::string_view w = word();
    double value = 0;
    const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
    if (w.empty() || error != std::errc() || end != w.data() + w.size() || !std::isfinite(value))
      fail(found(w) + " as " + what + ", expected a finite number");
    return value;
  }

  /// The rest of the line must be the supported version of the format.
  void expect_version(int read) {
    if (const std::string fault = fault_of_version(rest(), read); !fault.empty()) fail(fault);
  }

  /// The line must end here.
  void end() {
    const std::string_view w = word();
    if (!w.empty()) fail(found(w) + " found, expected the end of the line");
  }

  static std::string found(std::string_view w) {
    return w.empty() ? "nothing" : "'" + shown(w, 40) + "'";
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
  void skip_blanks() {
    size_t blanks = 0;
    while (blanks < line_.size() && is_blank(line_[blanks])) ++blanks;
    line_.remove_prefix(blanks);
  }

  std::string_view text_, line_;
  std::string file_;
  size_t at_ = 0;
  uint64_t number_ = 0;
};

}  // namespace tdpt
