#include "libcommon/draw/shapes.h"

#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "tdpt_version.h"

namespace tdpt::draw {

namespace {

using Json = nlohmann::ordered_json;
constexpr uint32_t kGlbMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinChunk = 0x004e4942;
constexpr int kFloat = 5126, kByte = 5121, kArrayBuffer = 34962;

constexpr double kStripWidth = 1.0 / 500;  // relative to the whole size

// Vertex colours are linear in glTF.
uint8_t linear(float srgb) {
  const auto c = static_cast<double>(srgb);
  return static_cast<uint8_t>(
      std::lround(255 * (c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4))));
}

class GlbWriter {
 public:
  explicit GlbWriter(const Provenance& provenance) {
    root_["asset"] = {{"version", "2.0"}, {"generator", "tdpt " TDPT_VERSION}};
    if (!provenance.empty()) root_["asset"]["extras"]["provenance"] = provenance.lines;
    root_["scene"] = 0;
    root_["scenes"] = Json::array({{{"name", "debug"}}});
  }

  void add(const Shape& mesh) {
    // Floats are relative to the centre, which is in the node's transform, so nothing is lost far
    // from the origin.
    Vec3d low(INFINITY), high(-INFINITY);
    for (const Vec3d& p : mesh.positions) low = min(low, p), high = max(high, p);
    const Vec3d middle = (low + high) * 0.5;
    const size_t positions = add_positions(mesh, middle), colours = add_colours(mesh);

    bool opaque = true;
    for (const Paint& p : mesh.paints) opaque = opaque && p.alpha >= 1;
    Json material = {{"name", mesh.name},
                     {"pbrMetallicRoughness", {{"metallicFactor", 0.0}}},
                     {"doubleSided", true},
                     {"extensions", {{"KHR_materials_unlit", Json::object()}}}};
    if (!opaque) material["alphaMode"] = "BLEND";
    static constexpr int kMode[] = {0, 1, 4};
    root_["materials"].push_back(material);
    root_["meshes"].push_back(
        {{"name", mesh.name},
         {"primitives",
          Json::array({{{"attributes", {{"POSITION", positions}, {"COLOR_0", colours}}},
                        {"material", count_},
                        {"mode", kMode[static_cast<size_t>(mesh.kind)]}}})}});
    root_["nodes"].push_back(
        {{"name", mesh.name}, {"mesh", count_}, {"translation", {middle.x, middle.y, middle.z}}});
    root_["scenes"][0]["nodes"].push_back(count_);
    ++count_;
  }

  std::string glb() {
    if (count_ > 0) {
      root_["extensionsUsed"] = {"KHR_materials_unlit"};
      root_["buffers"] = Json::array({{{"byteLength", bin_.size()}}});
    }
    std::string text = root_.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string glb;
    const auto put = [&](size_t v) {
      const auto word = static_cast<uint32_t>(v);
      glb.append(reinterpret_cast<const char*>(&word), sizeof word);
    };
    put(kGlbMagic);
    put(2);
    put(12 + 8 + text.size() + (bin_.empty() ? 0 : 8 + bin_.size()));
    put(text.size());
    put(kJsonChunk);
    glb += text;
    if (!bin_.empty()) {
      put(bin_.size());
      put(kBinChunk);
      glb += bin_;
    }
    return glb;
  }

 private:
  size_t view(size_t offset) {
    root_["bufferViews"].push_back({{"buffer", 0},
                                    {"byteOffset", offset},
                                    {"byteLength", bin_.size() - offset},
                                    {"target", kArrayBuffer}});
    return root_["bufferViews"].size() - 1;
  }

  size_t add_positions(const Shape& mesh, const Vec3d& middle) {
    const size_t offset = bin_.size();
    std::array<float, 3> low, high;
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
    for (const Vec3d& p : mesh.positions)
      for (size_t c = 0; c < 3; ++c) {
        const auto f = static_cast<float>((p - middle)[static_cast<int>(c)]);
        low[c] = std::min(low[c], f);
        high[c] = std::max(high[c], f);
        bin_.append(reinterpret_cast<const char*>(&f), sizeof f);
      }
    const size_t at = view(offset);
    root_["accessors"].push_back({{"bufferView", at},
                                  {"componentType", kFloat},
                                  {"count", mesh.positions.size()},
                                  {"type", "VEC3"},
                                  {"min", low},
                                  {"max", high}});
    return root_["accessors"].size() - 1;
  }

