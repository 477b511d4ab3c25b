// uv of described.h are Mitsuba's own: its v = 0 is the top row of an image as well.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/meshes/meshes.h"
#include "tools/tdpt-import/mitsuba/mitsuba.h"

namespace tdpt::foreign::mitsuba {
namespace {

constexpr size_t kMostShapes = 1000000;
constexpr const char* kBlackBack =
    "surfaces that are not \"twosided\" are black on their back in Mitsuba and have two sides in "
    "glTF";

// The front is where a file's normals point to, whichever way its triangles run.
void front_by_normals(Mesh& mesh) {
  for (auto& t : mesh.triangles) {
    const Vec3d n = in_double(mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]]);
    if (dot(front_of(mesh, t), n) < 0) std::swap(t[1], t[2]);
  }
}

// Whether images are mirrored on it, seen from its front.
bool mirrors_images(const Mesh& mesh) {
  if (mesh.uv.empty() || mesh.triangles.empty()) return false;
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto along = [&](uint32_t i, size_t k) { return double{mesh.uv[i][k]} - mesh.uv[a][k]; };
    sum += along(b, 0) * along(c, 1) - along(c, 0) * along(b, 1);
  }
  return sum > 0;
}

Mesh with_swapped_uv(Mesh mesh) {
  for (auto& uv : mesh.uv) std::swap(uv[0], uv[1]);
  return mesh;
}

template <class Make>
size_t mesh(Context& in, const std::string& key, const Make& make) {
  const auto it = in.meshes.find(key);
  if (it != in.meshes.end()) return it->second;
  in.scene.meshes.push_back(make());
  return in.meshes[key] = in.scene.meshes.size() - 1;
}

Shape from_file(Context& in, const Element& shape) {
  const std::string file = shape.needed_text("filename");
  const Place& place = shape.find("filename")->place;
  const bool flat = shape.flag("face_normals", false);
  const bool flip = shape.flag("flip_tex_coords", shape.type == "obj");
  const int index = shape.integer("shape_index", shape.type == "obj" ? -1 : 0);
  if (shape.type == "obj" && index >= 0)
    shape.find("filename")
        ->lose("of an OBJ file all shapes are taken, not the one that shape_index names");
  if (shape.type == "serialized" && index < 0) shape.fail("a negative shape_index");
  shape.ignore("collapse load_materials srgb");  // of parts and colours that are not read
  Shape out;
  // Meshes are the same if they are read alike.
  const std::string key = fmt::format("{}:{}:{}:{}:{}", shape.type, index, flip, flat, file);
  bool has_normals = false;
  out.mesh = mesh(in, key, [&] {
    const auto bytes = shape.source->read_mesh(file, place);
    if (!bytes) return Mesh{};
    const std::string name = shape.source->shown_name(file);
    Mesh m = shape.type == "obj"   ? read_obj(*bytes, name)
             : shape.type == "ply" ? read_ply(*bytes, name)
                                   : read_serialized(*bytes, name, static_cast<size_t>(index));
    if (flip != (shape.type == "obj")) flip_v(m);
    has_normals = !m.normals.empty() && !flat;
    if (flat)
      m.normals.clear();
    else if (has_normals)
      front_by_normals(m);
    else
      smooth(m, false);  // vertices at one place that the file keeps apart stay apart
    return m;
  });
  if (has_normals) in.meshes_with_normals.insert(out.mesh);
  out.to_world = shape.transform("to_world");
  // Without normals the front is found after the mesh is placed.
  out.turned = !in.meshes_with_normals.contains(out.mesh) && out.to_world.mirrors();
  return out;
}

