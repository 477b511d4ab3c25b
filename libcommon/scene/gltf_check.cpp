// Types, ranges and references of the JSON, by tables: one line per field that this room reads.
// Everything behind this file may take them for granted.
#include <fmt/format.h>
#include <cmath>
#include <numbers>

#include "libcommon/scene/gltf_document.h"

namespace tdpt::gltf {
namespace {

using Json = nlohmann::json;

enum class Kind { integer, index, indices, number, numbers, text, boolean, object, objects };

struct Field {
  const char* name;
  Kind kind;
  bool required = false;
  double low = 0, high = 9007199254740992.0;  ///< inclusive; of every number
  size_t count = 0;                           ///< of numbers
  const char* section = "";                   ///< that an index points into
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

std::string brief(const Json& value) {
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

  size_t size_of(const char* section) const {
    const auto it = root_.find(section);
    return it == root_.end() ? 0 : it->size();
  }

  /// Calls `visit(element, place)` for each object of a section.
  template <class Visit>
  void each(Json& parent, const std::string& where, const char* name, const Visit& visit) {
    const auto it = parent.find(name);
    if (it == parent.end()) return;
    const std::string at = where.empty() ? name : where + "." + name;
    for (size_t i = 0; i < it->size(); ++i) visit((*it)[i], place(at.c_str(), i));
  }

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

  // JSON has one kind of number: 3.0 and 3e0 are integers, too.
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
};

void check_accessors(Checker& c, Json& root) {
  c.each(root, "", "accessors", [&](Json& a, const std::string& at) {
    c.check(a, at,
            {index("bufferView", "bufferViews"), integer("byteOffset"), boolean("normalized"),
             integer("componentType", true), integer("count", true, 1), text("type", true),
             object("sparse")});
    const auto type = a["componentType"].get<uint64_t>();
    if (type < 5120 || type > 5126 || type == 5124)
      c.fail(at + ".componentType", a["componentType"],
             "5120, 5121, 5122, 5123, 5125 or 5126 (float)");
    constexpr const char* kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
    if (std::find(std::begin(kTypes), std::end(kTypes), a["type"].get<std::string>()) ==
        std::end(kTypes))
      c.fail(at + ".type", a["type"], "SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
    if (!a.contains("sparse")) return;
    Json& s = a["sparse"];
    c.check(s, at + ".sparse",
            {integer("count", true, 1, kInt), object("indices", true), object("values", true)});
    c.check(s["indices"], at + ".sparse.indices",
            {index("bufferView", "bufferViews", true), integer("byteOffset", false, 0, kInt),
             integer("componentType", true)});
    c.check(s["values"], at + ".sparse.values",
            {index("bufferView", "bufferViews", true), integer("byteOffset", false, 0, kInt)});
  });
}

void check_meshes(Checker& c, Json& root) {
  c.each(root, "", "meshes", [&](Json& m, const std::string& at) {
    c.check(m, at, {objects("primitives", true)});
    c.each(m, at, "primitives", [&](Json& p, const std::string& here) {
      c.check(p, here,
              {object("attributes", true), index("indices", "accessors"),
               index("material", "materials"), integer("mode", false, 0, 6)});
      for (const auto& [name, value] : p["attributes"].items())
        c.check(p["attributes"], here + ".attributes", {index(name.c_str(), "accessors")});
      if (p.contains("indices")) {
        const auto a = p["indices"].get<size_t>();
        if (!root["accessors"][a].contains("bufferView"))
          c.fail_missing(place("accessors", a) + ".bufferView", "indices need one");
      }
    });
  });
}

void check_nodes(Checker& c, Json& root) {
  c.each(root, "", "nodes", [&](Json& n, const std::string& at) {
    c.check(n, at,
            {text("name"), indices("children", "nodes"), index("mesh", "meshes"),
             index("camera", "cameras"), numbers("matrix", 16), numbers("translation", 3),
             numbers("rotation", 4), numbers("scale", 3), object("extensions")});
  });
  c.each(root, "", "scenes",
         [&](Json& s, const std::string& at) { c.check(s, at, {indices("nodes", "nodes")}); });
}

void check_cameras(Checker& c, Json& root) {
  c.each(root, "", "cameras", [&](Json& camera, const std::string& at) {
    c.check(camera, at,
            {text("name"), text("type", true), object("perspective"), object("orthographic")});
    const auto type = camera["type"].get<std::string>();
    if (type == "orthographic") {
      // Skipped with a warning; this keeps tinygltf from asking for its fields.
      camera["orthographic"] = {{"xmag", 1}, {"ymag", 1}, {"zfar", 1}, {"znear", 0}};
      return;
    }
    if (type != "perspective") c.fail(at + ".type", camera["type"], "perspective or orthographic");
    c.check(camera, at, {object("perspective", true)});
    Json& p = camera["perspective"];
    c.check(p, at + ".perspective", {number("yfov", true), number("aspectRatio")});
    const double yfov = p["yfov"].get<double>();
    if (!(yfov > 0 && yfov < std::numbers::pi))
      c.fail(at + ".perspective.yfov", p["yfov"], "an angle between 0 and pi");
    if (p.contains("aspectRatio") && !(p["aspectRatio"].get<double>() > 0))
      c.fail(at + ".perspective.aspectRatio", p["aspectRatio"], "more than 0");
    p["znear"] = 1;  // required of files, of no use here
    p.erase("zfar");
  });
}

void check_texture(Checker& c, Json& parent, const std::string& at, const char* name) {
  c.check(parent, at, {object(name)});
  if (!parent.contains(name)) return;
  Json& t = parent[name];
  const std::string here = at + "." + name;
  c.check(t, here,
          {index("index", "textures", true), integer("texCoord"), number("scale"),
           object("extensions")});
  if (!t.contains("extensions")) return;
  c.check(t["extensions"], here + ".extensions", {object("KHR_texture_transform")});
  if (t["extensions"].contains("KHR_texture_transform"))
    c.check(t["extensions"]["KHR_texture_transform"], here + ".extensions.KHR_texture_transform",
            {numbers("offset", 2), number("rotation"), numbers("scale", 2), integer("texCoord")});
}

void check_one_of(Checker& c, Json& parent, const std::string& at, const char* name,
                  std::initializer_list<int> values, const std::string& expected) {
  c.check(parent, at, {integer(name)});
  if (!parent.contains(name)) return;
  for (int v : values)
    if (parent[name] == v) return;
  c.fail(at + "." + name, parent[name], expected);
}

void check_extensions_of_material(Checker& c, Json& e, const std::string& at) {
  for (const auto& [name, value] : e.items())
    if (!value.is_object()) c.fail(at + "." + name.substr(0, 60), value, "an object");
  const auto check = [&](const char* name, std::initializer_list<Field> fields,
                         std::initializer_list<const char*> textures = {}) {
    if (!e.contains(name)) return;
    const std::string here = at + "." + name;
    c.check(e[name], here, fields);
    for (const char* texture : textures) check_texture(c, e[name], here, texture);
  };
  check("KHR_materials_emissive_strength", {number("emissiveStrength", false, 0)});
  check("KHR_materials_specular",
        {number("specularFactor", false, 0, 1), numbers("specularColorFactor", 3, 0)},
        {"specularTexture", "specularColorTexture"});
  check("KHR_materials_transmission", {number("transmissionFactor", false, 0, 1)},
        {"transmissionTexture"});
  check("KHR_materials_ior", {number("ior", false, 0)});
  check("KHR_materials_volume",
        {number("thicknessFactor", false, 0), number("attenuationDistance", false, 0),
         numbers("attenuationColor", 3, 0, 1)});
  if (e.contains("KHR_materials_ior") && e["KHR_materials_ior"].contains("ior")) {
    const Json& ior = e["KHR_materials_ior"]["ior"];
    const double n = ior.get<double>();
    if (n != 0 && !(n >= 1 && n <= 1e6))
      c.fail(at + ".KHR_materials_ior.ior", ior, "0 or a number from 1 to 1e6");
  }
  if (e.contains("KHR_materials_volume") &&
      e["KHR_materials_volume"].contains("attenuationDistance")) {
    const Json& distance = e["KHR_materials_volume"]["attenuationDistance"];
    if (!(distance.get<double>() > 0))
      c.fail(at + ".KHR_materials_volume.attenuationDistance", distance, "more than 0");
  }
}

void check_materials(Checker& c, Json& root) {
  c.each(root, "", "materials", [&](Json& m, const std::string& at) {
    c.check(m, at,
            {text("name"), numbers("emissiveFactor", 3, 0), text("alphaMode"),
             number("alphaCutoff", false, 0), boolean("doubleSided"),
             object("pbrMetallicRoughness"), object("extensions")});
    if (m.contains("alphaMode")) {
      const auto mode = m["alphaMode"].get<std::string>();
      if (mode != "OPAQUE" && mode != "MASK" && mode != "BLEND")
        c.fail(at + ".alphaMode", m["alphaMode"], "OPAQUE, MASK or BLEND");
    }
    check_texture(c, m, at, "emissiveTexture");
    check_texture(c, m, at, "normalTexture");
    if (m.contains("pbrMetallicRoughness")) {
      Json& pbr = m["pbrMetallicRoughness"];
      const std::string here = at + ".pbrMetallicRoughness";
      c.check(pbr, here,
              {numbers("baseColorFactor", 4, 0), number("metallicFactor", false, 0, 1),
               number("roughnessFactor", false, 0, 1)});
      check_texture(c, pbr, here, "baseColorTexture");
      check_texture(c, pbr, here, "metallicRoughnessTexture");
    }
    if (m.contains("extensions"))
      check_extensions_of_material(c, m["extensions"], at + ".extensions");
  });
}

void check_textures(Checker& c, Json& root) {
  c.each(root, "", "textures", [&](Json& t, const std::string& at) {
    c.check(t, at, {index("source", "images"), index("sampler", "samplers")});
  });
  c.each(root, "", "images", [&](Json& i, const std::string& at) {
    c.check(i, at, {text("uri"), index("bufferView", "bufferViews")});
  });
  c.each(root, "", "samplers", [&](Json& s, const std::string& at) {
    check_one_of(c, s, at, "magFilter", {9728, 9729}, "9728 (nearest) or 9729 (linear)");
    for (const char* wrap : {"wrapS", "wrapT"})
      check_one_of(c, s, at, wrap, {10497, 33648, 33071},
                   "10497 (repeat), 33648 (mirrored repeat) or 33071 (clamp to edge)");
  });
}

/// KHR_lights_punctual: the lights of the file, and the nodes that hold one.
void check_lights(Checker& c, Json& root) {
  constexpr const char* kName = "KHR_lights_punctual";
  const auto lights_of = [&](Json& owner, const std::string& at) -> Json* {
    if (!owner.contains("extensions")) return nullptr;
    c.check(owner["extensions"], at + "extensions", {object(kName)});
    return owner["extensions"].contains(kName) ? &owner["extensions"][kName] : nullptr;
  };
  size_t lights = 0;
  const std::string where = std::string("extensions.") + kName;
  if (Json* owner = lights_of(root, "")) {
    c.check(*owner, where, {objects("lights", true)});
    lights = (*owner)["lights"].size();
    c.each(*owner, where, "lights", [&](Json& l, const std::string& at) {
      c.check(l, at,
              {text("name"), text("type", true), numbers("color", 3, 0),
               number("intensity", false, 0), object("spot")});
      const auto type = l["type"].get<std::string>();
      if (type != "point" && type != "spot" && type != "directional")
        c.fail(at + ".type", l["type"], "point, spot or directional");
      if (!l.contains("spot")) return;
      Json& s = l["spot"];
      c.check(s, at + ".spot", {number("innerConeAngle"), number("outerConeAngle")});
      const double inner = s.value("innerConeAngle", 0.0);
      const double outer = s.value("outerConeAngle", std::numbers::pi / 4);
      // Files round pi/2 to single precision.
      if (!(inner >= 0 && inner < outer && outer <= std::numbers::pi / 2 + 1e-6))
        c.fail_because(at + ".spot",
                       fmt::format("has an inner cone of {} and an outer one of {}, expected "
                                   "0 <= inner < outer <= pi/2",
                                   inner, outer));
    });
  }
  c.each(root, "", "nodes", [&](Json& n, const std::string& at) {
    if (Json* owner = lights_of(n, at + ".")) {
      const std::string here = at + ".extensions." + kName;
      c.check(*owner, here, {integer("light", true)});
      const Json& light = (*owner)["light"];
      if (light.get<uint64_t>() >= lights)
        c.fail(here + ".light", light, fmt::format("an index into the {} lights", lights));
    }
  });
}

}  // namespace

void check_json(Json& root, const std::string& file) {
  Checker c(root, file);
  c.check(root, "",
          {object("asset", true), objects("buffers"), objects("bufferViews"), objects("accessors"),
           objects("meshes"), objects("nodes"), objects("scenes"), objects("cameras"),
           objects("materials"), objects("textures"), objects("images"), objects("samplers"),
           object("extensions"), index("scene", "scenes")});
  c.check(root["asset"], "asset", {text("version", true)});
  for (const char* list : {"extensionsUsed", "extensionsRequired"})
    if (root.contains(list)) {
      if (!root[list].is_array()) c.fail(list, root[list], "an array");
      for (size_t i = 0; i < root[list].size(); ++i)
        if (!root[list][i].is_string()) c.fail(place(list, i), root[list][i], "a string");
    }
  c.each(root, "", "buffers", [&](Json& b, const std::string& at) {
    c.check(b, at, {integer("byteLength", true, 1), text("uri")});
  });
  c.each(root, "", "bufferViews", [&](Json& v, const std::string& at) {
    c.check(v, at,
            {index("buffer", "buffers", true), integer("byteOffset"),
             integer("byteLength", true, 1), integer("byteStride", false, 4, 252)});
  });
  check_accessors(c, root);
  check_meshes(c, root);
  check_nodes(c, root);
  check_cameras(c, root);
  check_materials(c, root);
  check_textures(c, root);
  check_lights(c, root);
}

}  // namespace tdpt::gltf
