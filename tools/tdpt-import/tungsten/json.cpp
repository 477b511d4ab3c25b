#include "tools/tdpt-import/tungsten/context.h"

#include <cmath>
#include <numbers>

#include "libcommon/base/words.h"

namespace tdpt::foreign::tungsten {
void Node::enter_keys() const {
  if (!json_->is_object() || !account_->objects.insert(json_).second) return;
  const auto type = json_->find("type");
  const std::string of_what = type != json_->end() && type->is_string()
                                  ? " of a " + shown(type->get<std::string>(), 40)
                                  : "";
  for (const auto& [key, value] : json_->items()) {
    const Key entered = account_->keys[&value] =
        source().enter({}, place(), fmt::format("\"{}\"{} is not read", shown(key, 40), of_what));
    if (value == 0 || value == false || value.is_null()) entered.take();  // nothing is lost of it
  }
}

std::optional<Node> Node::find(const char* key) const {
  enter_keys();
  const auto it = json_->is_object() ? json_->find(key) : json_->end();
  if (it == json_->end()) return {};
  account_->keys.at(&*it).take();
  return Node(*it, *account_, where_.empty() ? key : where_ + "." + key);
}

Node Node::needed(const char* key) const {
  if (const auto n = find(key)) return *n;
  fail("has no \"{}\"", key);
}

Node Node::item(size_t index) const {
  return Node((*json_)[index], *account_, fmt::format("{}[{}]", where_, index));
}

double Node::number() const {
  if (!json_->is_number()) fail("is no number");
  const double v = json_->get<double>();
  if (!(std::abs(v) < 1e30)) fail("is a number beyond 1e30");
  return v;
}

Vec3d Node::vector() const {
  if (json_->is_number()) return Vec3d(number());
  if (!json_->is_array() || json_->size() != 3) fail("is no number and no array of three");
  return {item(0).number(), item(1).number(), item(2).number()};
}

std::string Node::text() const {
  if (!json_->is_string()) fail("is no string");
  return json_->get<std::string>();
}

double Node::number(const char* key, double otherwise) const {
  const auto n = find(key);
  return n ? n->number() : otherwise;
}

Vec3d Node::vector(const char* key, const Vec3d& otherwise) const {
  const auto n = find(key);
  return n ? n->vector() : otherwise;
}

std::string Node::text(const char* key, const std::string& otherwise) const {
  const auto n = find(key);
  return n ? n->text() : otherwise;
}

bool Node::flag(const char* key, bool otherwise) const {
  const auto n = find(key);
  if (!n) return otherwise;
  if (!n->json().is_boolean()) n->fail("is neither true nor false");
  return n->json().get<bool>();
}

void Node::ignore(std::initializer_list<const char*> names) const {
  for (const char* name : names) find(name);
  if (names.size() > 0 || !json_->is_object()) return;
  enter_keys();
  for (const Json& value : *json_) account_->keys.at(&value).take();
}

namespace {

// Makes a, b and c orthonormal: a keeps its direction, b its part across a.
void orthonormalise(const Node& node, Vec3d& a, Vec3d& b, Vec3d& c) {
  if (!(dot(a, a) > 0)) node.fail("has an axis of length 0");
  a = normalize(a);
  b = b - a * dot(a, b);
  b = dot(b, b) < 1e-5 ? Onb<double>(a).x : normalize(b);
  c = c - a * dot(a, c);
  c = c - b * dot(b, c);
  c = dot(c, c) < 1e-5 ? cross(a, b) : normalize(c);
}

// About y, then x, then z of the turned frame; degrees. Radians are rounded as in Tungsten: the
// frame of a disk hangs on the sign of its normal's z, be that no more than the rounding's.
Affine rotation_of(const Vec3d& degrees) {
  const auto radians = [](double v) {
    return double{static_cast<float>(v) * std::numbers::pi_v<float> / 180};
  };
  const Vec3d r{radians(degrees.x), radians(degrees.y), radians(degrees.z)};
  const double cx = std::cos(r.x), cy = std::cos(r.y), cz = std::cos(r.z);
  const double sx = std::sin(r.x), sy = std::sin(r.y), sz = std::sin(r.z);
  return {{cy * cz - sy * sx * sz, cx * sz, sy * cz + cy * sx * sz},
          {-cy * sz - sy * sx * cz, cx * cz, -sy * sz + cy * sx * cz},
          {-sy * cx, -sx, cy * cx},
          {}};
}

Affine matrix_of(const Node& node) {
  if (node.json().size() != 16)
    node.fail("is a matrix of {} numbers, expected 16", node.json().size());
  double m[16];
  for (size_t i = 0; i < 16; ++i) m[i] = node.item(i).number();
  return {{m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}, {m[3], m[7], m[11]}};
}

}  // namespace

Affine transform_of(const Node& holder) {
  const auto found = holder.find("transform");
  if (!found) return {};
  const Node& node = *found;
  if (node.is_array()) return matrix_of(node);
  if (!node.is_object()) node.fail("is neither an object nor a matrix");
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const Vec3d position = node.vector("position", Vec3d(0));
  bool has_x = false, has_y = false, has_z = false;
  const auto axis = [&](const char* key, Vec3d& v, bool& has) {
    if (const auto n = node.find(key)) v = n->vector(), has = true;
  };
  if (const auto at = node.find("look_at")) z = at->vector() - position, has_z = true;
  axis("up", y, has_y);
  axis("x_axis", x, has_x);
  axis("y_axis", y, has_y);
  axis("z_axis", z, has_z);
  if (has_z && has_x && !has_y)
    orthonormalise(node, z, x, y);
  else if (has_z || !(has_x || has_y))
    orthonormalise(node, z, y, x);
  else if (has_x && has_y)
    orthonormalise(node, y, x, z);
  else if (has_x)
    orthonormalise(node, x, z, y);
  else
    orthonormalise(node, y, z, x);
  Vec3d& free = !has_x ? x : !has_y ? y : z;
  if (dot(cross(x, y), z) < 0) free = -free;
  const Vec3d scale = node.vector("scale", Vec3d(1));
  const Affine turn = rotation_of(node.vector("rotation", Vec3d(0)));
  return {turn.vector(x * scale.x), turn.vector(y * scale.y), turn.vector(z * scale.z), position};
}

}  // namespace tdpt::foreign::tungsten
