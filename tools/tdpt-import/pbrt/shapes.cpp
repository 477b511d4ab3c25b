// Shapes as meshes with their material, alpha, medium and light, by pbrt-v3's shapes/*.cpp and
// pbrt-v4's shapes.h and shapes.cpp.
//
// The normal of a triangle is that of its corners in the world, counter-clockwise, turned if the
// transformation mirrors: the side that its corners give in the object's space. If it has normals,
// it is turned to their side. A bilinear patch p00 p10 p01 p11 has du x dv. A sphere and a cylinder
// have the outside, a disk +z. (Where the transformation mirrors, pbrt intersects a quadric with
// the normal turned, but samples its light without; the latter is taken.)
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/meshes/meshes.h"
#include "tools/tdpt-import/pbrt/pbrt.h"

namespace tdpt::foreign::pbrt {
namespace {

/// A mesh of the scene whose front is the side of pbrt's normal without ReverseOrientation.
struct Geometry {
  size_t mesh = 0;
  Affine to_object{};
  std::string name;
  bool is_mesh = true;  ///< areas are measured in the world, else in the object's space
  size_t faces = 1;     ///< pbrt's own shapes that it consists of
};

// pbrt turns triangles to the side of their normals.
void turn_to_normals(Mesh& mesh) {
  if (mesh.normals.empty()) return;
  for (auto& t : mesh.triangles) {
    const Vec3f n = mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]];
    if (dot(front_of(mesh, t), in_double(n)) < 0) std::swap(t[1], t[2]);
  }
}

// Index of a mesh that several shapes may show.
template <class Make>
size_t shared(Context& context, const std::string& key, const Make& make) {
  const auto [it, is_new] = context.meshes.try_emplace(key, context.scene.meshes.size());
  if (is_new) context.scene.meshes.push_back(make());
  return it->second;
}

// What meshes of triangles and of patches share: vertices, and indices of faces of so many corners.
struct Faces {
  Mesh mesh;
  std::vector<uint32_t> corners;
};

Faces faces_of(const Entity& e, size_t corners) {
  const std::initializer_list<const char*> kVectors{"point",   "point3", "vector",
                                                    "vector3", "normal", "normal3"};
  // pbrt-v3 also takes plain numbers for texture coordinates.
  const std::initializer_list<const char*> kPairs{"point2", "vector2", "float"};
  const std::vector<double>*points = e.list("P", kVectors, 3), *normals = e.list("N", kVectors, 3),
        *uv = e.list("uv", kPairs, 2);
  const std::vector<double>* indices = e.list("indices", {"integer"});
  if (!uv) uv = e.list("st", kPairs, 2);
  e.ignore({"S", "faceIndices"});  // tangents; for Ptex
  if (!points || points->empty()) e.fail("a mesh without points \"P\"");
  const size_t count = points->size() / 3;
  if (!indices && count != corners) e.fail("a mesh without \"indices\"");
  if ((normals && normals->size() != points->size()) || (uv && uv->size() / 2 < count))
    e.fail("normals or texture coordinates of another number of points");
  Faces f;
  for (size_t i = 0; i < (indices ? indices->size() / corners * corners : corners); ++i) {
    const double corner = indices ? (*indices)[i] : static_cast<double>(i);
    if (!(corner >= 0 && corner < static_cast<double>(count)))
      e.fail("index {} of a mesh of {} points", corner, count);
    f.corners.push_back(static_cast<uint32_t>(corner));
  }
  for (size_t i = 0; i < count; ++i) {
    f.mesh.positions.push_back(vec_at(*points, i));
    if (!tdpt::is_finite(f.mesh.positions.back()))
      e.fail("point {} of the mesh is too far away", i);
    if (normals) f.mesh.normals.push_back(vec_at(*normals, i));
    if (uv)
      f.mesh.uv.push_back({static_cast<float>((*uv)[2 * i]), static_cast<float>((*uv)[2 * i + 1])});
  }
  flip_v(f.mesh);
  return f;
}

Geometry added(const Entity& e, Mesh&& mesh, size_t faces) {
  turn_to_normals(mesh);
  e.context.scene.meshes.push_back(std::move(mesh));
  return {e.context.scene.meshes.size() - 1, {}, e.kind, true, faces};
}

