// Portal files are ordinary glTF 2.0, so they come from portalfit or from any modelling program.
// Nothing a file says is believed before it is checked: every index, offset and length is compared
// with what it points into by subtraction, so no sum can overflow.
#include "libcommon/formats/portal.h"

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/hash.h"
#include "tdpt_version.h"

namespace tdpt {
namespace {

using Json = nlohmann::json;

constexpr uint32_t kGlbMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinChunk = 0x004e4942;
constexpr size_t kMostTriangles = 1'000'000;  // of a whole file; one node mesh may stand many times

// Affine map, columns of the linear part and the translation.
struct Affine {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, t{};
  Vec3d linear(const Vec3d& v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3d operator()(const Vec3d& p) const { return linear(p) + t; }
  Affine operator*(const Affine& b) const {
    return {linear(b.x), linear(b.y), linear(b.z), (*this)(b.t)};
  }
  bool mirrors() const { return dot(cross(x, y), z) < 0; }
};

uint32_t little_endian(std::string_view bytes, size_t at, int size) {
  uint32_t value = 0;
  for (int i = 0; i < size; ++i)
    value |= static_cast<uint32_t>(static_cast<unsigned char>(bytes[at + static_cast<size_t>(i)]))
             << (8 * i);
  return value;
}

class Reader {
 public:
  explicit Reader(const std::string& path)
      : name_(display_name(path)), folder_(std::filesystem::path(path).parent_path()) {}

  PortalFile read(const std::string& bytes) {
    open(bytes);
    PortalFile file;
    file.hash = content_hash(bytes);
    read_asset(file);
    for (const auto& [node, map] : placed_meshes()) read_portal(node, map, file);
    return file;
  }

 private:
  [[noreturn]] void fail(const std::string& place, const std::string& what) const {
    throw InputError(name_, place, what);
  }

  // --- container ---

  void open(const std::string& bytes) {
    std::string_view text = bytes;
    if (bytes.size() >= 12 && little_endian(bytes, 0, 4) == kGlbMagic) {
      if (const uint32_t version = little_endian(bytes, 4, 4); version != 2)
        fail("header", fmt::format("glTF version {}, expected 2", version));
      if (const uint32_t length = little_endian(bytes, 8, 4); length != bytes.size())
        fail("header", fmt::format("says {} bytes, but {} are there", length, bytes.size()));
      text = {};
      bool first = true;
      for (size_t at = 12; at < bytes.size(); first = false) {
        if (bytes.size() - at < 8) fail(fmt::format("byte {}", at), "a chunk header is cut short");
        const size_t length = little_endian(bytes, at, 4);
        const uint32_t type = little_endian(bytes, at + 4, 4);
        if (length > bytes.size() - at - 8)
          fail(fmt::format("byte {}", at), "a chunk is longer than the file");
        const std::string_view chunk = std::string_view(bytes).substr(at + 8, length);
        if (first && type == kJsonChunk) text = chunk;
        if (!first && type == kBinChunk && !bin_) bin_ = std::string(chunk);
        at += 8 + length;
      }
      if (text.empty()) fail("header", "the first chunk is no JSON chunk");
    }
    root_ = Json::parse(text, nullptr, false);
    if (root_.is_discarded() || !root_.is_object())
      fail("", "is neither .glb nor .gltf, expected a glTF 2.0 file");
    for (const Json& extension : array(root_, "extensionsRequired", ""))
      if (extension != "KHR_mesh_quantization" && extension != "KHR_materials_unlit")
        fail("extensionsRequired",
             fmt::format("needs {}, which is not known here", extension.dump(-1, ' ', true)));
  }

  // --- JSON with places ---

  const Json& array(const Json& object, const char* key, const std::string& place) const {
    static const Json none = Json::array();
    const auto found = object.find(key);
    if (found == object.end()) return none;
    if (!found->is_array()) fail(place.empty() ? key : place + "." + key, "expected an array");
    return *found;
  }

