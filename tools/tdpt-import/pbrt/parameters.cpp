#include "tools/tdpt-import/pbrt/parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <zlib.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"

namespace tdpt::foreign::pbrt {
namespace {

// ---- Files compressed by gzip ----

constexpr size_t kMost = size_t{1} << 30;
constexpr size_t kStep = size_t{1} << 16;
constexpr int kGzip = 16 + MAX_WBITS;

}  // namespace

bool is_gzip(std::string_view bytes) {
  return bytes.substr(0, 2) == "\x1f\x8b";
}

std::string inflated(std::string_view bytes, const std::string& name) {
  if (bytes.size() > std::numeric_limits<uInt>::max())
    throw InputError(name, "", "more than 4 GiB of compressed bytes");
  z_stream stream{};
  if (inflateInit2(&stream, kGzip) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  // zlib does not write to its input; its interface only lacks the const.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string out;
  int status = Z_OK;
  while (status == Z_OK) {
    if (out.size() >= kMost) throw InputError(name, "", "more than 1 GiB when inflated");
    const size_t before = out.size();
    out.resize(before + kStep);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    stream.avail_out = static_cast<uInt>(kStep);
    status = inflate(&stream, Z_NO_FLUSH);
    out.resize(out.size() - stream.avail_out);
  }
  if (status == Z_MEM_ERROR) throw std::bad_alloc();
  if (status != Z_STREAM_END) throw InputError(name, "", "the compressed bytes are broken");
  return out;
}

namespace {

// ---- Words ----

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

namespace {

// ---- Parameter lists ----

// Type and name of "type name".
void declare(Parameter& p, const std::string& words) {
  const char* spaces = " \t";
  const size_t type = words.find_first_not_of(spaces);
  const size_t type_end = words.find_first_of(spaces, type);
  const size_t name = words.find_first_not_of(spaces, type_end);
  if (type == std::string::npos || type_end == std::string::npos || name == std::string::npos)
    Source::fail(p.place, fmt::format("\"{}\" is not a parameter's type and name", shown(words)));
  p.type = words.substr(type, type_end - type);
  p.name = words.substr(name, words.find_first_of(spaces, name) - name);
}

void add(Parameter& p, Token&& token, const Place& place) {
  if (token.kind == Token::Kind::quoted) {
    if (p.type == "bool") {  // pbrt-v3 quotes them
      if (token.text != "true" && token.text != "false")
        Source::fail(place, fmt::format("\"{}\" is neither true nor false", shown(token.text)));
      p.flags.push_back(token.text == "true");
    } else {
      p.strings.push_back(std::move(token.text));
    }
  } else if (token.text == "true" || token.text == "false") {
    p.flags.push_back(token.text == "true");
  } else {
    p.numbers.push_back(number_of(token, place));
  }
  if (!p.numbers.empty() + !p.strings.empty() + !p.flags.empty() > 1)
    Source::fail(place, fmt::format("values of different kinds in \"{}\"", shown(p.name)));
}

bool is_one_of(const std::string& type, std::initializer_list<const char*> types) {
  return std::any_of(types.begin(), types.end(), [&](const char* t) { return type == t; });
}

}  // namespace

double number_of(const Token& token, const Place& place) {
  const std::string& t = token.text;
  const char* from = t.data() + (t.size() > 1 && t[0] == '+' ? 1 : 0);
  double value = 0;
  const auto [end, error] = std::from_chars(from, t.data() + t.size(), value);
  const size_t exponent = t.find_first_of("eE");
  const bool is_tiny = error == std::errc::result_out_of_range && exponent != std::string::npos &&
                       t[exponent + 1] == '-';
  if (token.kind != Token::Kind::word || end != t.data() + t.size() ||
      (error != std::errc() && !is_tiny) || !std::isfinite(value))
    Source::fail(place, fmt::format("\"{}\" is not a number", shown(t)));
  return is_tiny ? 0 : value;
}

Parameters Parameters::read(Tokens& tokens, Source& source, const Key& holder,
                            const std::string& whose) {
  Parameters list(tokens.place());
  while (std::optional<Token> token = tokens.next()) {
    if (token->kind != Token::Kind::quoted) {
      tokens.back(std::move(*token));
      break;
    }
    Parameter p;
    p.place = tokens.place();
    declare(p, token->text);
    std::optional<Token> value = tokens.next();
    const bool in_brackets = value && value->kind == Token::Kind::open;
    if (in_brackets) value = tokens.next();
    while (value && value->kind != Token::Kind::close) {
      if (value->kind == Token::Kind::open)
        Source::fail(tokens.place(), "a '[' within a list of values");
      add(p, std::move(*value), tokens.place());
      if (!in_brackets) break;
      value = tokens.next();
    }
    if (!value) Source::fail(p.place, fmt::format("no end of the values of \"{}\"", shown(p.name)));
    if (!in_brackets && value->kind == Token::Kind::close)
      Source::fail(tokens.place(), "a ']' without its '['");
    p.key = source.enter(
        holder, p.place,
        fmt::format("\"{} {}\" of {} is not read", shown(p.type), shown(p.name), whose));
    list.all.push_back(std::move(p));
  }
  return list;
}

void Parameters::defaults(const std::vector<Parameter>& of_attribute) {
  own_ = all.size();
  all.insert(all.end(), of_attribute.rbegin(), of_attribute.rend());
}

const Parameter* Parameters::find(const std::string& name,
                                  std::initializer_list<const char*> types) const {
  const Parameter* first = nullptr;
  for (size_t i = 0; i < all.size(); ++i)
    if (const Parameter& p = all[i]; p.name == name && is_one_of(p.type, types)) {
      if (!first || i >= own_) p.key.take();  // also of defaults that are overridden
      if (!first) first = &p;
    }
  return first;
}

const Parameter* Parameters::find(const std::string& name) const {
  for (const Parameter& p : all)
    if (p.name == name) return &p;
  return nullptr;
}

const Parameter* Parameters::one(const std::string& name, std::initializer_list<const char*> types,
                                 size_t values) const {
  const Parameter* p = find(name, types);
  if (p && std::max({p->numbers.size(), p->strings.size(), p->flags.size()}) != values)
    Source::fail(p->place,
                 fmt::format("\"{}\" must have {}", shown(name),
                             values == 1 ? "one value" : fmt::format("{} values", values)));
  return p;
}

double Parameters::number(const std::string& name, double absent) const {
  const Parameter* p = one(name, {"float"}, 1);
  if (p && p->numbers.empty())
    Source::fail(p->place, fmt::format("\"{}\" must be a number", shown(name)));
  return p ? p->numbers[0] : absent;
}

int Parameters::integer(const std::string& name, int absent) const {
  const Parameter* p = one(name, {"integer"}, 1);
  if (p && (p->numbers.empty() || std::abs(p->numbers[0]) > 2e9))
    Source::fail(p->place, fmt::format("\"{}\" must be a number below 2e9", shown(name)));
  return p ? static_cast<int>(p->numbers[0]) : absent;
}

bool Parameters::flag(const std::string& name, bool absent) const {
  const Parameter* p = one(name, {"bool"}, 1);
  if (p && p->flags.empty())
    Source::fail(p->place, fmt::format("\"{}\" must be true or false", shown(name)));
  return p ? p->flags[0] : absent;
}

std::string Parameters::text(const std::string& name, const std::string& absent) const {
  const Parameter* p = one(name, {"string"}, 1);
  if (p && p->strings.empty())
    Source::fail(p->place, fmt::format("\"{}\" must be a string", shown(name)));
  return p ? p->strings[0] : absent;
}

std::string Parameters::texture(const std::string& name) const {
  const Parameter* p = one(name, {"texture"}, 1);
  if (p && p->strings.empty())
    Source::fail(p->place, fmt::format("\"{}\" must be the name of a texture", shown(name)));
  return p ? p->strings[0] : "";
}

Vec3d Parameters::point(const std::string& name, const Vec3d& absent) const {
  const Parameter* p = one(name, {"point", "point3", "vector", "vector3"}, 3);
  if (p && p->numbers.empty())
    Source::fail(p->place, fmt::format("\"{}\" must be three numbers", shown(name)));
  return p ? Vec3d(p->numbers[0], p->numbers[1], p->numbers[2]) : absent;
}

const std::vector<double>* Parameters::floats(const std::string& name) const {
  const Parameter* p = find(name, {"float"});
  return p ? &p->numbers : nullptr;
}

const std::vector<double>* Parameters::tuples(const std::string& name, size_t size) const {
  // pbrt-v3 also takes plain numbers for texture coordinates.
  const Parameter* p =
      size == 2 ? find(name, {"point2", "vector2", "float"})
                : find(name, {"point", "point3", "vector", "vector3", "normal", "normal3"});
  if (!p) return nullptr;
  if (p->numbers.size() % size)
    Source::fail(p->place, fmt::format("the {} numbers of \"{}\" are not a multiple of {}",
                                       p->numbers.size(), shown(name), size));
  return &p->numbers;
}

const std::vector<double>* Parameters::integers(const std::string& name) const {
  const Parameter* p = find(name, {"integer"});
  return p ? &p->numbers : nullptr;
}

const std::vector<std::string>* Parameters::texts(const std::string& name) const {
  const Parameter* p = find(name, {"string"});
  return p ? &p->strings : nullptr;
}

void Parameters::ignore(std::initializer_list<const char*> names) const {
  for (const Parameter& p : all)
    if (is_one_of(p.name, names)) p.key.take();
}

void Parameters::ignore_all() const {
  for (const Parameter& p : all) p.key.take();
}

}  // namespace tdpt::foreign::pbrt
