// glTF 2.0 scenes into the canonical frame.
#include <tiny_gltf.h>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/hash.h"
#include "libcommon/scene/scene.h"

namespace tdpt {
namespace {

struct Mat {
  double m[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};  // column-major
};
Mat operator*(const Mat& a, const Mat& b) {
  Mat c;
  for (int col = 0; col < 4; ++col)
    for (int row = 0; row < 4; ++row) {
      double sum = 0;
      for (int k = 0; k < 4; ++k) sum += a.m[4 * k + row] * b.m[4 * col + k];
      c.m[4 * col + row] = sum;
    }
  return c;
}
Vec3d column(const Mat& a, int c) {
  return {a.m[4 * c], a.m[4 * c + 1], a.m[4 * c + 2]};
}

Mat local_matrix(const tinygltf::Node& n) {
  Mat a;
  if (n.matrix.size() == 16) {
    std::copy(n.matrix.begin(), n.matrix.end(), a.m);
    return a;
  }
  double x = 0, y = 0, z = 0, w = 1;
  if (n.rotation.size() == 4)
    x = n.rotation[0], y = n.rotation[1], z = n.rotation[2], w = n.rotation[3];
  const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w),     2 * (x * z - y * w),
                       2 * (x * y - z * w),     1 - 2 * (x * x + z * z), 2 * (y * z + x * w),
                       2 * (x * z + y * w),     2 * (y * z - x * w),     1 - 2 * (x * x + y * y)};
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 3; ++i)
      a.m[4 * c + i] = r[3 * c + i] * (n.scale.size() == 3 ? n.scale[c] : 1);
  if (n.translation.size() == 3)
    for (int i = 0; i < 3; ++i) a.m[12 + i] = n.translation[i];
  return a;
}

bool no_image(tinygltf::Image*, const int, std::string*, std::string*, int, int,
              const unsigned char*, int, void*) {
  return true;
}

struct View {
  const unsigned char* data;
  size_t stride, count;
  int type;
};

}  // namespace

Scene read_gltf(const std::string& path) {
  const std::string bytes = read_file(path), file = display_name(path);
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(no_image, nullptr);
  tinygltf::Model model;
  std::string err, warn;
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const auto size = static_cast<unsigned>(bytes.size());
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const bool ok = bytes.substr(0, 4) == "glTF"
                      ? loader.LoadBinaryFromMemory(&model, &err, &warn, data, size, folder)
                      : loader.LoadASCIIFromString(&model, &err, &warn, bytes.data(), size, folder);
  if (!ok) throw InputError(file, "", err.substr(0, err.find('\n')));

  Scene scene;
  scene.path = path;
  scene.hash = content_hash(bytes);
  for (const auto& m : model.materials) {
    Material out;
    out.name = m.name;
    const auto& c = m.pbrMetallicRoughness.baseColorFactor;
    for (int i = 0; i < 3 && i < static_cast<int>(c.size()); ++i)
      out.albedo[i] = static_cast<float>(c[i]);
    double strength = 1;
    if (auto it = m.extensions.find("KHR_materials_emissive_strength"); it != m.extensions.end())
      strength = it->second.Get("emissiveStrength").GetNumberAsDouble();
    for (int i = 0; i < 3 && i < static_cast<int>(m.emissiveFactor.size()); ++i)
      out.emission[i] = static_cast<float>(m.emissiveFactor[i] * strength);
    out.double_sided = m.doubleSided;
    scene.materials.push_back(out);
  }
  const auto none = static_cast<uint32_t>(scene.materials.size());
  scene.materials.push_back({"default", Rgb(1), {}, false});

  const auto view_of = [&](int index) {
    const auto& a = model.accessors.at(index);
    const auto& v = model.bufferViews.at(a.bufferView);
    const auto& b = model.buffers.at(v.buffer);
    const size_t stride = a.ByteStride(v), start = v.byteOffset + a.byteOffset;
    if (start + (a.count - 1) * stride > b.data.size())
      throw InputError(file, "accessors[" + std::to_string(index) + "]", "lies outside its buffer");
    return View{b.data.data() + start, stride, a.count, a.componentType};
  };

  std::vector<Vec3d> world;
  const auto add_node = [&](auto&& self, int index, const Mat& parent) -> void {
    const auto& node = model.nodes.at(index);
    const Mat m = parent * local_matrix(node);
    const Vec3d x = column(m, 0), y = column(m, 1), z = column(m, 2), t = column(m, 3);
    const bool mirrored = dot(cross(x, y), z) < 0;
    if (node.mesh >= 0)
      for (const auto& p : model.meshes.at(node.mesh).primitives) {
        const View pos = view_of(p.attributes.at("POSITION"));
        const auto base = static_cast<uint32_t>(world.size());
        for (size_t i = 0; i < pos.count; ++i) {
          float v[3];
          std::memcpy(v, pos.data + i * pos.stride, 12);
          world.push_back(x * double(v[0]) + y * double(v[1]) + z * double(v[2]) + t);
        }
        std::vector<uint32_t> indices;
        if (p.indices >= 0) {
          const View iv = view_of(p.indices);
          for (size_t i = 0; i < iv.count; ++i) {
            uint32_t k = 0;
            std::memcpy(&k, iv.data + i * iv.stride, tinygltf::GetComponentSizeInBytes(iv.type));
            if (k >= pos.count) throw InputError(file, "meshes", "index out of range");
            indices.push_back(k);
          }
        } else {
          for (uint32_t i = 0; i < pos.count; ++i) indices.push_back(i);
        }
        for (size_t i = 0; i + 2 < indices.size(); i += 3) {
          Triangle tri{{base + indices[i], base + indices[i + 1], base + indices[i + 2]},
                       p.material >= 0 ? static_cast<uint32_t>(p.material) : none};
          if (mirrored) std::swap(tri.vertex[1], tri.vertex[2]);
          scene.triangles.push_back(tri);
        }
      }
    if (node.camera >= 0 && model.cameras.at(node.camera).type == "perspective") {
      const auto& c = model.cameras[node.camera];
      Camera out;
      out.name = c.name.empty() ? node.name : c.name;
      out.position = t;
      out.forward = normalize(-z);
      out.right = normalize(cross(out.forward, y));
      out.up = cross(out.right, out.forward);
      out.yfov = c.perspective.yfov;
      out.aspect = c.perspective.aspectRatio;
      scene.cameras.push_back(out);
    }
    for (int child : node.children) self(self, child, m);
  };
  for (int root : model.scenes.at(std::max(0, model.defaultScene)).nodes)
    add_node(add_node, root, Mat{});
  if (scene.triangles.empty()) throw InputError(file, "", "has no triangles");

  Vec3d lo(INFINITY), hi(-INFINITY);
  for (const Triangle& t : scene.triangles)
    for (uint32_t v : t.vertex) lo = min(lo, world[v]), hi = max(hi, world[v]);
  scene.frame.centre = (lo + hi) * 0.5;
  scene.frame.scale = std::exp2(1 - std::ceil(std::log2(max_component(hi - lo))));
  for (const Vec3d& p : world) scene.positions.push_back(Vec3f(scene.frame.to_canonical(p)));
  std::erase_if(scene.triangles, [&](const Triangle& t) {
    const Vec3d a(scene.positions[t.vertex[0]]), b(scene.positions[t.vertex[1]]),
        c(scene.positions[t.vertex[2]]);
    return !(length(cross(b - a, c - a)) > 0);
  });
  for (Camera& c : scene.cameras) c.position = scene.frame.to_canonical(c.position);
  return scene;
}

}  // namespace tdpt
