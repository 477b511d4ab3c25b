// PLY ("The PLY Polygon File Format", Turk 1994): a text header declares elements and their
// properties; then come their values, element by element, as words or as bytes of either order.
#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign {
namespace {

struct Type {
  std::string_view name, sized_name;
  size_t size;
  double (*value)(const char* bytes, std::endian order);
};
template <class T>
double decoded(const char* bytes, std::endian order) {
  return static_cast<double>(value_at<T>(bytes, order));
}
constexpr Type kTypes[] = {
    {"char", "int8", 1, decoded<int8_t>},    {"uchar", "uint8", 1, decoded<uint8_t>},
    {"short", "int16", 2, decoded<int16_t>}, {"ushort", "uint16", 2, decoded<uint16_t>},
    {"int", "int32", 4, decoded<int32_t>},   {"uint", "uint32", 4, decoded<uint32_t>},
    {"float", "float32", 4, decoded<float>}, {"double", "float64", 8, decoded<double>}};

// What a property holds: a coordinate of a vertex's position, normal or uv, or a face's corners.
enum Target { px, py, pz, nx, ny, nz, tu, tv, corners, nothing };
constexpr std::pair<std::string_view, Target> kVertexTargets[] = {
    {"x", px},         {"y", py},         {"z", pz},         {"nx", nx},       {"ny", ny},
    {"nz", nz},        {"u", tu},         {"v", tv},         {"s", tu},        {"t", tv},
    {"texture_u", tu}, {"texture_v", tv}, {"texture_s", tu}, {"texture_t", tv}};

struct Property {
  const Type* type;
  const Type* length;  ///< of a list; null: one value
  Target target;
};
struct Element {
  std::string name;
  uint64_t count;
  std::vector<Property> properties{};

  bool has(std::initializer_list<Target> targets) const {
    return std::all_of(targets.begin(), targets.end(), [&](Target target) {
      return std::any_of(properties.begin(), properties.end(),
                         [&](const Property& p) { return p.target == target; });
    });
  }
};

class PlyReader {
 public:
  PlyReader(std::string_view bytes, const std::string& name) : rest_(bytes), name_(name) {}

  Mesh mesh() {
    header();
    for (const Element& e : elements_) {
      if (e.name == "vertex" && !e.has({px, py, pz})) fail("header", "vertices have no x, y and z");
      if (e.name == "face" && e.count > 0 && !e.has({corners}))
        fail("header", "faces have no list vertex_indices");
      if (!e.properties.empty())
        for (uint64_t i = 0; i < e.count; ++i) read(e, i);
      if (e.name == "vertex" && !e.has({nx, ny, nz})) mesh_.normals.clear();
      if (e.name == "vertex" && !e.has({tu, tv})) mesh_.uv.clear();
    }
    check(mesh_, name_);
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& place, const std::string& words) const {
    throw InputError(name_, place, words);
  }

