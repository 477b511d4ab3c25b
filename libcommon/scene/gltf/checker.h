// Tables of JSON fields, and the class that checks JSON against them. Internal to this room and to
// the files that check.
#pragma once
#include <fmt/format.h>
#include <cmath>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

/// Whether this attribute of a primitive or morph target is read at all.
bool is_read_attribute(const std::string& name);

using Json = nlohmann::json;

enum class Kind { integer, index, indices, number, numbers, text, boolean, object, objects };

struct Field {
  const char* name;
  Kind kind;
  bool required = false;
  double low = 0, high = 9007199254740992.0;  ///< inclusive; for every number
  size_t count = 0;                           ///< number of elements
  const char* section = "";                   ///< section that an index points into
};

constexpr double kAny = 1.7e308, kInt = 2147483647;

constexpr Field integer(const char* name, bool required = false, double low = 0,
                        double high = 9007199254740992.0) {
  return {name, Kind::integer, required, low, high};
}
constexpr Field index(const char* name, const char* section, bool required = false) {
  return {name, Kind::index, required, 0, 0, 0, section};
}
constexpr Field indices(const char* name, const char* section) {
  return {name, Kind::indices, false, 0, 0, 0, section};
}
constexpr Field number(const char* name, bool required = false, double low = -kAny,
                       double high = kAny) {
  return {name, Kind::number, required, low, high};
}
constexpr Field numbers(const char* name, size_t count, double low = -kAny, double high = kAny) {
  return {name, Kind::numbers, false, low, high, count};
}
constexpr Field text(const char* name, bool required = false) {
  return {name, Kind::text, required};
}
constexpr Field boolean(const char* name) {
  return {name, Kind::boolean};
}
constexpr Field object(const char* name, bool required = false) {
  return {name, Kind::object, required};
}
constexpr Field objects(const char* name, bool required = false) {
  return {name, Kind::objects, required};
}

inline std::string brief(const Json& value) {
  if (value.is_array()) return fmt::format("an array of {}", value.size());
  if (value.is_object()) return "an object";
  std::string out = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  return out.size() > 40 ? out.substr(0, 40) + "..." : out;
}

class Checker {
 public:
  Checker(Json& root, const std::string& file) : root_(root), file_(file) {}

  void check(Json& value, const std::string& where, std::initializer_list<Field> fields) {
    if (!value.is_object()) fail(where, value, "an object");
    for (const Field& f : fields) {
      const std::string at = where.empty() ? f.name : where + "." + f.name;
      if (!value.contains(f.name)) {
        if (f.required) throw InputError(file_, at, "is missing");
        continue;
      }
      check_field(value[f.name], at, f);
    }
  }

  /// An extension of `owner`, checked against these fields; null if absent.
  Json* check_extension(Json& owner, const std::string& where, const char* name,
                        std::initializer_list<Field> fields) {
    const auto all = owner.find("extensions");
    if (all == owner.end()) return nullptr;
    const std::string at = where.empty() ? "extensions" : where + ".extensions";
    if (!all->is_object()) fail(at, *all, "an object");
    const auto found = all->find(name);
    if (found == all->end()) return nullptr;
    check(*found, at + "." + name, fields);
    return &*found;
  }

  size_t size_of(const char* section) const {
    const auto it = root_.find(section);
    return it == root_.end() ? 0 : it->size();
  }

  /// Calls `visit(element, place)` for each object of a list.
  template <class Visit>
  void each(Json& parent, const std::string& where, const char* name, const Visit& visit) {
    const auto it = parent.find(name);
    if (it == parent.end()) return;
    const std::string at = where.empty() ? name : where + "." + name;
    for (size_t i = 0; i < it->size(); ++i) visit((*it)[i], place(at.c_str(), i));
  }

  void note(const std::string& warning) { notes_.push_back(warning); }

  /// Sentences about what changes no picture.
  const std::vector<std::string>& notes() const { return notes_; }

  [[noreturn]] void fail_missing(const std::string& where, const std::string& why) const {
    throw InputError(file_, where, "is missing, " + why);
  }
  [[noreturn]] void fail_because(const std::string& where, const std::string& why) const {
    throw InputError(file_, where, why);
  }
  [[noreturn]] void fail(const std::string& where, const Json& found,
                         const std::string& expected) const {
    throw InputError(file_, where, fmt::format("is {}, expected {}", brief(found), expected));
  }

