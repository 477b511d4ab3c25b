#include "tools/tdpt-import/mitsuba/transforms.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "libcommon/base/words.h"

namespace tdpt::foreign::mitsuba {
namespace {

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
