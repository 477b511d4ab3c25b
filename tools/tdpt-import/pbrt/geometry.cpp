// By pbrt-v3's shapes/*.cpp and pbrt-v4's shapes.h and shapes.cpp.
//
// The normal of a triangle is that of its corners in the world, counter-clockwise, turned if the
// transformation mirrors: the side that its corners give in the object's space. If it has normals,
// it is turned to their side. A bilinear patch p00 p10 p01 p11 has du x dv. A sphere and a cylinder
// have the outside, a disk +z. (Where the transformation mirrors, pbrt intersects a quadric with
// the normal turned, but samples its light without; the latter is taken.)
#include "tools/tdpt-import/pbrt/geometry.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/meshes/meshes.h"
#include "tools/tdpt-import/pbrt/context.h"
#include "tools/tdpt-import/pbrt/parameters.h"

namespace tdpt::foreign::pbrt {
namespace {

Vec3f vec_at(const std::vector<double>& numbers, size_t i) {
  return {static_cast<float>(numbers[3 * i]), static_cast<float>(numbers[3 * i + 1]),
          static_cast<float>(numbers[3 * i + 2])};
}

void face_the_normals(Mesh& mesh) {
  if (mesh.normals.empty()) return;
  for (auto& t : mesh.triangles) {
    const Vec3f a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    const Vec3f n = mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]];
    if (dot(cross(b - a, c - a), n) < 0) std::swap(t[1], t[2]);
  }
}

// pbrt takes the triangle's normal where a vertex has one of length zero.
void mend_normals(Mesh& mesh) {
  const auto is_broken = [](const Vec3f& n) { return !(dot(n, n) > 0) || !tdpt::is_finite(n); };
  if (std::none_of(mesh.normals.begin(), mesh.normals.end(), is_broken)) return;
  std::vector<Vec3f> mean(mesh.normals.size());
  for (const auto& t : mesh.triangles) {
    const Vec3f a = mesh.positions[t[0]];
    const Vec3f n = cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
    for (const uint32_t i : t) mean[i] = mean[i] + n;
  }
  for (size_t i = 0; i < mean.size(); ++i)
    if (is_broken(mesh.normals[i]))
      mesh.normals[i] = is_broken(mean[i]) ? Vec3f(0, 0, 1) : normalize(mean[i]);
}

struct Lists {
  const std::vector<double>*points, *normals, *uv, *indices;
};

// Common to meshes of triangles and of patches. `corners` of a face.
Lists read_lists(Context& context, const Parameters& list, size_t corners) {
  Lists l{list.tuples("P", 3), list.tuples("N", 3), list.tuples("uv", 2), list.integers("indices")};
  if (!l.uv) l.uv = list.tuples("st", 2);
  list.ignore({"S", "faceIndices"});  // tangents; for Ptex
  if (!l.points || l.points->empty()) Source::fail(list.place, "a mesh without points \"P\"");
  const size_t count = l.points->size() / 3;
  if (!l.indices && count != corners) Source::fail(list.place, "a mesh without \"indices\"");
  if (l.normals && l.normals->size() != l.points->size()) {
    context.source.lose(list.place,
                        "normals of a mesh that has another number of points are left out");
    l.normals = nullptr;
  }
  if (l.uv && l.uv->size() / 2 < count) {
    context.source.lose(list.place,
                        "texture coordinates of a mesh that has more points are left out");
    l.uv = nullptr;
  }
  if (l.indices)
    for (const double i : *l.indices)
      if (!(i >= 0 && i < static_cast<double>(count)))
        Source::fail(list.place, fmt::format("index {} of a mesh of {} points", i, count));
  return l;
}

Mesh mesh_of(const Lists& l, const Place& place) {
  Mesh mesh;
  const size_t count = l.points->size() / 3;
  for (size_t i = 0; i < count; ++i) {
    mesh.positions.push_back(vec_at(*l.points, i));
    if (!tdpt::is_finite(mesh.positions.back()))
      Source::fail(place, fmt::format("point {} of the mesh is too far away", i));
  }
  for (size_t i = 0; l.normals && i < count; ++i) mesh.normals.push_back(vec_at(*l.normals, i));
  for (size_t i = 0; l.uv && i < count; ++i)
    mesh.uv.push_back({static_cast<float>((*l.uv)[2 * i]), static_cast<float>((*l.uv)[2 * i + 1])});
  flip_v(mesh);
  return mesh;
}

size_t add(Context& context, Mesh&& mesh) {
  context.scene.meshes.push_back(std::move(mesh));
  return context.scene.meshes.size() - 1;
}

Geometry triangles(Context& context, const Parameters& list, const std::string& name) {
  const Lists l = read_lists(context, list, 3);
  Mesh mesh = mesh_of(l, list.place);
  const std::vector<double> first{0, 1, 2};
  const std::vector<double>& indices = l.indices ? *l.indices : first;
  for (size_t i = 0; i + 2 < indices.size(); i += 3)
    mesh.triangles.push_back({static_cast<uint32_t>(indices[i]),
                              static_cast<uint32_t>(indices[i + 1]),
                              static_cast<uint32_t>(indices[i + 2])});
  mend_normals(mesh);
  face_the_normals(mesh);
  Geometry g;
  g.name = name;
  g.faces = mesh.triangles.size();
  g.mesh = add(context, std::move(mesh));
  return g;
}