  const Json& element(const char* list, size_t i) const {
    const Json& all = array(root_, list, "");
    const std::string place = fmt::format("{}[{}]", list, i);
    if (i >= all.size()) fail(place, fmt::format("does not exist, there are {}", all.size()));
    if (!all[i].is_object()) fail(place, "expected an object");
    return all[i];
  }

  std::optional<size_t> size_at(const Json& object, const char* key,
                                const std::string& place) const {
    const auto found = object.find(key);
    if (found == object.end()) return {};
    if (!found->is_number_unsigned())
      fail(place, fmt::format("\"{}\" is no non-negative integer", key));
    return found->get<size_t>();
  }

  template <size_t N>
  std::optional<std::array<double, N>> numbers(const Json& object, const char* key,
                                               const std::string& place) const {
    const auto found = object.find(key);
    if (found == object.end()) return {};
    std::array<double, N> values{};
    bool good = found->is_array() && found->size() == N;
    for (size_t i = 0; good && i < N; ++i) {
      good = (*found)[i].is_number();
      if (good) values[i] = (*found)[i].template get<double>();
      good = good && std::isfinite(values[i]);
    }
    if (!good) fail(place, fmt::format("\"{}\" is not {} finite numbers", key, N));
    return values;
  }

  // --- nodes ---

