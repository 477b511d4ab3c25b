#include "tools/tdpt-import/mitsuba/object.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign::mitsuba {

std::optional<double> number_of(const std::string& text) {
  constexpr const char* white = " \t\r\n";
  const size_t first = text.find_first_not_of(white);
  if (first == text.npos) return {};
  const size_t last = text.find_last_not_of(white) + 1;
  const auto number = number_in(std::string_view(text).substr(first, last - first));
  return number && std::isfinite(*number) ? number : std::nullopt;
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

bool is_one_of(const std::string& word, const std::string& words) {
  const auto all = split(words, " ");
  return std::find(all.begin(), all.end(), word) != all.end();
}

// ---- Values

bool Value::has(const std::string& attribute) const {
  const auto it = attributes.find(attribute);
  return it != attributes.end() && (it->second.key.take(), !it->second.text.empty());
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

std::vector<double> Value::numbers(const std::string& attribute) const {
  std::vector<double> all;
  for (const std::string& word : split(text(attribute))) {
    const auto n = number_of(word);
    if (!n) fail(fmt::format("\"{}\" is not a finite number", shown(word, 40)));
    all.push_back(*n);
  }
  return all;
}

Vec3d Value::three(const std::string& attribute) const {
  const auto all = numbers(attribute);
  if (all.size() != 3) fail(fmt::format("{} numbers in \"{}\", expected 3", all.size(), attribute));
  return {all[0], all[1], all[2]};
}

// ---- Objects

std::string Object::described() const {
  return fmt::format("{} \"{}\"", tag, shown(type, 40));
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

const Value* Object::find(const std::string& name, const std::string& tags) const {
  const Value* v = find(name);
  if (v && !is_one_of(v->tag, tags))
    v->fail(fmt::format("\"{}\" is a {}, expected a {}", name, shown(v->tag, 40),
                        fmt::join(split(tags), " or ")));
  return v;
}

double Object::number(const std::string& name, double otherwise) const {
  const Value* v = find(name, "float integer");
  return v ? v->number() : otherwise;
}

int Object::integer(const std::string& name, int otherwise) const {
  const double n = number(name, otherwise);
  if (n != std::floor(n) || std::abs(n) > 1e9)
    find(name)->fail(fmt::format("\"{}\" is {}, expected an integer", name, n));
  return static_cast<int>(n);
}

bool Object::flag(const std::string& name, bool otherwise) const {
  const Value* v = find(name, "boolean");
  if (!v) return otherwise;
  const std::string& word = v->text();
  if (!is_one_of(word, "true True false False"))
    v->fail(fmt::format("\"{}\" is neither \"true\" nor \"false\"", shown(word, 40)));
  return is_one_of(word, "true True");
}

std::string Object::text(const std::string& name, const std::string& otherwise) const {
  const Value* v = find(name, "string");
  return v ? v->text() : otherwise;
}

std::string Object::needed_text(const std::string& name) const {
  if (!find(name)) fail(fmt::format("the {} has no \"{}\"", described(), name));
  return text(name, "");
}

std::optional<Vec3d> Object::vector(const std::string& name) const {
  const Value* v = find(name, "point vector");
  if (!v) return {};
  if (v->attributes.contains("value")) return v->three();
  return Vec3d{v->number("x"), v->number("y"), v->number("z")};
}

Affine Object::map(const std::string& name) const {
  const Value* v = find(name, "transform animation");
  if (!v) return {};
  v->contents.take();
  if (v->is_animated) v->lose("of moving objects the first place is taken");
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

void Object::ignore(const std::string& names) const {
  for (const std::string& name : split(names)) find(name);
}

void Object::ignore_all() const {
  for (const Value& v : values) v.key.take();
}

// ---- Transforms

namespace {

// x, y and z, or value with one or three numbers.
Vec3d vector_of(const Value& step, double otherwise) {
  const auto one = [&](const char* name) { return step.has(name) ? step.number(name) : otherwise; };
  if (!step.has("value")) {
    const double x = one("x"), y = one("y"), z = one("z");
    return {x, y, z};
  }
  if (step.has("x") || step.has("y") || step.has("z"))
    step.fail("both \"value\" and \"x\", \"y\" or \"z\"");
  const auto all = step.numbers();
  return all.size() == 1 ? Vec3d(all[0]) : step.three();
}

Affine rotation(const Value& step) {
  const Vec3d axis = vector_of(step, 0);
  const double half = step.number("angle") * std::numbers::pi / 360, l = length(axis);
  if (!(l > 0)) step.fail("a rotation about an axis of length 0");
  const Vec3d a = axis * (std::sin(half) / l);
  return *affine_of({}, {a.x, a.y, a.z, std::cos(half)}, Vec3d(1));
}

Affine look_at(const Value& step) {
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

Affine matrix(const Value& step) {
  const auto m = step.numbers();
  if (m.size() == 9) return {{m[0], m[3], m[6]}, {m[1], m[4], m[7]}, {m[2], m[5], m[8]}, {}};
  if (m.size() != 16) step.fail(fmt::format("a matrix of {} numbers, expected 16", m.size()));
  if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] == 0)
    step.fail("the last row of a matrix is not 0 0 0 1");
  const double w = m[15];
  const auto column = [&](size_t i) { return Vec3d{m[i] / w, m[i + 4] / w, m[i + 8] / w}; };
  return {column(0), column(1), column(2), column(3)};
}

}  // namespace

std::optional<Affine> map_of_step(const Value& step) {
  if (step.tag == "translate") return Affine{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, vector_of(step, 0)};
  if (step.tag == "rotate") return rotation(step);
  if (is_one_of(step.tag, "lookat lookAt look_at")) return look_at(step);
  if (step.tag == "matrix") return matrix(step);
  if (step.tag != "scale") return {};
  const Vec3d s = vector_of(step, 1);
  return Affine{{s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}, {}};
}

Affine inverse(const Affine& m, const Place& place) {
  const double det = dot(cross(m.x, m.y), m.z);
  if (det == 0 || !std::isfinite(1 / det)) Source::fail(place, "a transform without an inverse");
  Affine out = Affine{cross(m.y, m.z) / det, cross(m.z, m.x) / det, cross(m.x, m.y) / det, {}};
  out = out.transposed();
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
