#include "tools/tdpt-import/mitsuba/mitsuba.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign::mitsuba {

std::vector<std::string> split(const std::string& text, const std::string& separators) {
  std::vector<std::string> parts;
  for (size_t at = 0; (at = text.find_first_not_of(separators, at)) != text.npos;) {
    const size_t end = std::min(text.find_first_of(separators, at), text.size());
    parts.push_back(text.substr(at, end - at));
    at = end;
  }
  return parts;
}

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

bool is_one_of(const std::string& word, const std::string& words) {
  const auto all = split(words, " ");
  return std::find(all.begin(), all.end(), word) != all.end();
}

double Element::finite(const std::string& word, double most) const {
  const auto words = split(word, " \t\r\n");  // white space around it is allowed
  const auto n = words.size() == 1 ? number_in(words[0]) : std::nullopt;
  if (n && std::abs(*n) < most) return *n;
  fail(fmt::format("\"{}\" is not a finite number", shown(word, 40)));
}

const std::string& Element::attribute(const std::string& attribute) const {
  const auto it = attributes.find(attribute);
  if (it != attributes.end()) return it->second;
  fail(fmt::format("the {} \"{}\" has no attribute \"{}\"", tag, shown(name, 40), attribute));
}

std::string Element::optional(const std::string& attribute) const {
  const auto it = attributes.find(attribute);
  return it == attributes.end() ? "" : it->second;
}

std::vector<double> Element::numbers(const std::string& which) const {
  std::vector<double> all;
  for (const std::string& word : split(attribute(which))) all.push_back(finite(word));
  return all;
}

Vec3d Element::three(const std::string& which) const {
  const auto all = numbers(which);
  if (all.size() != 3) fail(fmt::format("{} numbers in \"{}\", expected 3", all.size(), which));
  return {all[0], all[1], all[2]};
}

Vec3d Element::xyz(double otherwise) const {
  const auto at = [&](const char* axis) {
    return optional(axis).empty() ? otherwise : finite(attribute(axis));
  };
  if (optional("value").empty()) return {at("x"), at("y"), at("z")};
  if (!(optional("x") + optional("y") + optional("z")).empty())
    fail("both \"value\" and \"x\", \"y\" or \"z\"");
  const auto all = numbers();
  return all.size() == 1 ? Vec3d(all[0]) : three();
}

std::string Element::described() const {
  return fmt::format("{} \"{}\"", tag, shown(type, 40));
}

const Element* Element::find(const std::string& child) const {
  contents.take();
  const auto it = std::find_if(children.rbegin(), children.rend(),
                               [&](const Element* v) { return v->name == child; });
  if (it == children.rend()) return nullptr;
  (*it)->key.take();
  return *it;
}

const Element* Element::find(const std::string& child, const std::string& tags) const {
  const Element* v = find(child);
  if (v && !is_one_of(v->tag, tags))
    v->fail(fmt::format("\"{}\" is a {}, expected a {}", child, shown(v->tag, 40),
                        fmt::join(split(tags), " or ")));
  return v;
}

double Element::number(const std::string& child, double otherwise) const {
  const Element* v = find(child, "float integer");
  return v ? v->finite(v->attribute()) : otherwise;
}

int Element::integer(const std::string& child, int otherwise) const {
  const double n = number(child, otherwise);
  if (n != std::floor(n) || std::abs(n) > 1e9)
    find(child)->fail(fmt::format("\"{}\" is {}, expected an integer", child, n));
  return static_cast<int>(n);
}

bool Element::flag(const std::string& child, bool otherwise) const {
  const Element* v = find(child, "boolean");
  if (!v) return otherwise;
  const std::string& word = v->attribute();
  if (!is_one_of(word, "true True false False"))
    v->fail(fmt::format("\"{}\" is neither \"true\" nor \"false\"", shown(word, 40)));
  return is_one_of(word, "true True");
}

std::string Element::text(const std::string& child, const std::string& otherwise) const {
  const Element* v = find(child, "string");
  return v ? v->attribute() : otherwise;
}

std::string Element::needed_text(const std::string& child) const {
  if (!find(child)) fail(fmt::format("the {} has no \"{}\"", described(), child));
  return text(child, "");
}

std::optional<Vec3d> Element::vector(const std::string& child) const {
  const Element* v = find(child, "point vector");
  return v ? std::optional(v->xyz(0)) : std::nullopt;
}

Affine Element::transform(const std::string& child) const {
  const Element* v = find(child, "transform animation");
  if (!v) return {};
  if (v->is_animated) v->lose("of moving objects the first place is taken");
  return v->map;
}

std::vector<const Element*> Element::nested(const std::string& kind) const {
  contents.take();
  std::vector<const Element*> out;
  for (const Element* v : children)
    if (v->object && v->tag == kind) {
      v->key.take();
      out.push_back(v->object);
    }
  return out;
}

void Element::ignore(const std::string& names) const {
  for (const std::string& child : split(names)) find(child);
}

void Element::ignore_all() const {
  for (const Element* v : children) v->key.take();
}

// ---- Transforms

namespace {

Affine rotation(const Element& step) {
  const Vec3d axis = step.xyz(0);
  const double half = step.finite(step.attribute("angle")) * std::numbers::pi / 360,
               l = length(axis);
  if (!(l > 0)) step.fail("a rotation about an axis of length 0");
  const Vec3d a = axis * (std::sin(half) / l);
  return *affine_of({}, {a.x, a.y, a.z, std::cos(half)}, Vec3d(1));
}

Affine look_at(const Element& step) {
  const Vec3d from = step.three("origin"), to = step.three("target");
  if (!(length(to - from) > 0)) step.fail("origin and target are one point");
  const Vec3d ahead = normalize(to - from);
  Vec3d up = step.optional("up").empty() ? Vec3d(0) : step.three("up");
  if (!(length(up) > 0))  // any
    up = std::abs(ahead.x) > std::abs(ahead.y) ? cross(Vec3d{ahead.z, 0, -ahead.x}, ahead)
                                               : cross(Vec3d{0, ahead.z, -ahead.y}, ahead);
  const Vec3d left = cross(normalize(up), ahead);
  if (!(length(left) > 1e-12)) step.fail("\"up\" is parallel to the direction of view");
  const Vec3d x = normalize(left);
  return {x, cross(ahead, x), ahead, from};
}

Affine matrix(const Element& step) {
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

std::optional<Affine> map_of_step(const Element& step) {
  if (step.tag == "translate") return Affine{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, step.xyz(0)};
  if (step.tag == "rotate") return rotation(step);
  if (is_one_of(step.tag, "lookat lookAt look_at")) return look_at(step);
  if (step.tag == "matrix") return matrix(step);
  if (step.tag != "scale") return {};
  const Vec3d s = step.xyz(1);
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