  Affine node_map(const Json& node, const std::string& place) const {
    if (const auto m = numbers<16>(node, "matrix", place)) {
      const auto& a = *m;
      return {{a[0], a[1], a[2]}, {a[4], a[5], a[6]}, {a[8], a[9], a[10]}, {a[12], a[13], a[14]}};
    }
    const auto t = numbers<3>(node, "translation", place).value_or(std::array{0., 0., 0.});
    const auto s = numbers<3>(node, "scale", place).value_or(std::array{1., 1., 1.});
    auto q = numbers<4>(node, "rotation", place).value_or(std::array{0., 0., 0., 1.});
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(norm > 0) || !std::isfinite(norm)) fail(place, "\"rotation\" is no unit quaternion");
    for (double& c : q) c /= norm;
    const auto [x, y, z, w] = q;
    return {Vec3d{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)} * s[0],
            Vec3d{2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)} * s[1],
            Vec3d{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)} * s[2],
            {t[0], t[1], t[2]}};
  }

  // Nodes with a mesh in the order of the scene, depth first, with their map to the world.
  std::vector<std::pair<size_t, Affine>> placed_meshes() const {
    const size_t count = array(root_, "nodes", "").size();
    std::vector<size_t> roots;
    const auto indices = [&](const Json& object, const char* key, const std::string& place) {
      std::vector<size_t> list;
      for (const Json& i : array(object, key, place)) {
        if (!i.is_number_unsigned() || i.get<size_t>() >= count)
          fail(place, fmt::format("\"{}\" names a node that does not exist", key));
        list.push_back(i.get<size_t>());
      }
      return list;
    };
    if (!array(root_, "scenes", "").empty()) {
      const size_t scene = size_at(root_, "scene", "scene").value_or(0);
      roots = indices(element("scenes", scene), "nodes", fmt::format("scenes[{}]", scene));
    } else {
      std::vector<bool> child(count, false);
      for (size_t n = 0; n < count; ++n)
        for (size_t c : indices(element("nodes", n), "children", fmt::format("nodes[{}]", n)))
          child[c] = true;
      for (size_t n = 0; n < count; ++n)
        if (!child[n]) roots.push_back(n);
    }
    std::vector<std::pair<size_t, Affine>> stack, found;
    for (size_t i = roots.size(); i-- > 0;) stack.emplace_back(roots[i], Affine{});
    std::vector<bool> seen(count, false);
    while (!stack.empty()) {
      const auto [n, above] = stack.back();
      stack.pop_back();
      const std::string place = fmt::format("nodes[{}]", n);
      if (seen[n]) fail(place, "has more than one parent, expected a tree");
      seen[n] = true;
      const Json& node = element("nodes", n);
      const Affine map = above * node_map(node, place);
      if (node.contains("mesh")) found.emplace_back(n, map);
      const auto children = indices(node, "children", place);
      for (size_t i = children.size(); i-- > 0;) stack.emplace_back(children[i], map);
    }
    return found;
  }

  // --- buffers ---

  std::string decode_base64(std::string_view text, const std::string& place) const {
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3);
    uint32_t bits = 0;
    int have = 0;
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    for (const char c : text) {
      const int v = c >= 'A' && c <= 'Z'   ? c - 'A'
                    : c >= 'a' && c <= 'z' ? c - 'a' + 26
                    : c >= '0' && c <= '9' ? c - '0' + 52
                    : c == '+'             ? 62
                    : c == '/'             ? 63
                                           : -1;
      if (v < 0) fail(place, "its data URI is no base64");
      bits = (bits << 6 | static_cast<uint32_t>(v)) & 0xffffff;
      if ((have += 6) >= 8) bytes.push_back(static_cast<char>(bits >> (have -= 8) & 0xff));
    }
    return bytes;
  }

  std::string beside(const std::string& uri, const std::string& place) const {
    namespace fs = std::filesystem;
    std::string decoded;
    for (size_t i = 0; i < uri.size(); ++i) {
      unsigned value = 0;
      if (uri[i] == '%' && i + 2 < uri.size() &&
          std::sscanf(uri.substr(i + 1, 2).c_str(), "%2x", &value) == 1) {
        decoded.push_back(static_cast<char>(value));
        i += 2;
      } else {
        decoded.push_back(uri[i]);
      }
    }
    std::error_code wrong;
    const fs::path home = fs::weakly_canonical(folder_.empty() ? "." : folder_, wrong);
    const fs::path file = fs::weakly_canonical(home / decoded, wrong);
    const auto inside = std::mismatch(home.begin(), home.end(), file.begin(), file.end());
    if (wrong || decoded.find('\0') != std::string::npos || inside.first != home.end())
      fail(place, "its URI leads out of the file's folder");
    return read_file(file.string());
  }

  const std::string& buffer(size_t i) {
    const Json& b = element("buffers", i);
    const std::string place = fmt::format("buffers[{}]", i);
    if (const auto known = buffers_.find(i); known != buffers_.end()) return known->second;
    const auto uri = b.find("uri");
    std::string bytes;
    if (uri == b.end()) {
      if (i != 0 || !bin_) fail(place, "has no data");
      bytes = *bin_;
    } else {
      if (!uri->is_string()) fail(place, "\"uri\" is no string");
      const std::string text = uri->get<std::string>();
      if (text.starts_with("data:")) {
        const size_t comma = text.find(";base64,");
        if (comma == std::string::npos) fail(place, "its data URI is no base64");
        bytes = decode_base64(std::string_view(text).substr(comma + 8), place);
      } else if (text.find("://") != std::string::npos) {
        fail(place, "its URI leads out of the file's folder");
      } else {
        bytes = beside(text, place);
      }
    }
    const size_t length = size_at(b, "byteLength", place).value_or(0);
    if (length > bytes.size())
      fail(place, fmt::format("says {} bytes, but {} are there", length, bytes.size()));
    bytes.resize(length);
    return buffers_.emplace(i, std::move(bytes)).first->second;
  }

  // --- accessors ---

  // Elements of an accessor: bounds are checked once, here, for all of them.
  struct Span {
    const char* data = nullptr;
    size_t count = 0, stride = 0;
    uint32_t component = 0;
    bool normalized = false;

    double at(size_t i, size_t c) const {
      const char* p = data + i * stride;
      const auto load = [p, c](auto value) {
        std::memcpy(&value, p + c * sizeof value, sizeof value);
        return static_cast<double>(value);
      };
      switch (component) {
        case 5120:
          return normalized ? std::max(load(int8_t{}) / 127, -1.0) : load(int8_t{});
        case 5121:
          return load(uint8_t{}) / (normalized ? 255 : 1);
        case 5122:
          return normalized ? std::max(load(int16_t{}) / 32767, -1.0) : load(int16_t{});
        case 5123:
          return load(uint16_t{}) / (normalized ? 65535 : 1);
        case 5125:
          return load(uint32_t{});
        default:
          return load(float{});
      }
    }
  };

  Span accessor(size_t i, const char* type, size_t components) {
    const Json& a = element("accessors", i);
    const std::string place = fmt::format("accessors[{}]", i);
    Span s;
    if (a.value("type", Json()) != type) fail(place, fmt::format("expected the type {}", type));
    if (a.contains("sparse")) fail(place, "is sparse, expected plain data");
    const auto count = size_at(a, "count", place);
    const auto view_index = size_at(a, "bufferView", place);
    if (!count || !view_index) fail(place, "has no data, expected a bufferView and a count");
    s.count = *count;
    s.component = static_cast<uint32_t>(size_at(a, "componentType", place).value_or(0));
    const auto flag = a.find("normalized");
    s.normalized = flag != a.end() && flag->is_boolean() && flag->get<bool>();
    size_t width = 0;
    switch (s.component) {
      case 5120:
      case 5121:
        width = 1;
        break;
      case 5122:
      case 5123:
        width = 2;
        break;
      case 5125:
      case 5126:
        width = 4;
        break;
      default:
        fail(place, fmt::format("unknown componentType {}", s.component));
    }
    const size_t element_size = width * components;

    const Json& v = element("bufferViews", *view_index);
    const std::string view_place = fmt::format("bufferViews[{}]", *view_index);
    const std::string& data = buffer(size_at(v, "buffer", view_place).value_or(SIZE_MAX));
    const size_t view_offset = size_at(v, "byteOffset", view_place).value_or(0);
    const size_t view_length = size_at(v, "byteLength", view_place).value_or(0);
    if (view_offset > data.size() || view_length > data.size() - view_offset)
      fail(view_place, fmt::format("reaches beyond its buffer of {} bytes", data.size()));
    s.stride = size_at(v, "byteStride", view_place).value_or(element_size);
    if (s.stride < element_size || s.stride > 252)
      fail(view_place, fmt::format("byteStride {}, expected {} to 252", s.stride, element_size));
    const size_t offset = size_at(a, "byteOffset", place).value_or(0);
    if (s.count > 0 && (offset > view_length || element_size > view_length - offset ||
                        (s.count - 1) > (view_length - offset - element_size) / s.stride))
      fail(place, fmt::format("{} elements do not fit into its bufferView of {} bytes", s.count,
                              view_length));
    s.data = data.data() + view_offset + offset;
    return s;
  }

  // --- meshes ---

  void read_asset(PortalFile& file) const {
    const auto asset = root_.find("asset");
    if (asset == root_.end() || !asset->is_object()) fail("asset", "is missing");
    const auto version = asset->find("version");
    if (version == asset->end() || !version->is_string() ||
        !version->get<std::string>().starts_with("2."))
      fail("asset", "expected glTF version 2");
    const auto extras = asset->find("extras");
    if (extras == asset->end() || !extras->is_object()) return;
    if (const auto hash = extras->find("scene_hash"); hash != extras->end() && hash->is_string())
      file.scene_hash = hash->get<std::string>();
    for (const Json& line : array(*extras, "provenance", "asset.extras"))
      if (line.is_string()) file.provenance.lines.push_back(line.get<std::string>());
  }

  void read_portal(size_t n, const Affine& map, PortalFile& file) {
    const Json& node = element("nodes", n);
    const std::string place = fmt::format("nodes[{}]", n);
    const size_t m = size_at(node, "mesh", place).value_or(0);
    const Json& mesh = element("meshes", m);
    Portal portal;
    for (const Json* named : {&node, &mesh})
      if (const auto name = named->find("name");
          portal.name.empty() && name != named->end() && name->is_string())
        portal.name = name->get<std::string>();
    if (portal.name.empty()) portal.name = fmt::format("portal.{}", file.portals.size());
    if (const auto extras = node.find("extras"); extras != node.end() && extras->is_object())
      for (const auto& [key, value] : extras->items())
        if (value.is_number()) portal.figures[key] = value.get<double>();

    size_t p = 0;
    for (const Json& primitive : array(mesh, "primitives", fmt::format("meshes[{}]", m)))
      add_primitive(primitive, fmt::format("meshes[{}].primitives[{}]", m, p++), map, portal);
    triangles_ += portal.triangles.size();
    if (portal.triangles.empty()) fail(place, "has no triangle with an area");
    file.portals.push_back(std::move(portal));
  }

  void add_primitive(const Json& primitive, const std::string& place, const Affine& map,
                     Portal& portal) {
    if (!primitive.is_object()) fail(place, "expected an object");
    const size_t mode = size_at(primitive, "mode", place).value_or(4);
    if (mode > 6) fail(place, fmt::format("unknown mode {}", mode));
    if (mode < 4) return;  // points and lines bound no area
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object() ||
        !attributes->contains("POSITION"))
      fail(place, "has no POSITION");
    const size_t position = size_at(*attributes, "POSITION", place).value_or(0);
    const Span places = accessor(position, "VEC3", 3);
    if (places.count > 3 * kMostTriangles) fail(place, "is too large for a portal");
    const size_t base = portal.vertices.size();
    for (size_t i = 0; i < places.count; ++i) {
      const Vec3d v = map({places.at(i, 0), places.at(i, 1), places.at(i, 2)});
      if (!is_finite(v))
        fail(fmt::format("accessors[{}]", position), fmt::format("vertex {} is not finite", i));
      portal.vertices.push_back(v);
    }
    std::optional<Span> indices;
    if (const auto i = size_at(primitive, "indices", place)) {
      indices = accessor(*i, "SCALAR", 1);
      if (indices->component != 5121 && indices->component != 5123 && indices->component != 5125)
        fail(fmt::format("accessors[{}]", *i), "indices are no unsigned integers");
    }
    const size_t corners = indices ? indices->count : places.count;
    const auto corner = [&](size_t i) {
      const size_t v = indices ? static_cast<size_t>(indices->at(i, 0)) : i;
      if (v >= places.count)
        fail(place, fmt::format("index {} names vertex {} of {}", i, v, places.count));
      return static_cast<uint32_t>(base + v);
    };
    const size_t triangles = mode == 4 ? corners / 3 : corners < 3 ? 0 : corners - 2;
    if (triangles > kMostTriangles - std::min(kMostTriangles, triangles_ + portal.triangles.size()))
      fail(place, fmt::format("more than {} triangles, too many for portals", kMostTriangles));
    for (size_t t = 0; t < triangles; ++t) {
      std::array<uint32_t, 3> tri;
      if (mode == 4)
        tri = {corner(3 * t), corner(3 * t + 1), corner(3 * t + 2)};
      else if (mode == 5)
        tri = {corner(t), corner(t + 1 + t % 2), corner(t + 2 - t % 2)};
      else
        tri = {corner(t + 1), corner(t + 2), corner(0)};
      if (map.mirrors()) std::swap(tri[1], tri[2]);
      const Vec3d &a = portal.vertices[tri[0]], &b = portal.vertices[tri[1]],
                  &c = portal.vertices[tri[2]];
      // Twice the area against the longest edge squared: needles thinner than rounding are no area.
      const double longest = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
      if (length(cross(b - a, c - a)) > 1e-7 * longest) portal.triangles.push_back(tri);
    }
  }

  std::string name_;
  std::filesystem::path folder_;
  Json root_;
  std::optional<std::string> bin_;
  std::map<size_t, std::string> buffers_;
  size_t triangles_ = 0;
};

}  // namespace

