#include "tools/tdpt-import/mitsuba/object.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "libcommon/base/words.h"

namespace tdpt::foreign::mitsuba {

std::optional<double> number_of(const std::string& text) {
  constexpr const char* white = " \t\r\n";
  const size_t first = text.find_first_not_of(white);
  if (first == text.npos) return {};
  const size_t last = text.find_last_not_of(white) + 1;
  const char* begin = text.data() + first + (text[first] == '+' ? 1 : 0);
  double number = 0;
  const auto [end, error] = std::from_chars(begin, text.data() + last, number);
  if (end != text.data() + last) return {};
  // Numbers too small for a double are 0.
  if (error == std::errc::result_out_of_range) number = std::strtod(begin, nullptr);
  if (!std::isfinite(number) || error == std::errc::invalid_argument) return {};
  return number;
}

std::vector<std::string> split(const std::string& text, const std::string& separators) {
  std::vector<std::string> parts;
  for (size_t at = 0; (at = text.find_first_not_of(separators, at)) != text.npos;) {
    const size_t end = std::min(text.find_first_of(separators, at), text.size());
    parts.push_back(text.substr(at, end - at));
    at = end;
  }
  return parts;
}

std::string described(const Object& object) {
  return fmt::format("{} \"{}\"", object.tag, shown(object.type, 40));
}

void Value::fail(const std::string& message) const {
  Source::fail(place, message);
}

const std::string& Value::text(const std::string& attribute) const {
  contents.take();
  const auto it = attributes.find(attribute);
  if (it == attributes.end())
    fail(fmt::format("the {} \"{}\" has no attribute \"{}\"", tag, shown(name, 40), attribute));
  it->second.key.take();
  return it->second.text;
}

double Value::number(const std::string& attribute) const {
  const std::string& word = text(attribute);
  if (const auto n = number_of(word)) return *n;
  fail(fmt::format("\"{}\" is not a finite number", shown(word, 40)));
}

void Object::fail(const std::string& message) const {
  Source::fail(place, message);
}

const Value* Object::find(const std::string& name) const {
  key.take();
  for (auto v = values.rbegin(); v != values.rend(); ++v)
    if (v->name == name) {
      v->key.take();
      return &*v;
    }
  return nullptr;
}

double Object::number(const std::string& name, double otherwise) const {
  const Value* v = find(name);
  if (!v) return otherwise;
  if (v->tag != "float" && v->tag != "integer")
    v->fail(fmt::format("\"{}\" is a {}, expected a float", name, shown(v->tag, 40)));
  return v->number();
}

int Object::integer(const std::string& name, int otherwise) const {
  const double n = number(name, otherwise);
  if (n != std::floor(n) || std::abs(n) > 1e9)
    find(name)->fail(fmt::format("\"{}\" is {}, expected an integer", name, n));
  return static_cast<int>(n);
}

bool Object::flag(const std::string& name, bool otherwise) const {
  const Value* v = find(name);
  if (!v) return otherwise;
  if (v->tag != "boolean")
    v->fail(fmt::format("\"{}\" is a {}, expected a boolean", name, shown(v->tag, 40)));
  const std::string& word = v->text();
  if (word == "true" || word == "True") return true;
  if (word == "false" || word == "False") return false;
  v->fail(fmt::format("\"{}\" is neither \"true\" nor \"false\"", shown(word, 40)));
}

std::string Object::text(const std::string& name, const std::string& otherwise) const {
  const Value* v = find(name);
  if (!v) return otherwise;
  if (v->tag != "string")
    v->fail(fmt::format("\"{}\" is a {}, expected a string", name, shown(v->tag, 40)));
  return v->text();
}

std::string Object::needed_text(const std::string& name) const {
  if (!find(name)) fail(fmt::format("the {} has no \"{}\"", described(*this), name));
  return text(name, "");
}

std::optional<Vec3d> Object::vector(const std::string& name) const {
  const Value* v = find(name);
  if (!v) return {};
  if (v->tag != "point" && v->tag != "vector")
    v->fail(fmt::format("\"{}\" is a {}, expected a point or vector", name, shown(v->tag, 40)));
  if (!v->attributes.contains("value"))
    return Vec3d{v->number("x"), v->number("y"), v->number("z")};
  const auto parts = split(v->text());
  Vec3d out;
  double* const coordinates[] = {&out.x, &out.y, &out.z};
  if (parts.size() != 3) v->fail(fmt::format("{} numbers, expected 3", parts.size()));
  for (size_t i = 0; i < 3; ++i) {
    const auto n = number_of(parts[i]);
    if (!n) v->fail(fmt::format("\"{}\" is not a finite number", shown(parts[i], 40)));
    *coordinates[i] = *n;
  }
  return out;
}

Affine Object::map(const std::string& name, Source& source) const {
  const Value* v = find(name);
  if (!v) return {};
  if (v->tag != "transform" && v->tag != "animation")
    v->fail(fmt::format("\"{}\" is a {}, expected a transform", name, shown(v->tag, 40)));
  v->contents.take();
  if (v->is_animated) source.lose(v->place, "of moving objects the first place is taken");
  return v->map;
}

std::vector<const Object*> Object::nested(const std::string& kind) const {
  key.take();
  std::vector<const Object*> out;
  for (const Value& v : values)
    if (v.object && v.object->tag == kind) {
      v.key.take();
      out.push_back(v.object);
    }
  return out;
}

void Object::ignore(std::initializer_list<const char*> names) const {
  for (const char* name : names) find(name);
}

void Object::ignore_all() const {
  for (const Value& v : values) v.key.take();
}

}  // namespace tdpt::foreign::mitsuba
