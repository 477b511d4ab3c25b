// Words of pbrt's scene files and the parameter lists that they make.
#include <algorithm>
#include <cmath>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/meshes/meshes.h"
#include "tools/tdpt-import/pbrt/pbrt.h"

namespace tdpt::foreign::pbrt {

std::string unpacked(std::string bytes, const std::string& name) {
  return bytes.starts_with("\x1f\x8b") ? inflated(bytes, name, "") : std::move(bytes);
}

// ---- Words ----

Token Tokens::next() {
  last_line_ = ahead_line_;
  return std::exchange(ahead_, scanned());
}

Token Tokens::scanned() {
  using enum Token::Kind;
  constexpr std::string_view kSpaces = " \t\n\r", kEndOfWord = " \t\n\r\"[]#";
  while (at_ < text_.size()) {
    if (text_[at_] == '#') {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else if (kSpaces.find(text_[at_]) != kSpaces.npos) {
      line_ += text_[at_++] == '\n';
    } else {
      break;
    }
  }
  ahead_line_ = line_;
  if (at_ == text_.size()) return {end, "end of the file"};
  const size_t from = at_++;
  const char c = text_[from];
  if (c == '"') return {quoted, rest_of_string()};
  if (c != '[' && c != ']') at_ = std::min(text_.find_first_of(kEndOfWord, at_), text_.size());
  return {c == '[' ? open : c == ']' ? close : word, std::string(text_.substr(from, at_ - from))};
}

std::string Tokens::rest_of_string() {
  constexpr std::string_view kEscapes = "bfnrt", kMeant = "\b\f\n\r\t";
  std::string out;
  for (bool is_escaped = false; at_ < text_.size() && text_[at_] != '\n'; ++at_) {
    const char c = text_[at_];
    if (c == '"' && !is_escaped) return ++at_, out;
    const size_t escape = is_escaped ? kEscapes.find(c) : kEscapes.npos;
    is_escaped = c == '\\' && !is_escaped;
    if (!is_escaped) out += escape == kEscapes.npos ? c : kMeant[escape];
  }
  last_line_ = line_;
  fail("a string does not end on its line");
}

double Tokens::number_of(const Token& token) const {
  const auto number = token.kind == Token::Kind::word ? number_in(token.text) : std::nullopt;
  if (!number || !std::isfinite(*number)) fail("\"{}\" is not a number", shown(token.text));
  return *number;
}

// ---- Parameter lists ----

namespace {

bool is_one_of(const std::string& type, std::initializer_list<const char*> types) {
  return std::find(types.begin(), types.end(), type) != types.end();
}

// Takes a value from the tokens.
void add_value(Parameter& p, Tokens& tokens) {
  Token token = tokens.next();
  const bool is_quoted = token.kind == Token::Kind::quoted;
  if ((token.text == "true" || token.text == "false") && (!is_quoted || p.type == "bool"))
    p.numbers.push_back(token.text == "true");  // pbrt-v3 quotes them
  else if (is_quoted)
    p.strings.push_back(std::move(token.text));
  else
    p.numbers.push_back(tokens.number_of(token));
  if (!p.numbers.empty() && !p.strings.empty())
    tokens.fail("values of different kinds in \"{}\"", shown(p.name));
}

}  // namespace

void Entity::read(Tokens& tokens, const std::string& owner) {
  using enum Token::Kind;
  while (tokens.peek().kind == quoted) {
    const std::string declaration = tokens.next().text;
    const auto words = words_of(declaration);
    if (words.size() < 2)
      tokens.fail("\"{}\" is not a parameter's type and name", shown(declaration));
    Parameter p{std::string(words[0]), std::string(words[1]), tokens.place()};
    if (tokens.peek().kind == open) {
      tokens.next();
      while (tokens.peek().kind != close) add_value(p, tokens);
      tokens.next();
    } else {
      add_value(p, tokens);
    }
    p.key = context.source.enter(
        key, p.place,
        fmt::format("\"{} {}\" of {} is not read", shown(p.type), shown(p.name), owner));
    all.push_back(std::move(p));
  }
}

const Parameter* Entity::find(const std::string& name,
                              std::initializer_list<const char*> types) const {
  const Parameter* first = nullptr;
  for (const Parameter& p : all)
    if (p.name == name && is_one_of(p.type, types)) {
      p.key.take();  // also of those that are overridden
      if (!first) first = &p;
    }
  return first;
}

bool Entity::has(const std::string& name) const {
  return std::any_of(all.begin(), all.end(), [&](const Parameter& p) { return p.name == name; });
}

const double* Entity::numbers(const std::string& name, std::initializer_list<const char*> types,
                              size_t count) const {
  const Parameter* p = find(name, types);
  if (p && p->numbers.size() != count)
    Source::fail(p->place,
                 fmt::format("\"{}\" must have {}", shown(name), counted(count, "number")));
  return p ? p->numbers.data() : nullptr;
}

double Entity::number(const std::string& name, double absent) const {
  const double* v = numbers(name, {"float"}, 1);
  return v ? *v : absent;
}

int Entity::integer(const std::string& name, int absent) const {
  const double* v = numbers(name, {"integer"}, 1);
  return v ? static_cast<int>(std::clamp(*v, -2e9, 2e9)) : absent;
}

bool Entity::flag(const std::string& name, bool absent) const {
  const double* v = numbers(name, {"bool"}, 1);
  return v ? *v != 0 : absent;
}

std::string Entity::text(const std::string& name, const std::string& absent,
                         const char* type) const {
  const Parameter* p = find(name, {type});
  if (p && p->strings.size() != 1)
    Source::fail(p->place, fmt::format("\"{}\" must have one string", shown(name)));
  return p ? p->strings[0] : absent;
}

Vec3d Entity::point(const std::string& name, const Vec3d& absent) const {
  const double* v = numbers(name, {"point", "point3", "vector", "vector3"}, 3);
  return v ? Vec3d(v[0], v[1], v[2]) : absent;
}

const std::vector<double>* Entity::list(const std::string& name,
                                        std::initializer_list<const char*> types,
                                        size_t size) const {
  const Parameter* p = find(name, types);
  if (p && p->numbers.size() % size)
    Source::fail(p->place, fmt::format("the {} numbers of \"{}\" are not a multiple of {}",
                                       p->numbers.size(), shown(name), size));
  return p ? &p->numbers : nullptr;
}

void Entity::ignore(std::initializer_list<const char*> names) const {
  for (const Parameter& p : all)
    if (names.size() == 0 || is_one_of(p.name, names)) p.key.take();
}

}  // namespace tdpt::foreign::pbrt