 private:
  void check_field(Json& v, const std::string& at, const Field& f) {
    switch (f.kind) {
      case Kind::integer:
        return check_integer(v, at, f.low, f.high);
      case Kind::index:
        return check_index(v, at, f.section);
      case Kind::indices:
        if (!v.is_array()) fail(at, v, "an array of indices");
        for (size_t i = 0; i < v.size(); ++i) check_index(v[i], place(at.c_str(), i), f.section);
        return;
      case Kind::number:
        return check_number(v, at, f);
      case Kind::numbers:
        if (!v.is_array() || v.size() != f.count)
          fail(at, v, fmt::format("an array of {} numbers", f.count));
        for (size_t i = 0; i < v.size(); ++i) check_number(v[i], place(at.c_str(), i), f);
        return;
      case Kind::text:
        if (!v.is_string()) fail(at, v, "a string");
        return;
      case Kind::boolean:
        if (!v.is_boolean()) fail(at, v, "true or false");
        return;
      case Kind::object:
        if (!v.is_object()) fail(at, v, "an object");
        return;
      case Kind::objects:
        if (!v.is_array()) fail(at, v, "an array");
        for (size_t i = 0; i < v.size(); ++i)
          if (!v[i].is_object()) fail(place(at.c_str(), i), v[i], "an object");
        return;
    }
  }

  // JSON has only one kind of number: 3.0 and 3e0 are integers, too.
  void check_integer(Json& v, const std::string& at, double low, double high) {
    if (!v.is_number()) fail(at, v, "an integer");
    const double x = v.get<double>();
    if (!(x >= low && x <= high) || x != std::floor(x))
      fail(at, v, fmt::format("an integer from {:.0f} to {:.0f}", low, high));
    v = static_cast<uint64_t>(x);
  }

  void check_index(Json& v, const std::string& at, const char* section) {
    const size_t n = size_of(section);
    if (v.is_number() && v.get<double>() >= 0 && v.get<double>() < static_cast<double>(n) &&
        v.get<double>() == std::floor(v.get<double>())) {
      v = static_cast<uint64_t>(v.get<double>());
      return;
    }
    fail(at, v, fmt::format("an index into the {} {}", n, section));
  }

  void check_number(const Json& v, const std::string& at, const Field& f) {
    if (!v.is_number()) fail(at, v, "a number");
    const double x = v.get<double>();
    if (std::isfinite(x) && x >= f.low && x <= f.high) return;
    fail(at, v,
         f.high == kAny ? fmt::format("a number of at least {}", f.low)
                        : fmt::format("a number from {} to {}", f.low, f.high));
  }

  Json& root_;
  const std::string& file_;
  std::vector<std::string> notes_;
};

/// Extensions that compress a primitive, a buffer or a bufferView.
void check_draco(Checker& checker, Json& primitive, const std::string& place);
void check_meshopt_buffer(Checker& checker, Json& buffer, const std::string& place);
void check_meshopt_view(Checker& checker, Json& view, const std::string& place);

void check_materials(Checker& checker, Json& root);
void check_textures(Checker& checker, Json& root);

/// Lights, and the extensions of nodes that hold one.
void check_lights(Checker& checker, Json& root);
void check_light_of_node(Checker& checker, const Json& root, Json& node, const std::string& place);

/// Skins, and extensions of nodes.
void check_skins(Checker& checker, Json& root);
/// Weights of morph targets, of a node or a mesh.
void check_weights(Checker& checker, Json& owner, const std::string& place);
/// Keeps only the first channel that moves a given property of a node in the scene.
void check_animations(Checker& checker, Json& root, const std::vector<std::string>& wanted);
/// Accessors of the attributes that are read; removes the others.
void check_attributes(Checker& checker, Json& attributes, const std::string& place);
/// Morph targets of a primitive.
void check_targets(Checker& checker, Json& primitive, const std::string& place);

/// Scenes and nodes.
void check_nodes(Checker& checker, Json& root);

}  // namespace tdpt::gltf