Geometry triangles(const Entity& e) {
  auto [mesh, c] = faces_of(e, 3);
  for (size_t i = 0; i < c.size(); i += 3) mesh.triangles.push_back({c[i], c[i + 1], c[i + 2]});
  return added(e, std::move(mesh), c.size() / 3);
}

Geometry patches(const Entity& e) {
  auto [mesh, c] = faces_of(e, 4);
  if (mesh.uv.empty()) {  // each patch has (u, v) of its own
    const Mesh shared = std::exchange(mesh, {});
    for (uint32_t i = 0; i < c.size(); ++i) {
      mesh.positions.push_back(shared.positions[c[i]]);
      if (!shared.normals.empty()) mesh.normals.push_back(shared.normals[c[i]]);
      mesh.uv.push_back({i % 2 ? 1.0f : 0.0f, i % 4 < 2 ? 1.0f : 0.0f});
      c[i] = i;
    }
  }
  for (size_t i = 0; i < c.size(); i += 4) {
    mesh.triangles.push_back({c[i], c[i + 1], c[i + 3]});
    mesh.triangles.push_back({c[i], c[i + 3], c[i + 2]});
  }
  return added(e, std::move(mesh), c.size() / 4);
}

Geometry subdivided(const Entity& e) {
  e.lose("the subdivision of \"loopsubdiv\" is left out: its control mesh is kept");
  e.ignore({"levels", "nlevels", "scheme"});
  Geometry g = triangles(e);
  smooth(e.context.scene.meshes[g.mesh]);
  return g;
}

Geometry mesh_of_file(const Entity& e) {
  const std::string file = e.text("filename");
  if (file.empty()) e.fail("the mesh names no file");
  const size_t mesh = shared(e.context, file, [&] {
    Source& source = e.context.source;
    const auto bytes = source.read_mesh(file, e.place);
    if (!bytes) return Mesh{};
    const std::string shown_name = source.shown_name(file);
    Mesh read = read_ply(unpacked(*bytes, shown_name), shown_name);
    flip_v(read);
    turn_to_normals(read);
    return read;
  });
  const std::string name = file.substr(file.find_last_of("/\\") + 1);
  return {mesh,
          {},
          name.substr(0, name.find('.')),
          true,
          e.context.scene.meshes[mesh].triangles.size()};
}

// Spheres, disks and cylinders; none for other kinds.
std::optional<Geometry> quadric(const Entity& e) {
  const double r = e.number("radius", 1);
  if (!(r > 0)) e.fail("\"radius\" is not above 0");
  Mesh (*make)() = nullptr;
  Geometry g{0, {{r, 0, 0}, {0, r, 0}, {0, 0, r}, {}}, e.kind, false};
  bool is_part = e.number("phimax", 360) < 360;
  if (e.kind == "sphere") {
    make = sphere;
    is_part |= e.number("zmin", -r) > -r || e.number("zmax", r) < r;
  } else if (e.kind == "disk") {
    make = disc;
    is_part |= e.number("innerradius", 0) > 0;
    g.to_object.t.z = e.number("height", 0);
  } else if (e.kind == "cylinder") {
    make = cylinder;
    const auto [low, high] = std::minmax({e.number("zmin", -1), e.number("zmax", 1)});
    if (!(high > low)) e.fail("a cylinder without height");
    g.to_object.z.z = high - low;
    g.to_object.t.z = low;
  } else {
    e.lose("shapes of the kind \"{}\" are not read and left out", shown(e.kind));
    return {};
  }
  if (is_part) e.lose("a \"{}\" of which parts are cut away becomes whole", e.kind);
  g.mesh = shared(e.context, "[" + e.kind + "]", make);
  return g;
}

std::optional<Geometry> geometry_of(const Entity& e) {
  if (e.kind == "trianglemesh") return triangles(e);
  if (e.kind == "bilinearmesh") return patches(e);
  if (e.kind == "loopsubdiv") return subdivided(e);
  if (e.kind == "plymesh") return mesh_of_file(e);
  return quadric(e);
}

