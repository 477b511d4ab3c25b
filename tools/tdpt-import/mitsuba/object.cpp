#include "tools/tdpt-import/mitsuba/object.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

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

namespace {

// ---- Transforms ----

class Step {
 public:
  Step(const Attributes& attributes, const Place& place) : attributes_(attributes), place_(place) {}

  [[noreturn]] void fail(const std::string& message) const { Source::fail(place_, message); }

  bool has(const char* name) const {
    const auto it = attributes_.find(name);
    if (it == attributes_.end()) return false;
    it->second.key.take();
    return !it->second.text.empty();
  }

  std::vector<double> numbers(const char* name) const {
    if (!has(name)) fail(fmt::format("no attribute \"{}\"", name));
    std::vector<double> out;
    for (const std::string& word : split(attributes_.at(name).text)) {
      const auto n = number_of(word);
      if (!n) fail(fmt::format("\"{}\" is not a finite number", shown(word, 40)));
      out.push_back(*n);
    }
    return out;
  }
  double number(const char* name) const {
    const auto all = numbers(name);
    if (all.size() != 1) fail(fmt::format("{} numbers in \"{}\", expected 1", all.size(), name));
    return all[0];
  }
  Vec3d three(const char* name) const {
    const auto all = numbers(name);
    if (all.size() != 3) fail(fmt::format("{} numbers in \"{}\", expected 3", all.size(), name));
    return {all[0], all[1], all[2]};
  }

  // x, y and z, or value with one or three numbers.
  Vec3d vector(double otherwise) const {
    if (has("value")) {
      if (has("x") || has("y") || has("z")) fail("both \"value\" and \"x\", \"y\" or \"z\"");
      const auto all = numbers("value");
      if (all.size() == 1) return Vec3d(all[0]);
      if (all.size() == 3) return {all[0], all[1], all[2]};
      fail(fmt::format("{} numbers in \"value\", expected 1 or 3", all.size()));
    }
    const auto one = [&](const char* name) { return has(name) ? number(name) : otherwise; };
    return {one("x"), one("y"), one("z")};
  }

 private:
  const Attributes& attributes_;
  const Place& place_;
};

Affine scaling(const Vec3d& s) {
  return {{s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}, {}};
}

Affine rotation(const Vec3d& axis, double degrees, const Step& step) {
  const double half = degrees * std::numbers::pi / 360, l = length(axis);
  if (!(l > 0)) step.fail("a rotation about an axis of length 0");
  const Vec3d a = axis * (std::sin(half) / l);
  return *affine_of({}, {a.x, a.y, a.z, std::cos(half)}, Vec3d(1));
}

Affine look_at(const Step& step) {
  const Vec3d from = step.three("origin"), to = step.three("target");
  if (!(length(to - from) > 0)) step.fail("origin and target are one point");
  const Vec3d ahead = normalize(to - from);
  Vec3d up = step.has("up") ? step.three("up") : Vec3d(0);
  if (!(length(up) > 0))  // any
    up = std::abs(ahead.x) > std::abs(ahead.y) ? cross(Vec3d{ahead.z, 0, -ahead.x}, ahead)
                                               : cross(Vec3d{0, ahead.z, -ahead.y}, ahead);
  const Vec3d left = cross(normalize(up), ahead);
  if (!(length(left) > 1e-12)) step.fail("\"up\" is parallel to the direction of view");
  const Vec3d x = normalize(left);
  return {x, cross(ahead, x), ahead, from};
}

Affine matrix(const Step& step) {
  const auto m = step.numbers("value");
  if (m.size() == 9) return {{m[0], m[3], m[6]}, {m[1], m[4], m[7]}, {m[2], m[5], m[8]}, {}};
  if (m.size() != 16) step.fail(fmt::format("a matrix of {} numbers, expected 16", m.size()));
  if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] == 0)
    step.fail("the last row of a matrix is not 0 0 0 1");
  const double w = m[15];
  return {{m[0] / w, m[4] / w, m[8] / w},
          {m[1] / w, m[5] / w, m[9] / w},
          {m[2] / w, m[6] / w, m[10] / w},
          {m[3] / w, m[7] / w, m[11] / w}};
}

}  // namespace

std::optional<Affine> step_of(const std::string& tag, const Attributes& attributes,
                              const Place& place) {
  const Step step(attributes, place);
  if (tag == "translate") {
    Affine a;
    a.t = step.vector(0);
    return a;
  }
  if (tag == "scale") return scaling(step.vector(1));
  if (tag == "rotate") return rotation(step.vector(0), step.number("angle"), step);
  if (tag == "lookat" || tag == "lookAt" || tag == "look_at") return look_at(step);
  if (tag == "matrix") return matrix(step);
  return {};
}

Affine inverse(const Affine& m, const Place& place) {
  const double det = dot(cross(m.x, m.y), m.z);
  if (det == 0 || !std::isfinite(1 / det)) Source::fail(place, "a transform without an inverse");
  const Vec3d r0 = cross(m.y, m.z) / det, r1 = cross(m.z, m.x) / det, r2 = cross(m.x, m.y) / det;
  Affine out{{r0.x, r1.x, r2.x}, {r0.y, r1.y, r2.y}, {r0.z, r1.z, r2.z}, {}};
  out.t = -out.vector(m.t);
  return out;
}

Affine axes_of(const Affine& m, const Place& place) {
  for (const Vec3d& axis : {m.x, m.y, m.z})
    if (!(length(axis) > 0) || !std::isfinite(length(axis)))
      Source::fail(place, "a transform with an axis of no length");
  return {normalize(m.x), normalize(m.y), normalize(m.z), {}};
}

}  // namespace tdpt::foreign::mitsuba