  size_t add_colours(const Shape& mesh) {
    const size_t offset = bin_.size();
    for (const Paint& p : mesh.paints) {
      for (int k = 0; k < 3; ++k) bin_ += static_cast<char>(linear(p.ink[k]));
      bin_ += static_cast<char>(static_cast<uint8_t>(std::lround(255 * p.alpha)));
    }
    const size_t at = view(offset);
    root_["accessors"].push_back({{"bufferView", at},
                                  {"componentType", kByte},
                                  {"normalized", true},
                                  {"count", mesh.paints.size()},
                                  {"type", "VEC4"}});
    return root_["accessors"].size() - 1;
  }

  Json root_;
  std::string bin_;
  size_t count_ = 0;
};

// Diagonal of the common bounding box.
double size_of(const std::vector<Shape>& shapes) {
  Vec3d low(INFINITY), high(-INFINITY);
  for (const Shape& shape : shapes)
    for (const Vec3d& p : shape.positions) low = min(low, p), high = max(high, p);
  return low.x <= high.x ? length(high - low) : 0;
}

// Two crossed strips per line, so that one of them is visible from any side.
Shape strips_of(const Shape& lines, double width) {
  Shape strips{.name = lines.name};
  for (size_t i = 0; i + 1 < lines.positions.size(); i += 2) {
    const Vec3d &a = lines.positions[i], &b = lines.positions[i + 1];
    if (!(length(b - a) > 0)) continue;
    const Onb<double> frame(normalize(b - a));
    for (const Vec3d& across : {frame.x * (0.5 * width), frame.y * (0.5 * width)}) {
      for (const auto& [p, end] : {std::pair(a - across, i),
                                   {b - across, i + 1},
                                   {b + across, i + 1},
                                   {a - across, i},
                                   {b + across, i + 1},
                                   {a + across, i}})
        strips.point(p, lines.paints[end]);
    }
  }
  return strips;
}

}  // namespace

void Shape::point(const Vec3d& at, const Paint& c) {
  positions.push_back(at);
  paints.push_back(c);
}

void Shape::line(const Vec3d& a, const Vec3d& b, const Paint& at_a, const Paint& at_b) {
  point(a, at_a);
  point(b, at_b);
}

void Shape::arrow(const Vec3d& from, const Vec3d& way, const Vec3d& x, const Vec3d& y,
                  const Paint& p) {
  const Vec3d tip = from + way;
  const double head = 0.12 * length(way);
  line(from, tip, p);
  for (const Vec3d& side : {x, -x, y, -y}) line(tip, tip - way * 0.25 + side * head, p);
}

void Shape::triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Paint& colour) {
  for (const Vec3d& p : {a, b, c}) point(p, colour);
}

void Shape::square(const Vec3d& centre, const Vec3d& normal, double side, const Paint& c) {
  const Onb<double> frame(normal);
  const Vec3d x = frame.x * (0.5 * side), y = frame.y * (0.5 * side);
  triangle(centre - x - y, centre + x - y, centre + x + y, c);
  triangle(centre - x - y, centre + x + y, centre - x + y, c);
}

void Shape::cube(const Vec3d& centre, double side, const Paint& c) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      Vec3d n{};
      n[axis] = sign;
      square(centre + n * (0.5 * side), n, side, c);
    }
}

std::string debug_glb_bytes(const std::vector<Shape>& shapes, const Provenance& provenance,
                            DebugLines lines) {
  GlbWriter writer(provenance);
  const double width = lines == DebugLines::strips ? kStripWidth * size_of(shapes) : 0;
  for (const Shape& shape : shapes)
    if (!shape.positions.empty())
      writer.add(width > 0 && shape.kind == Shape::Kind::lines ? strips_of(shape, width) : shape);
  return writer.glb();
}

void declare_debug_lines(cli::Options& options, std::string& value) {
  options.choice("--set debug-lines", value, {"edges", "strips"},
                 "Lines in --debug-glb: edges, the default, or thin strips, which renderers show",
                 cli::Effect::report);
}

DebugLines debug_lines(const std::string& value) {
  return value == "strips" ? DebugLines::strips : DebugLines::edges;
}

}  // namespace tdpt::draw
