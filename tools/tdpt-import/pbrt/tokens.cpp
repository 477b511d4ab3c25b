// Words of pbrt's scene files, across the files that they include, and the parameter lists that
// they make.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "tools/tdpt-import/meshes/meshes.h"
#include "tools/tdpt-import/pbrt/pbrt.h"

namespace tdpt::foreign::pbrt {

std::string unpacked(std::string bytes, const std::string& name) {
  return bytes.starts_with("\x1f\x8b") ? inflated(bytes, name, "") : std::move(bytes);
}

// ---- Words ----

Tokens::Tokens(std::string_view text, std::string shown_name) {
  open_.push_back(std::make_unique<File>());
  open_.back()->shown = std::move(shown_name);
  open_.back()->text = text;
}

std::optional<Token> Tokens::next() {
  using Kind = Token::Kind;
  constexpr std::string_view kSpaces = " \t\n\r", kEndOfWord = " \t\n\r\"[]#";
  if (again_) return std::exchange(again_, std::nullopt);
  while (!open_.empty()) {
    File& f = *open_.back();
    while (f.at < f.text.size()) {
      const char c = f.text[f.at];
      if (c == '#') {
        f.at = std::min(f.text.find('\n', f.at), f.text.size());
        continue;
      }
      if (c == '\n') ++f.line;
      if (kSpaces.find(c) != kSpaces.npos) {
        ++f.at;
        continue;
      }
      last_ = {f.shown, "line " + std::to_string(f.line)};
      if (c == '"') {
        ++f.at;
        return Token{Kind::quoted, quoted(f)};
      }
      const size_t from = f.at;
      f.at = c == '[' || c == ']' ? from + 1
                                  : std::min(f.text.find_first_of(kEndOfWord, from), f.text.size());
      return Token{c == '['   ? Kind::open
                   : c == ']' ? Kind::close
                              : Kind::word,
                   std::string(f.text.substr(from, f.at - from))};
    }
    if (open_.size() == 1) return {};
    open_.pop_back();
  }
  return {};
}

std::string Tokens::quoted(File& f) {
  constexpr std::string_view kEscapes = "bfnrt", kMeant = "\b\f\n\r\t";
  std::string out;
  while (f.at < f.text.size()) {
    char c = f.text[f.at++];
    if (c == '"') return out;
    if (c == '\n') break;
    if (c == '\\') {
      if (f.at == f.text.size() || f.text[f.at] == '\n') break;
      c = f.text[f.at++];
      if (const size_t i = kEscapes.find(c); i != kEscapes.npos) c = kMeant[i];
    }
    out += c;
  }
  Source::fail(last_, "a string does not end on its line");
}

void Tokens::include(Source& source, const std::string& given) {
  constexpr size_t kDeepest = 16;  // the scene itself and 15 included files
  constexpr size_t kMostFiles = 10000,
                   kMostBytes = size_t{1} << 33;  // files that repeat count again
  const Place place = last_;
  auto file = std::make_unique<File>();
  file->name = std::filesystem::path(given).lexically_normal().string();
  file->shown = source.shown_name(file->name);
  for (const auto& other : open_)
    if (other->name == file->name || other->shown == file->shown)
      Source::fail(place, "\"" + shown(file->name) + "\" includes itself");
  if (open_.size() >= kDeepest) Source::fail(place, "more than 15 files include each other");
  file->bytes = unpacked(source.read(file->name, place), file->shown);
  file->text = file->bytes;
  bytes_ += file->bytes.size();
  if (++files_ > kMostFiles || bytes_ > kMostBytes)
    Source::fail(place, "more files are included than 10000, or more than 8 GiB");
  open_.push_back(std::move(file));
}

double number_of(const Token& token, const Place& place) {
  const std::string& t = token.text;
  const char *from = t.data() + (t.size() > 1 && t[0] == '+' ? 1 : 0), *to = t.data() + t.size();
  double value = 0;
  const auto [end, error] = std::from_chars(from, to, value);
  const size_t exponent = t.find_first_of("eE");
  const bool is_tiny = error == std::errc::result_out_of_range && exponent != std::string::npos &&
                       t[exponent + 1] == '-';
  if (token.kind != Token::Kind::word || end != to || (error != std::errc() && !is_tiny) ||
      !std::isfinite(value))
    Source::fail(place, fmt::format("\"{}\" is not a number", shown(t)));
  return is_tiny ? 0 : value;
}

// ---- Parameter lists ----

namespace {

// Type and name of "type name".
Parameter declared(const std::string& words, const Place& place) {
  const char* spaces = " \t";
  const size_t type = words.find_first_not_of(spaces);
  const size_t type_end = words.find_first_of(spaces, type);
  const size_t name = words.find_first_not_of(spaces, type_end);
  if (type == std::string::npos || type_end == std::string::npos || name == std::string::npos)
    Source::fail(place, fmt::format("\"{}\" is not a parameter's type and name", shown(words)));
  Parameter p;
  p.type = words.substr(type, type_end - type);
  p.name = words.substr(name, words.find_first_of(spaces, name) - name);
  p.place = place;
  return p;
}

void add_value(Parameter& p, Token&& token, const Place& place) {
  const bool is_quoted = token.kind == Token::Kind::quoted,
             is_flag = token.text == "true" || token.text == "false";
  if (is_quoted && p.type == "bool" && !is_flag)
    Source::fail(place, fmt::format("\"{}\" is neither true nor false", shown(token.text)));
  if (is_flag && (!is_quoted || p.type == "bool"))  // pbrt-v3 quotes them
    p.flags.push_back(token.text == "true");
  else if (is_quoted)
    p.strings.push_back(std::move(token.text));
  else
    p.numbers.push_back(number_of(token, place));
  if (!p.numbers.empty() + !p.strings.empty() + !p.flags.empty() > 1)
    Source::fail(place, fmt::format("values of different kinds in \"{}\"", shown(p.name)));
}

bool is_one_of(const std::string& type, std::initializer_list<const char*> types) {
  return std::find(types.begin(), types.end(), type) != types.end();
}

// The values of a parameter that must have `count` of them; null: there is no such parameter.
template <class Value>
const Value* values_of(const Entity& e, const std::string& name,
                       std::initializer_list<const char*> types,
                       std::vector<Value> Parameter::*values, const char* what, size_t count = 1) {
  const Parameter* p = e.find(name, types);
  if (!p) return nullptr;
  if (std::max({p->numbers.size(), p->strings.size(), p->flags.size()}) != count)
    Source::fail(p->place, fmt::format("\"{}\" must have {}", shown(name),
                                       count == 1 ? "one value" : fmt::format("{} values", count)));
  if ((p->*values).empty())
    Source::fail(p->place, fmt::format("\"{}\" must be {}", shown(name), what));
  return (p->*values).data();
}

}  // namespace

void Entity::read(Tokens& tokens, const std::string& whose) {
  using enum Token::Kind;
  while (std::optional<Token> token = tokens.next()) {
    if (token->kind != quoted) return tokens.back(std::move(*token));
    Parameter p = declared(token->text, tokens.place());
    std::optional<Token> value = tokens.next();
    const bool in_brackets = value && value->kind == open;
    if (in_brackets) value = tokens.next();
    while (value && value->kind != close) {
      if (value->kind == open) Source::fail(tokens.place(), "a '[' within a list of values");
      add_value(p, std::move(*value), tokens.place());
      if (!in_brackets) break;
      value = tokens.next();
    }
    if (!value) Source::fail(p.place, fmt::format("no end of the values of \"{}\"", shown(p.name)));
    if (!in_brackets && value->kind == close) Source::fail(tokens.place(), "a ']' without its '['");
    p.key = context.source.enter(
        key, p.place,
        fmt::format("\"{} {}\" of {} is not read", shown(p.type), shown(p.name), whose));
    all.push_back(std::move(p));
  }
}

void Entity::defaults(const std::vector<Parameter>& of_attribute) {
  own_ = all.size();
  all.insert(all.end(), of_attribute.rbegin(), of_attribute.rend());
}

const Parameter* Entity::find(const std::string& name,
                              std::initializer_list<const char*> types) const {
  const Parameter* first = nullptr;
  for (size_t i = 0; i < all.size(); ++i)
    if (const Parameter& p = all[i]; p.name == name && is_one_of(p.type, types)) {
      if (!first || i >= own_) p.key.take();  // also of defaults that are overridden
      if (!first) first = &p;
    }
  return first;
}

const Parameter* Entity::find(const std::string& name) const {
  const auto p =
      std::find_if(all.begin(), all.end(), [&](const Parameter& a) { return a.name == name; });
  return p == all.end() ? nullptr : &*p;
}

double Entity::number(const std::string& name, double absent) const {
  const double* v = values_of(*this, name, {"float"}, &Parameter::numbers, "a number");
  return v ? *v : absent;
}

int Entity::integer(const std::string& name, int absent) const {
  const char* what = "a number below 2e9";
  const double* v = values_of(*this, name, {"integer"}, &Parameter::numbers, what);
  if (v && std::abs(*v) > 2e9)
    Source::fail(find(name, {"integer"})->place, fmt::format("\"{}\" must be {}", name, what));
  return v ? static_cast<int>(*v) : absent;
}

bool Entity::flag(const std::string& name, bool absent) const {
  const char* v = values_of(*this, name, {"bool"}, &Parameter::flags, "true or false");
  return v ? *v : absent;
}

std::string Entity::text(const std::string& name, const std::string& absent) const {
  const std::string* v = values_of(*this, name, {"string"}, &Parameter::strings, "a string");
  return v ? *v : absent;
}

std::string Entity::texture(const std::string& name) const {
  const std::string* v =
      values_of(*this, name, {"texture"}, &Parameter::strings, "the name of a texture");
  return v ? *v : "";
}

Vec3d Entity::point(const std::string& name, const Vec3d& absent) const {
  const double* v = values_of(*this, name, {"point", "point3", "vector", "vector3"},
                              &Parameter::numbers, "three numbers", 3);
  return v ? Vec3d(v[0], v[1], v[2]) : absent;
}

const std::vector<double>* Entity::floats(const std::string& name) const {
  const Parameter* p = find(name, {"float"});
  return p ? &p->numbers : nullptr;
}

const std::vector<double>* Entity::integers(const std::string& name) const {
  const Parameter* p = find(name, {"integer"});
  return p ? &p->numbers : nullptr;
}

const std::vector<double>* Entity::tuples(const std::string& name, size_t size) const {
  // pbrt-v3 also takes plain numbers for texture coordinates.
  const Parameter* p =
      size == 2 ? find(name, {"point2", "vector2", "float"})
                : find(name, {"point", "point3", "vector", "vector3", "normal", "normal3"});
  if (p && p->numbers.size() % size)
    Source::fail(p->place, fmt::format("the {} numbers of \"{}\" are not a multiple of {}",
                                       p->numbers.size(), shown(name), size));
  return p ? &p->numbers : nullptr;
}

void Entity::ignore(std::initializer_list<const char*> names) const {
  for (const Parameter& p : all)
    if (is_one_of(p.name, names)) p.key.take();
}

void Entity::ignore_all() const {
  for (const Parameter& p : all) p.key.take();
}

}  // namespace tdpt::foreign::pbrt
