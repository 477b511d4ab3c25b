// split_scene IN.glb OUT.glb: subdivides each triangle of a scene into four, for benchmarks: the
// midpoints of all edges become vertices, which neighbours share, so the surface stays the same.
// Attributes are averaged as numbers. Knows indexed triangle lists with float attributes.
#include <cstdio>
#include <cstring>
#include <exception>
#include <map>
#include <stdexcept>

#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/testing/files/glb_builder.h"

namespace tdpt::testing {
namespace {

using Json = nlohmann::ordered_json;

void expect(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

/// The numbers of an accessor, of type `T` in the file.
template <class T, class Out>
std::vector<Out> numbers_of(const GlbBuilder& b, const Json& index, size_t components) {
  const Json& accessor = b.json["accessors"][index.get<size_t>()];
  expect(accessor.contains("bufferView") && !accessor.contains("sparse"), "a sparse accessor");
  const Json& view = b.json["bufferViews"][accessor["bufferView"].get<size_t>()];
  const size_t at = view.value("byteOffset", size_t{0}) + accessor.value("byteOffset", size_t{0}),
               size = components * sizeof(T), stride = view.value("byteStride", size),
               count = accessor["count"];
  expect(count > 0 && at + (count - 1) * stride + size <= b.bin.size(), "a short buffer");
  std::vector<Out> out;
  for (size_t i = 0; i < count * components; ++i) {
    T value;
    std::memcpy(&value, &b.bin[at + i / components * stride + i % components * sizeof(T)],
                sizeof(T));
    out.push_back(value);
  }
  return out;
}

std::vector<uint32_t> corners_of(const GlbBuilder& b, const Json& index) {
  const int type = b.json["accessors"][index.get<size_t>()]["componentType"];
  expect(type == 5121 || type == 5123 || type == 5125, "indices of another type");
  return type == 5121   ? numbers_of<uint8_t, uint32_t>(b, index, 1)
         : type == 5123 ? numbers_of<uint16_t, uint32_t>(b, index, 1)
                        : numbers_of<uint32_t, uint32_t>(b, index, 1);
}

void split(GlbBuilder& b, Json& primitive) {
  expect(primitive.value("mode", 4) == 4 && primitive.contains("indices"), "no indexed triangles");
  expect(!primitive.contains("targets"), "morph targets");
  const uint32_t vertices =
      b.json["accessors"][primitive["attributes"]["POSITION"].get<size_t>()]["count"];
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> known;
  std::vector<std::pair<uint32_t, uint32_t>> edges;
  const auto middle = [&](uint32_t p, uint32_t q) {
    const auto [entry, is_new] =
        known.try_emplace(std::minmax(p, q), static_cast<uint32_t>(vertices + edges.size()));
    if (is_new) edges.emplace_back(p, q);
    return entry->second;
  };
  const std::vector<uint32_t> corner = corners_of(b, primitive["indices"]);
  std::vector<uint32_t> fine;
  for (size_t i = 0; i + 2 < corner.size(); i += 3) {
    const uint32_t p = corner[i], q = corner[i + 1], r = corner[i + 2];
    expect(std::max({p, q, r}) < vertices, "an index beyond the vertices");
    const uint32_t pq = middle(p, q), qr = middle(q, r), rp = middle(r, p);
    fine.insert(fine.end(), {p, pq, rp, pq, q, qr, rp, qr, r, pq, qr, rp});
  }
  for (auto& [name, index] : primitive["attributes"].items()) {
    const Json& accessor = b.json["accessors"][index.get<size_t>()];
    const std::string type = accessor["type"];
    expect(accessor["componentType"] == 5126 && type.starts_with("VEC"), "no float vectors");
    const auto n = static_cast<size_t>(type.back() - '0');
    std::vector<float> values = numbers_of<float, float>(b, index, n);
    for (const auto& [p, q] : edges)
      for (size_t k = 0; k < n; ++k)
        values.push_back(0.5f * (values[p * n + k] + values[q * n + k]));
    index = b.floats(values, static_cast<int>(n));
  }
  primitive["indices"] = b.indices_u32(fine);
}

}  // namespace
}  // namespace tdpt::testing

int main(int argc, char** argv) {
  using namespace tdpt;
  if (argc != 3) {
    std::fprintf(stderr, "usage: split_scene IN.glb OUT.glb\n");
    return 2;
  }
  try {
    testing::GlbBuilder b = testing::GlbBuilder::of(read_file(argv[1]));
    for (auto& mesh : b.json["meshes"])
      for (auto& primitive : mesh["primitives"]) testing::split(b, primitive);
    write_output(argv[2], b.glb());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "split_scene: %s\n", e.what());
    return 4;
  }
  return 0;
}
