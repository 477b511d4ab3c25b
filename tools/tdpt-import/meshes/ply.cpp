// PLY ("The PLY Polygon File Format", Turk 1994): a text header declares elements and their
// properties; then come their values, element by element, as words or as bytes of either order.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

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

// What a property of a vertex is: position, normal, uv.
enum Slot { px, py, pz, nx, ny, nz, tu, tv, slots };

std::optional<Slot> slot_of(std::string_view name) {
  static constexpr std::pair<std::string_view, Slot> all[] = {
      {"x", px},         {"y", py},         {"z", pz},         {"nx", nx},       {"ny", ny},
      {"nz", nz},        {"u", tu},         {"v", tv},         {"s", tu},        {"t", tv},
      {"texture_u", tu}, {"texture_v", tv}, {"texture_s", tu}, {"texture_t", tv}};
  for (const auto& [word, slot] : all)
    if (word == name) return slot;
  return {};
}

struct Property {
  std::string name;
  const Type* type;
  const Type* length = nullptr;  ///< set: a list
};
struct Element {
  std::string name;
  uint64_t count;
  std::vector<Property> properties{};
};

class PlyReader {
 public:
  PlyReader(std::string_view bytes, const std::string& name) : rest_(bytes), name_(name) {}

  Mesh mesh() {
    header();
    for (const Element& e : elements_) {
      if (e.name == "tristrips" && e.count > 0)
        fail("header", "has triangle strips, which are not supported; expected \"element face\"");
      expect_bytes(e);
      if (e.name == "vertex")
        vertices(e);
      else if (e.name == "face")
        faces(e);
      else
        skip(e);
    }
    check(mesh_, name_);
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& place, const std::string& words) const {
    throw InputError(name_, place, words);
  }
  [[noreturn]] void fail_here(const std::string& words) const {
    fail(fmt::format("{} {}", element_, number_), words);
  }

  // ---- header

  std::string line_place() const { return fmt::format("line {}", line_); }

  std::vector<std::string_view> line() {
    const size_t end = rest_.find(line_end_);
    if (end == rest_.npos) fail("header", "ends before end_header");
    std::string_view text = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    ++line_;
    return words_of(text);
  }

  void header() {
    if (rest_.starts_with("ply\r") && !rest_.starts_with("ply\r\n")) line_end_ = '\r';
    if (const auto words = line(); words.size() != 1 || words[0] != "ply")
      fail("line 1", "is not \"ply\"");
    for (;;) {
      const auto words = line();
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (words[0] == "format" && words.size() == 3)
        format(words[1]);
      else if (words[0] == "element" && words.size() == 3)
        element(words[1], words[2]);
      else if (words[0] == "property" && words.size() >= 3)
        property(words);
      else
        fail(line_place(), fmt::format("\"{}\" is no line of a PLY header", shown(words[0], 40)));
    }
    if (!has_format_) fail("header", "has no format");
  }

  void format(std::string_view word) {
    has_format_ = true;
    ascii_ = word == "ascii";
    order_ = word == "binary_big_endian" ? std::endian::big : std::endian::little;
    if (!ascii_ && word != "binary_big_endian" && word != "binary_little_endian")
      fail(line_place(), fmt::format("unknown format \"{}\"", shown(word, 40)));
  }

  void element(std::string_view name, std::string_view count) {
    for (const Element& e : elements_)
      if (e.name == name)
        fail(line_place(), fmt::format("a second element \"{}\"", shown(name, 40)));
    Element e{std::string(name), 0};
    const auto [end, error] = std::from_chars(count.begin(), count.end(), e.count);
    if (error != std::errc() || end != count.end())
      fail(line_place(), fmt::format("\"{}\" is no number of elements", shown(count, 40)));
    elements_.push_back(std::move(e));
  }

  void property(const std::vector<std::string_view>& words) {
    if (elements_.empty()) fail(line_place(), "a property before the first element");
    const bool list = words[1] == "list";
    if (words.size() != (list ? 5 : 3)) fail(line_place(), "a property of too few or many words");
    const auto type = [&](size_t i) -> const Type* {
      for (const Type& t : kTypes)
        if (words[i] == t.name || words[i] == t.sized_name) return &t;
      fail(line_place(), fmt::format("unknown type \"{}\"", shown(words[i], 40)));
    };
    Property p{std::string(words.back()), type(list ? 3 : 1)};
    if (list) p.length = type(2);
    if (p.length >= &kTypes[6]) fail(line_place(), "a list's length is not an integer");
    elements_.back().properties.push_back(std::move(p));
  }

  // ---- values