  void header() {
    const char line_end = rest_.starts_with("ply\r") && !rest_.starts_with("ply\r\n") ? '\r' : '\n';
    bool has_format = false;
    for (size_t number = 1;; ++number) {
      const size_t end = rest_.find(line_end);
      if (end == rest_.npos) fail("header", "ends before end_header");
      const auto words = words_of(rest_.substr(0, end));
      rest_.remove_prefix(end + 1);
      if (number == 1 && (words.size() != 1 || words[0] != "ply")) fail("line 1", "is not \"ply\"");
      if (number == 1 || words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      has_format |= words[0] == "format";
      if (!declares(words))
        fail(fmt::format("line {}", number),
             fmt::format("\"{}\" is no line of a PLY header",
                         shown(fmt::format("{}", fmt::join(words, " ")), 40)));
    }
    if (!has_format) fail("header", "has no format");
  }

  // Whether a line of the header is a format, an element or a property.
  bool declares(const std::vector<std::string_view>& words) {
    if (words[0] == "format" && words.size() == 3) {
      is_ascii_ = words[1] == "ascii";
      order_ = words[1] == "binary_big_endian" ? std::endian::big : std::endian::little;
      return is_ascii_ || words[1] == "binary_big_endian" || words[1] == "binary_little_endian";
    }
    if (words[0] == "element" && words.size() == 3) {
      Element e{std::string(words[1]), 0};
      const auto [end, error] = std::from_chars(words[2].begin(), words[2].end(), e.count);
      elements_.push_back(std::move(e));
      return error == std::errc() && end == words[2].end();
    }
    const bool is_list = words.size() == 5 && words[1] == "list";
    if (words[0] != "property" || (words.size() != 3 && !is_list) || elements_.empty())
      return false;
    const auto type_named = [](std::string_view name) -> const Type* {
      for (const Type& t : kTypes)
        if (name == t.name || name == t.sized_name) return &t;
      return nullptr;
    };
    const Property p{type_named(words[words.size() - 2]), is_list ? type_named(words[2]) : nullptr,
                     target_of(words.back(), is_list)};
    elements_.back().properties.push_back(p);
    return p.type && (!is_list || p.length);
  }

  // What a property of the last element holds.
  Target target_of(std::string_view name, bool is_list) const {
    const std::string& element = elements_.back().name;
    if (is_list)
      return element == "face" && (name == "vertex_indices" || name == "vertex_index") ? corners
                                                                                       : nothing;
    if (element == "vertex")
      for (const auto& [word, target] : kVertexTargets)
        if (word == name) return target;
    return nothing;
  }

  // Reads element number `index` of a kind. As all of its values take bytes, the file's size bounds
  // the memory.
  void read(const Element& e, uint64_t index) {
    const auto fail_here = [&](const std::string& words) {
      fail(fmt::format("{} {}", shown(e.name, 40), index), words);
    };
    const auto value = [&](const Type& type) {
      constexpr std::string_view white = " \t\r\n\v\f";
      if (is_ascii_) rest_.remove_prefix(std::min(rest_.find_first_not_of(white), rest_.size()));
      if (rest_.size() < (is_ascii_ ? 1 : type.size))
        fail_here("the file ends before it is complete");
      const auto bytes = rest_.substr(0, is_ascii_ ? rest_.find_first_of(white) : type.size);
      rest_.remove_prefix(bytes.size());
      if (!is_ascii_) return type.value(bytes.data(), order_);
      const auto number = number_in(bytes);
      if (!number) fail_here(fmt::format("\"{}\" is not a number", shown(bytes, 40)));
      return *number;
    };
    const auto whole = [&](const Type& type, const char* what) {
      const double n = value(type);
      if (!(n >= 0 && n <= 0xffffffff) || n != std::floor(n))
        fail_here(fmt::format("{} is no {}", n, what));
      return static_cast<uint32_t>(n);
    };
    float v[nothing] = {};
    for (const Property& p : e.properties) {
      const uint32_t count = p.length ? whole(*p.length, "length of a list") : 1;
      uint32_t first = 0, last = 0;
      for (uint32_t i = 0; i < count; ++i) {
        if (p.target != corners) {
          const double x = value(*p.type);
          if (p.target != nothing) v[p.target] = static_cast<float>(x);
          continue;
        }
        const uint32_t corner = whole(*p.type, "number of a vertex");
        if (i == 0) first = corner;
        if (i >= 2) mesh_.triangles.push_back({first, last, corner});
        last = corner;
      }
    }
    if (e.name != "vertex") return;
    mesh_.positions.push_back({v[px], v[py], v[pz]});
    mesh_.normals.push_back({v[nx], v[ny], v[nz]});
    mesh_.uv.push_back({v[tu], v[tv]});
  }

  std::string_view rest_;
  const std::string& name_;
  bool is_ascii_ = false;
  std::endian order_ = std::endian::little;
  std::vector<Element> elements_;
  Mesh mesh_;
};

}  // namespace

Mesh read_ply(std::string_view bytes, const std::string& name) {
  return PlyReader(bytes, name).mesh();
}

}  // namespace tdpt::foreign
