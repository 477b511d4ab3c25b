#include "tools/tdpt-import/pbrt/tokens.h"

#include <filesystem>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/pbrt/inflate.h"

namespace tdpt::foreign::pbrt {
namespace {

constexpr size_t kDeepest = 16;  // the scene itself and 15 included files
constexpr size_t kMostFiles = 10000, kMostBytes = size_t{1} << 33;  // files that repeat count again

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}
bool ends_word(char c) {
  return is_space(c) || c == '"' || c == '[' || c == ']' || c == '#';
}

char unescaped(char c) {
  switch (c) {
    case 'b':
      return '\b';
    case 'f':
      return '\f';
    case 'n':
      return '\n';
    case 'r':
      return '\r';
    case 't':
      return '\t';
    default:
      return c;
  }
}

}  // namespace

Tokens::Tokens(std::string_view text, std::string shown_name) {
  open_.push_back(std::make_unique<File>());
  open_.back()->shown = std::move(shown_name);
  open_.back()->text = text;
}

Place Tokens::place() const {
  return last_;
}

std::optional<Token> Tokens::next() {
  if (again_) {
    std::optional<Token> token = std::move(again_);
    again_.reset();
    return token;
  }
  while (!open_.empty()) {
    File& f = *open_.back();
    while (f.at < f.text.size()) {
      const char c = f.text[f.at];
      if (c == '\n') ++f.line;
      if (is_space(c)) {
        ++f.at;
        continue;
      }
      if (c == '#') {
        while (f.at < f.text.size() && f.text[f.at] != '\n') ++f.at;
        continue;
      }
      last_ = {f.shown, "line " + std::to_string(f.line)};
      if (c == '[' || c == ']') {
        ++f.at;
        return Token{c == '[' ? Token::Kind::open : Token::Kind::close, std::string(1, c), f.line};
      }
      if (c == '"') {
        ++f.at;
        return Token{Token::Kind::quoted, quoted(f), f.line};
      }
      const size_t from = f.at;
      while (f.at < f.text.size() && !ends_word(f.text[f.at])) ++f.at;
      return Token{Token::Kind::word, std::string(f.text.substr(from, f.at - from)), f.line};
    }
    if (open_.size() == 1) return {};
    open_.pop_back();
  }
  return {};
}

std::string Tokens::quoted(File& f) {
  std::string out;
  while (f.at < f.text.size()) {
    char c = f.text[f.at++];
    if (c == '"') return out;
    if (c == '\n') break;
    if (c == '\\') {
      if (f.at == f.text.size() || f.text[f.at] == '\n') break;
      c = unescaped(f.text[f.at++]);
    }
    out += c;
  }
  Source::fail(last_, "a string does not end on its line");
}

void Tokens::include(Source& source, const std::string& given) {
  const Place place = last_;
  const std::string name = std::filesystem::path(given).lexically_normal().string();
  for (const auto& file : open_)
    if (file->name == name || source.shown_name(name) == file->shown)
      Source::fail(place, "\"" + shown(name) + "\" includes itself");
  if (open_.size() >= kDeepest) Source::fail(place, "more than 15 files include each other");
  auto file = std::make_unique<File>();
  file->name = name;
  file->shown = source.shown_name(name);
  file->bytes = source.read(name, place);
  if (is_gzip(file->bytes)) file->bytes = inflated(file->bytes, file->shown);
  file->text = file->bytes;
  bytes_ += file->bytes.size();
  if (++files_ > kMostFiles || bytes_ > kMostBytes)
    Source::fail(place, "more files are included than 10000, or more than 8 GiB");
  open_.push_back(std::move(file));
}

}  // namespace tdpt::foreign::pbrt