  // The least that the elements can take: so no memory is taken for a wrong count.
  void expect_bytes(const Element& e) {
    size_t least = 0;
    for (const Property& p : e.properties)
      least += ascii_ ? 2 : (p.length ? p.length : p.type)->size;
    // The file may end without white space.
    const size_t most = least ? (rest_.size() + (ascii_ ? 1 : 0)) / least : 0;
    if (least && e.count > most)
      fail("header", fmt::format("{} elements \"{}\", but bytes for at most {}", e.count,
                                 shown(e.name, 40), most));
    element_ = shown(e.name, 40);
    number_ = 0;
  }

  double value(const Type* type) {
    constexpr std::string_view white = " \t\r\n\v\f";
    if (ascii_) rest_.remove_prefix(std::min(rest_.find_first_not_of(white), rest_.size()));
    if (rest_.size() < (ascii_ ? 1 : type->size)) fail_here("the file ends before it is complete");
    const auto bytes = rest_.substr(0, ascii_ ? rest_.find_first_of(white) : type->size);
    rest_.remove_prefix(bytes.size());
    if (!ascii_) return type->value(bytes.data(), order_);
    if (const auto number = number_in(bytes)) return *number;
    fail_here(fmt::format("\"{}\" is not a number", shown(bytes, 40)));
  }

  uint64_t length(const Property& p) {
    const double n = value(p.length);
    const size_t least = ascii_ ? 2 : p.type->size;
    const size_t most = (rest_.size() + (ascii_ ? 1 : 0)) / least;
    if (!(n >= 0) || n != std::floor(n)) fail_here(fmt::format("a list of {} values", n));
    if (n > static_cast<double>(most))
      fail_here(fmt::format("a list of {} values, but bytes for at most {}", n, most));
    return static_cast<uint64_t>(n);
  }

  void skip(const Property& p) {
    uint64_t n = p.length ? length(p) : 1;
    while (n-- > 0) value(p.type);
  }
  void skip(const Element& e) {
    if (e.properties.empty()) return;
    for (; number_ < e.count; ++number_)
      for (const Property& p : e.properties) skip(p);
  }

  void vertices(const Element& e) {
    bool has[slots] = {};
    std::vector<std::optional<Slot>> targets;
    for (const Property& p : e.properties) {
      targets.push_back(p.length ? std::nullopt : slot_of(p.name));
      if (targets.back()) has[*targets.back()] = true;
    }
    if (!has[px] || !has[py] || !has[pz]) fail("header", "vertices have no x, y and z");
    const bool normals = has[nx] && has[ny] && has[nz], uv = has[tu] && has[tv];
    for (; number_ < e.count; ++number_) {
      float v[slots] = {};
      for (size_t i = 0; i < targets.size(); ++i)
        if (const auto slot = targets[i])
          v[*slot] = static_cast<float>(value(e.properties[i].type));
        else
          skip(e.properties[i]);
      mesh_.positions.push_back({v[px], v[py], v[pz]});
      if (normals) mesh_.normals.push_back({v[nx], v[ny], v[nz]});
      if (uv) mesh_.uv.push_back({v[tu], v[tv]});
    }
  }

  void faces(const Element& e) {
    const auto is_corners = [](const Property& p) {
      return p.length && (p.name == "vertex_indices" || p.name == "vertex_index");
    };
    if (e.count > 0 && std::none_of(e.properties.begin(), e.properties.end(), is_corners))
      fail("header", "faces have no list vertex_indices");
    for (; number_ < e.count; ++number_)
      for (const Property& p : e.properties)
        if (is_corners(p))
          polygon(p);
        else
          skip(p);
  }

  void polygon(const Property& p) {
    uint32_t first = 0, last = 0;
    const uint64_t n = length(p);
    for (uint64_t i = 0; i < n; ++i) {
      const double at = value(p.type);
      if (!(at >= 0 && at <= 0xffffffff) || at != std::floor(at))
        fail_here(fmt::format("{} is no number of a vertex", at));
      const auto corner = static_cast<uint32_t>(at);
      if (corner >= vertex_count())
        fail_here(
            fmt::format("refers to vertex {}, but the file has only {}", corner, vertex_count()));
      if (i == 0)
        first = corner;
      else if (i >= 2)
        mesh_.triangles.push_back({first, last, corner});
      last = corner;
    }
  }

  uint64_t vertex_count() const {
    for (const Element& e : elements_)
      if (e.name == "vertex") return e.count;
    return 0;
  }

  std::string_view rest_;
  const std::string& name_;
  char line_end_ = '\n';  ///< of the header
  size_t line_ = 0;
  bool has_format_ = false, ascii_ = false;
  std::endian order_ = std::endian::little;
  std::vector<Element> elements_;
  std::string element_;  ///< being read
  uint64_t number_ = 0;  ///< of it, from 0
  Mesh mesh_;
};

}  // namespace

Mesh read_ply(std::string_view bytes, const std::string& name) {
  return PlyReader(bytes, name).mesh();
}

}  // namespace tdpt::foreign