std::optional<Shape> round_or_flat(Context& in, const Element& shape) {
  Shape out;
  const Affine to_world = shape.transform("to_world");
  out.to_world = to_world;
  const std::string& type = shape.type;
  if (type == "rectangle") {
    out.mesh = mesh(in, type, [] { return flipped(square()); });
  } else if (type == "cube") {
    out.mesh = mesh(in, type, [] { return cube(); });
  } else if (type == "disk") {
    out.mesh = mesh(in, type, [] { return with_swapped_uv(disc()); });
  } else if (type == "sphere") {
    out.mesh = mesh(in, type, [] { return sphere(); });
    const Vec3d centre = shape.vector("center").value_or(Vec3d(0));
    double r = shape.number("radius", 1);
    if (!(r > 0)) shape.fail(fmt::format("a sphere of radius {}", r));
    if (shape.old) {  // the scale counts for the radius, not for the centre
      const double scale = length(to_world.x);
      if (!(scale > 0)) shape.fail("a transform with an axis of no length");
      out.to_world = {to_world.x / scale, to_world.y / scale, to_world.z / scale, to_world.t};
      r *= scale;
    } else {
      out.turned = to_world.mirrors();
    }
    out.to_world = out.to_world * Affine{{r, 0, 0}, {0, r, 0}, {0, 0, r}, centre};
  } else if (type == "cylinder") {
    out.mesh = mesh(in, type, [] { return flipped(cylinder()); });
    const Vec3d from = shape.vector("p0").value_or(Vec3d(0));
    const Vec3d to = shape.vector("p1").value_or(Vec3d{0, 0, 1});
    const double r = shape.number("radius", 1), l = length(to - from);
    if (!(r > 0) || !(l > 0))
      shape.fail(fmt::format("a cylinder of radius {} and length {}", r, l));
    const Onb<double> frame((to - from) / l);
    out.to_world = to_world * Affine{frame.x * r, frame.y * r, frame.z * l, from};
  } else {
    return {};
  }
  return out;
}

// What Mitsuba gives to shapes without a bsdf: grey, black, or nothing to be seen.
Surface default_surface(Context& in, const std::string& name) {
  const auto [it, is_new] = in.default_materials.try_emplace(name, in.scene.materials.size());
  if (is_new) {
    Material m = diffuse({Rgb(name == "default" ? 0.5f : 0.0f), {}, {}});
    m.invisible = name == "null";
    m.name = name;
    in.scene.materials.push_back(std::move(m));
  }
  return {it->second, false, name == "default"};
}

// Surface, medium and emission.
void dress(Context& in, const Element& shape, Shape& out) {
  const auto bsdfs = shape.nested("bsdf");
  if (bsdfs.size() > 1) shape.lose("of several bsdfs of a shape the first is taken");
  const Element* interior = nullptr;
  bool has_medium = false;
  for (const Element* v : shape.children)
    if (v->tag == "medium") {
      v->key.take();
      has_medium = true;
      if (v->name == "interior" && !bsdfs.empty())
        interior = v->object;
      else
        v->lose(kMedia);
    }
  const auto emitters = shape.nested("emitter");
  const char* otherwise = !emitters.empty()         ? "black"
                          : has_medium && shape.old ? "null"
                                                    : "default";
  const Surface made =
      bsdfs.empty() ? default_surface(in, otherwise) : surface(in, *bsdfs[0], interior);
  out.material = made.material;
  out.turned ^= made.turned;
  for (const Element* e : emitters)
    if (e->type != "area") {
      e->lose(fmt::format("emitters of type \"{}\" are not read and left out", shown(e->type, 40)));
    } else {
      out.emission = Emission{colour(in, *e, "radiance", Rgb(1), Role::light), false};
      e->ignore("sampling_weight");  // how it is sampled
    }
  // In Mitsuba +Y of a normal map is normal x dp/du, in glTF up in the image.
  if (in.scene.materials[out.material].normal &&
      mirrors_images(in.scene.meshes[out.mesh]) != (out.turned != out.to_world.mirrors())) {
    const auto [it, is_new] = in.green_down.try_emplace(out.material, in.scene.materials.size());
    if (is_new) {
      in.scene.materials.push_back(in.scene.materials[out.material]);
      in.scene.materials.back().normal->green_down = true;
    }
    out.material = it->second;
  }
  const Number& opacity = in.scene.materials[out.material].opacity;
  const bool closed =
      (shape.type == "sphere" || shape.type == "cube") && opacity.factor >= 1 && !opacity.texture;
  if (made.one_sided && closed)
    in.bodies.emplace_back(&shape, in.scene.shapes.size());
  else if (made.one_sided)
    shape.lose(kBlackBack);
}