// pbrt-v4 gives every triangle of a mesh the whole power.
std::optional<Emission> emission_of(const Entity& e, const AreaLight& light,
                                    const Geometry& geometry, const Affine& to_world) {
  Emission emission = light.emission;
  if (light.power > 0) {
    const double area = area_of(e.context.scene.meshes[geometry.mesh],
                                geometry.is_mesh ? to_world : geometry.to_object);
    if (geometry.faces > 2)
      e.lose("an area light's power, the same of every face, is spread evenly over its mesh");
    const double factor = light.power * static_cast<double>(geometry.faces) /
                          (std::numbers::pi * area * (emission.both_sides ? 2 : 1));
    if (!std::isfinite(factor)) return {};
    emission.radiance.factor = emission.radiance.factor * static_cast<float>(factor);
  }
  if (max_component(emission.radiance.factor) <= 0) return {};
  return emission;
}

// Index into the scene's materials of the present surface with the alpha of the shape and the
// medium inside.
size_t material_of(const Entity& e, const State& state) {
  Context& context = e.context;
  const auto alpha = e.varying("alpha");
  Material m = context.surfaces[state.surface].material;
  std::optional<Rgb> attenuation;
  if (!state.inside.empty() && m.solid) attenuation = context.absorbing[state.inside];
  // Behind an opaque surface a medium is never seen.
  const bool is_open = m.transmission > 0 || m.invisible || m.opacity.factor < 1 || alpha;
  if (!state.inside.empty() && !attenuation && is_open)
    e.lose("media other than absorbing ones within glass are left out");
  if (!state.outside.empty()) e.lose("media in front of a surface are left out");

  const std::string key = fmt::format("{} {} {}", state.surface, attenuation ? state.inside : "",
                                      !alpha           ? ""
                                      : alpha->texture ? e.texture("alpha")
                                                       : fmt::format("{}", alpha->factor));
  const auto [it, is_new] = context.materials.try_emplace(key, context.scene.materials.size());
  if (!is_new) return it->second;
  if (attenuation) m.attenuation = *attenuation;
  if (alpha) {
    const Number open = context.v4 ? *alpha : through(*alpha, [](float v) {
      return v > 0 ? 1.0f : 0.0f;  // only zero is transparent
    });
    if (open.texture && m.opacity.texture) e.lose("of two opacities the shape's is kept");
    const float under = open.texture && m.opacity.texture ? 1 : m.opacity.factor;
    if (open.texture) m.opacity = open;
    m.opacity.factor = under * (open.texture ? open.factor : std::clamp(open.factor, 0.0f, 1.0f));
  }
  context.scene.materials.push_back(std::move(m));
  return it->second;
}

}  // namespace

std::optional<Shape> shape_of(const Entity& e, const State& state, bool in_object) {
  const std::optional<Geometry> geometry = geometry_of(e);
  if (!geometry || e.context.scene.meshes[geometry->mesh].triangles.empty()) {
    e.ignore();
    return {};
  }
  Shape shape;
  shape.name = geometry->name;
  shape.mesh = geometry->mesh;
  shape.to_world = state.to_world * geometry->to_object;
  require_finite(shape.to_world, e.place);
  const Surface& surface = e.context.surfaces[state.surface];
  surface.key.take();
  shape.material = material_of(e, state);
  shape.turned = state.is_reversed != surface.turned;
  if (state.area && in_object)
    e.lose("the light of shapes of an object with instances is left out, as in pbrt");
  else if (state.area)
    shape.emission = emission_of(e, *state.area, *geometry, shape.to_world);
  if (shape.emission && surface.turned && !shape.emission->both_sides) {
    e.lose("the side from which a body of glass emits light is not kept");
    shape.emission->both_sides = true;
  }
  return shape;
}

void add_medium(const Entity& e, const std::string& name) {
  const Rgb scattered = e.spectrum("sigma_s", Role::index).value_or(Rgb(2.55f, 3.21f, 3.77f));
  const Rgb absorbed = e.spectrum("sigma_a", Role::index).value_or(Rgb(.0011f, .0024f, .014f));
  const auto scale = static_cast<float>(e.number("scale", 1));
  const std::string kind = e.text("type"), preset = e.text("preset");
  std::optional<Rgb>& left = e.context.absorbing[name] = {};
  if (kind != "homogeneous" || !preset.empty() || max_component(scattered) > 0 || e.has("Le"))
    return e.ignore();  // lost where it is used
  left = Rgb(std::exp(-absorbed.x * scale), std::exp(-absorbed.y * scale),
             std::exp(-absorbed.z * scale));
  e.ignore({"g"});  // nothing scatters
}

}  // namespace tdpt::foreign::pbrt