Geometry patches(Context& context, const Parameters& list) {
  const Lists l = read_lists(context, list, 4);
  list.ignore({"emissionfilename"});  // how it is sampled
  Mesh mesh = mesh_of(l, list.place);
  if (!l.uv) {  // each patch has (u, v) of its own
    const Mesh shared = std::move(mesh);
    mesh = {};
    const std::vector<double> first{0, 1, 2, 3};
    const std::vector<double>& indices = l.indices ? *l.indices : first;
    for (size_t i = 0; i + 3 < indices.size(); i += 4)
      for (size_t k = 0; k < 4; ++k) {
        const auto at = static_cast<size_t>(indices[i + k]);
        mesh.positions.push_back(shared.positions[at]);
        if (!shared.normals.empty()) mesh.normals.push_back(shared.normals[at]);
        mesh.uv.push_back({k % 2 ? 1.0f : 0.0f, k < 2 ? 1.0f : 0.0f});
      }
  }
  const size_t count = l.indices ? l.indices->size() / 4 : 1;
  for (size_t i = 0; i < count; ++i) {
    std::array<uint32_t, 4> p;
    for (size_t k = 0; k < 4; ++k)
      p[k] = !l.uv || !l.indices ? static_cast<uint32_t>(4 * i + k)
                                 : static_cast<uint32_t>((*l.indices)[4 * i + k]);
    mesh.triangles.push_back({p[0], p[1], p[3]});
    mesh.triangles.push_back({p[0], p[3], p[2]});
  }
  mend_normals(mesh);
  face_the_normals(mesh);
  Geometry g;
  g.name = "bilinearmesh";
  g.faces = count;
  g.mesh = add(context, std::move(mesh));
  return g;
}

Geometry subdivided(Context& context, const Parameters& list) {
  context.source.lose(list.place,
                      "the subdivision of \"loopsubdiv\" is left out: its control mesh is kept");
  list.ignore({"levels", "nlevels", "scheme"});
  Geometry g = triangles(context, list, "loopsubdiv");
  smooth(context.scene.meshes[g.mesh]);
  return g;
}

std::string stem_of(const std::string& file) {
  const size_t slash = file.find_last_of("/\\");
  const std::string name = slash == std::string::npos ? file : file.substr(slash + 1);
  return name.substr(0, name.find('.'));
}

double positive(const Parameters& list, const std::string& name, double absent) {
  const double value = list.number(name, absent);
  if (!(value > 0)) Source::fail(list.place, fmt::format("\"{}\" is not above 0", name));
  return value;
}

void lose_parts(Context& context, const Parameters& list, const std::string& kind, bool is_part) {
  if (list.number("phimax", 360) < 360 || is_part)
    context.source.lose(list.place,
                        fmt::format("a \"{}\" of which parts are cut away becomes whole", kind));
}

}  // namespace

double area_of(const Mesh& mesh, const Affine& map) {
  double sum = 0;
  const auto corner = [&](uint32_t i) {
    const Vec3f& p = mesh.positions[i];
    return map.point({p.x, p.y, p.z});
  };
  for (const auto& t : mesh.triangles) {
    const Vec3d a = corner(t[0]);
    sum += length(cross(corner(t[1]) - a, corner(t[2]) - a)) / 2;
  }
  return sum;
}

std::optional<Geometry> Geometries::read(Context& context, const std::string& kind,
                                         const Parameters& list) {
  const auto shared = [&](const std::string& key, auto&& make) {
    const auto it = known_.find(key);
    if (it != known_.end()) return it->second;
    const size_t index = add(context, make());
    known_[key] = index;
    return index;
  };
  Geometry g;
  g.name = kind;
  if (kind == "trianglemesh") return triangles(context, list, kind);
  if (kind == "bilinearmesh") return patches(context, list);
  if (kind == "loopsubdiv") return subdivided(context, list);
  if (kind == "plymesh") {
    const std::string file = list.text("filename");
    if (file.empty()) Source::fail(list.place, "the mesh names no file");
    g.name = stem_of(file);
    g.mesh = shared(file, [&] {
      const auto found = context.source.read_mesh(file, list.place);
      if (!found) return Mesh{};
      std::string bytes = *found;
      const std::string shown_name = context.source.shown_name(file);
      if (is_gzip(bytes)) bytes = inflated(bytes, shown_name);
      Mesh mesh = read_ply(bytes, shown_name);
      flip_v(mesh);
      mend_normals(mesh);
      face_the_normals(mesh);
      return mesh;
    });
    g.faces = context.scene.meshes[g.mesh].triangles.size();
    if (!list.texture("displacement").empty())
      context.source.lose(list.place, "the displacement of meshes is left out");
    list.ignore({"edgelength"});  // of the displacement
    return g;
  }
  g.is_mesh = false;
  if (kind == "sphere") {
    const double r = positive(list, "radius", 1);
    lose_parts(context, list, kind, list.number("zmin", -r) > -r || list.number("zmax", r) < r);
    g.mesh = shared("[sphere]", [] { return sphere(); });
    g.to_object = scaled_by(Vec3d(r));
  } else if (kind == "disk") {
    const double r = positive(list, "radius", 1);
    lose_parts(context, list, kind, list.number("innerradius", 0) > 0);
    g.mesh = shared("[disk]", [] { return disc(); });
    g.to_object = translated({0, 0, list.number("height", 0)}) * scaled_by(Vec3d(r));
  } else if (kind == "cylinder") {
    const double r = positive(list, "radius", 1);
    const double a = list.number("zmin", -1), b = list.number("zmax", 1);
    const double low = std::min(a, b), high = std::max(a, b);
    if (!(high > low)) Source::fail(list.place, "a cylinder without height");
    lose_parts(context, list, kind, false);
    g.mesh = shared("[cylinder]", [] { return cylinder(); });
    g.to_object = translated({0, 0, low}) * scaled_by({r, r, high - low});
  } else {
    context.source.lose(
        list.place,
        fmt::format("shapes of the kind \"{}\" are not read and left out", shown(kind)));
    list.ignore_all();
    return {};
  }
  return g;
}

}  // namespace tdpt::foreign::pbrt