void place(Context& in, const Element& shape, const Affine& outer, bool in_group);

void place_instance(Context& in, const Element& shape, const Affine& outer) {
  const Affine map = outer * shape.transform("to_world");
  const auto groups = shape.nested("shape");
  if (groups.empty()) shape.fail("the instance has no shapegroup");
  for (const Element* group : groups) {
    if (group->type != "shapegroup")
      shape.fail(fmt::format("the instance is of a {}, expected a shapegroup", group->described()));
    for (const Element* inner : group->nested("shape")) place(in, *inner, map, true);
  }
}

void place(Context& in, const Element& shape, const Affine& outer, bool in_group) {
  if (++in.visited_shapes > kMostShapes)
    shape.fail(fmt::format("more than {} shapes", kMostShapes));
  if (shape.type == "shapegroup") return;  // only its instances are seen
  if (shape.type == "instance") {
    if (in_group) shape.fail("an instance in a shapegroup, which Mitsuba does not allow");
    return place_instance(in, shape, outer);
  }
  if (shape.type == "merge") {
    for (const Element* inner : shape.nested("shape")) place(in, *inner, outer, in_group);
    return;
  }
  std::optional<Shape> out =
      is_one_of(shape.type, "obj ply serialized") ? from_file(in, shape) : round_or_flat(in, shape);
  if (!out) {
    shape.lose(fmt::format("the shape \"{}\" is not read and left out", shown(shape.type, 40)));
    return shape.ignore_all();
  }
  if (in.scene.meshes[out->mesh].triangles.empty()) return shape.ignore_all();
  out->to_world = outer * out->to_world;
  for (const Vec3d& v : {out->to_world.x, out->to_world.y, out->to_world.z, out->to_world.t})
    if (!is_finite(v) || length(v) > 1e30) shape.fail("the shape is too large or too far away");
  if (shape.flag("flip_normals", false)) out->turned = !out->turned;
  for (const Element* e : shape.nested("emitter"))
    if (e->type == "portal") {  // an opening and no surface
      shape.ignore_all();
      in.portals.insert(e);
      in.scene.portals.push_back(std::move(*out));
      return;
    }
  dress(in, shape, *out);
  out->name = shape.id;
  shape.ignore("silhouette_sampling_weight");  // how it is sampled
  in.scene.shapes.push_back(std::move(*out));
}

}  // namespace

void add_shape(Context& in, const Element& shape) {
  place(in, shape, {}, false);
}

// Cameras within a body see its inside, those without its outside.
void lose_backs(const Context& in) {
  for (const auto& [object, index] : in.bodies) {
    const Shape& shape = in.scene.shapes[index];
    const Mesh& mesh = in.scene.meshes[shape.mesh];
    const double sign = shape.to_world.mirrors() ? -1 : 1;
    const auto within = [&](const Camera& camera) {
      return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
        Vec3d p[3];
        for (size_t k = 0; k < 3; ++k)
          p[k] = shape.to_world.point(in_double(mesh.positions[t[k]])) - camera.to_world.t;
        return sign * dot(cross(p[1] - p[0], p[2] - p[0]), p[0]) > 0;
      });
    };
    for (const Camera& camera : in.scene.cameras)
      if (within(camera) != shape.turned) {
        object->lose(kBlackBack);
        break;
      }
  }
}

}  // namespace tdpt::foreign::mitsuba
