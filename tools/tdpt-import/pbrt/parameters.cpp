#include "tools/tdpt-import/pbrt/parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/words.h"

namespace tdpt::foreign::pbrt {
namespace {

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