PortalFile read_portals(const std::string& path) {
  return Reader(path).read(read_file(path));
}

std::string portal_bytes(const PortalFile& file) {
  Json root;
  root["asset"] = {{"version", "2.0"}, {"generator", "tdpt " TDPT_VERSION}};
  Json& extras = root["asset"]["extras"];
  extras["scene_hash"] = file.scene_hash;
  if (!file.provenance.empty()) extras["provenance"] = file.provenance.lines;
  root["scene"] = 0;
  root["scenes"] = Json::array({{{"name", "portals"}}});

  std::string bin;
  const auto add_view = [&](size_t offset, int target) {
    root["bufferViews"].push_back({{"buffer", 0},
                                   {"byteOffset", offset},
                                   {"byteLength", bin.size() - offset},
                                   {"target", target}});
    return root["bufferViews"].size() - 1;
  };
  for (size_t n = 0; n < file.portals.size(); ++n) {
    const Portal& portal = file.portals[n];
    // Floats are relative to the first vertex, which the node carries in full precision: a portal
    // far from the origin stays planar.
    const Vec3d centre = portal.vertices.empty() ? Vec3d{} : portal.vertices[0];
    std::array<float, 3> low, high;
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
    const size_t first = bin.size();
    for (const Vec3d& v : portal.vertices)
      for (int c = 0; c < 3; ++c) {
        const auto f = static_cast<float>((v - centre)[c]);
        low[static_cast<size_t>(c)] = std::min(low[static_cast<size_t>(c)], f);
        high[static_cast<size_t>(c)] = std::max(high[static_cast<size_t>(c)], f);
        bin.append(reinterpret_cast<const char*>(&f), sizeof f);
      }
    const size_t position_view = add_view(first, 34962);
    const size_t second = bin.size();
    for (const auto& t : portal.triangles)
      for (const uint32_t v : t) bin.append(reinterpret_cast<const char*>(&v), sizeof v);
    const size_t index_view = add_view(second, 34963);

    const size_t accessor = 2 * n;
    root["accessors"].push_back({{"bufferView", position_view},
                                 {"componentType", 5126},
                                 {"count", portal.vertices.size()},
                                 {"type", "VEC3"},
                                 {"min", low},
                                 {"max", high}});
    root["accessors"].push_back({{"bufferView", index_view},
                                 {"componentType", 5125},
                                 {"count", 3 * portal.triangles.size()},
                                 {"type", "SCALAR"}});
    const std::string name = fmt::format("portal.{}", n);
    Json primitive = {
        {"attributes", {{"POSITION", accessor}}}, {"indices", accessor + 1}, {"material", 0}};
    root["meshes"].push_back({{"name", name}, {"primitives", Json::array({primitive})}});
    Json node = {{"name", name}, {"mesh", n}, {"translation", {centre.x, centre.y, centre.z}}};
    for (const auto& [key, value] : portal.figures)
      if (std::isfinite(value)) node["extras"][key] = value;
    root["nodes"].push_back(node);
    root["scenes"][0]["nodes"].push_back(n);
  }
  if (!file.portals.empty()) {
    root["materials"] =
        Json::array({{{"name", "portal"},
                      {"alphaMode", "BLEND"},
                      {"doubleSided", true},
                      {"pbrMetallicRoughness",
                       {{"baseColorFactor", {1.0, 0.5, 0.1, 0.4}}, {"metallicFactor", 0.0}}}}});
    root["buffers"] = Json::array({{{"byteLength", bin.size()}}});
  }

  std::string text = root.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string glb;
  const auto put = [&](uint32_t v) { glb.append(reinterpret_cast<const char*>(&v), sizeof v); };
  put(kGlbMagic);
  put(2);
  put(static_cast<uint32_t>(12 + 8 + text.size() + (bin.empty() ? 0 : 8 + bin.size())));
  put(static_cast<uint32_t>(text.size()));
  put(kJsonChunk);
  glb += text;
  if (!bin.empty()) {
    put(static_cast<uint32_t>(bin.size()));
    put(kBinChunk);
    glb += bin;
  }
  return glb;
}

}  // namespace tdpt
