// Shapes. Texture coordinates stay: v = 0 is the top row of an image in Mitsuba, too.
#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/meshes/meshes.h"
#include "tools/tdpt-import/mitsuba/mitsuba.h"

namespace tdpt::foreign::mitsuba {
namespace {

constexpr size_t kMostShapes = 1000000;

// Turns triangles so that their fronts are where the file's normals point to.
void front_by_normals(Mesh& mesh) {
  for (auto& t : mesh.triangles) {
    const Vec3d n = in_double(mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]]);
    if (dot(front_of(mesh, t), n) < 0) std::swap(t[1], t[2]);
  }
}

// Whether images on the mesh are mirrored, seen from its front.
bool mirrors_images(const Mesh& mesh) {
  if (mesh.uv.empty() || mesh.triangles.empty()) return false;
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto along = [&](uint32_t i, size_t k) { return double{mesh.uv[i][k]} - mesh.uv[a][k]; };
    sum += along(b, 0) * along(c, 1) - along(c, 0) * along(b, 1);
  }
  return sum > 0;
}

Mesh disc_with_radius_as_u() {
  Mesh mesh = disc();
  for (auto& uv : mesh.uv) std::swap(uv[0], uv[1]);
  return mesh;
}

// The index of the mesh with this key; makes the mesh if the key is new.
template <class Make>
size_t mesh_index(Context& in, const std::string& key, const Make& make) {
  const auto [it, is_new] = in.meshes.try_emplace(key, in.scene.meshes.size());
  if (is_new) in.scene.meshes.push_back(make());
  return it->second;
}

Shape shape_from_file(Context& in, const Element& shape) {
  const std::string file = shape.needed_text("filename");
  const Element& filename = *shape.find("filename");
  const bool is_obj = shape.type == "obj", flat = shape.flag("face_normals", false);
  const bool flip = shape.flag("flip_tex_coords", is_obj);
  const int index = shape.integer("shape_index", is_obj ? -1 : 0);
  if (is_obj && index >= 0)
    filename.lose("of an OBJ file all shapes are taken, not the one that shape_index names");
  if (shape.type == "serialized" && index < 0) shape.fail("a negative shape_index");
  shape.ignore("collapse load_materials srgb");  // of parts and colours that are not read
  Shape out;
  out.to_world = shape.transform("to_world");
  out.mesh =
      mesh_index(in, fmt::format("{}:{}:{}:{}:{}", shape.type, index, flip, flat, file), [&] {
        const auto bytes = shape.source->read_mesh(file, filename.place);
        if (!bytes) return Mesh{};
        const std::string name = shape.source->shown_name(file);
        Mesh m = is_obj                ? read_obj(*bytes, name)
                 : shape.type == "ply" ? read_ply(*bytes, name)
                                       : read_serialized(*bytes, name, static_cast<size_t>(index));
        if (flip != is_obj) flip_v(m);
        if (flat) m.normals.clear();
        if (!m.normals.empty()) {
          front_by_normals(m);
          in.meshes_with_normals.insert(in.scene.meshes.size());
        } else if (!flat) {
          smooth(m, false);  // vertices at one place that the file keeps apart stay apart
        }
        return m;
      });
  // Without normals the front is found after the mesh is placed.
  out.turned = !in.meshes_with_normals.contains(out.mesh) && out.to_world.mirrors();
  return out;
}

std::optional<Shape> primitive_shape(Context& in, const Element& shape) {
  static const std::map<std::string, Mesh (*)()> kMeshes = {
      {"rectangle", [] { return flipped(square()); }},
      {"cube", cube},
      {"disk", disc_with_radius_as_u},
      {"sphere", sphere},
      {"cylinder", [] { return flipped(cylinder()); }},
  };
  const auto known = kMeshes.find(shape.type);
  if (known == kMeshes.end()) return {};
  Shape out;
  out.mesh = mesh_index(in, shape.type, known->second);
  out.to_world = shape.transform("to_world");
  if (shape.type == "sphere") {
    const Vec3d centre = shape.vector("center").value_or(Vec3d(0));
    double r = shape.number("radius", 1);
    if (!(r > 0)) shape.fail(fmt::format("a sphere of radius {}", r));
    if (shape.old) {  // the scale counts for the radius, not for the centre
      Affine& m = out.to_world;
      const double scale = length(m.x);
      if (!(scale > 0)) shape.fail("a transform with an axis of no length");
      m = {m.x / scale, m.y / scale, m.z / scale, m.t};
      r *= scale;
    } else {
      out.turned = out.to_world.mirrors();
    }
    out.to_world = out.to_world * Affine{{r, 0, 0}, {0, r, 0}, {0, 0, r}, centre};
  } else if (shape.type == "cylinder") {
    const Vec3d from = shape.vector("p0").value_or(Vec3d(0));
    const Vec3d to = shape.vector("p1").value_or(Vec3d{0, 0, 1});
    const double r = shape.number("radius", 1), l = length(to - from);
    if (!(r > 0) || !(l > 0))
      shape.fail(fmt::format("a cylinder of radius {} and length {}", r, l));
    const Onb<double> frame((to - from) / l);
    out.to_world = out.to_world * Affine{frame.x * r, frame.y * r, frame.z * l, from};
  }
  return out;
}

// The surface of shapes without a bsdf: grey, black or invisible.
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

// Gives a shape its surface and what it emits.
void set_surface(Context& in, const Element& shape, Shape& out) {
  const auto bsdfs = shape.nested("bsdf");
  if (bsdfs.size() > 1) shape.lose("of several bsdfs of a shape the first is taken");
  const auto media = shape.nested("medium");
  const Element* interior = nullptr;
  for (const Element* v : shape.children)
    if (v->tag == "medium") {
      if (v->name == "interior" && !bsdfs.empty())
        interior = v->object;
      else
        v->lose(kMedia);
    }
  const auto emitters = shape.nested("emitter");
  const char* otherwise = !emitters.empty()             ? "black"
                          : !media.empty() && shape.old ? "null"
                                                        : "default";
  const Surface front =
      bsdfs.empty() ? default_surface(in, otherwise) : surface(in, *bsdfs[0], interior);
  out.material = front.material;
  out.turned ^= front.turned;
  for (const Element* e : emitters)
    if (e->type == "area")
      out.emission = Emission{colour(in, *e, "radiance", Rgb(1), Role::light), false};
    else
      e->lose(fmt::format("emitters of type \"{}\" are not read and left out", shown(e->type, 40)));
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
      is_one_of(shape.type, "sphere cube") && opacity.factor >= 1 && !opacity.texture;
  if (front.one_sided && !closed)
    shape.lose(
        "surfaces that are not \"twosided\" are black on their back in Mitsuba and have two sides "
        "in glTF");
}

void add_placed(Context& in, const Element& shape, const Affine& outer) {
  if (++in.visited_shapes > kMostShapes)
    shape.fail(fmt::format("more than {} shapes", kMostShapes));
  if (shape.type == "shapegroup") return;  // only its instances are seen
  if (is_one_of(shape.type, "instance merge")) {
    const auto parts = shape.nested("shape");
    const Affine map = outer * shape.transform("to_world");
    if (parts.empty()) shape.fail(fmt::format("the {} has no shape in it", shape.described()));
    for (const Element* part : parts)
      if (part->type == "shapegroup")
        for (const Element* inner : part->nested("shape")) add_placed(in, *inner, map);
      else
        add_placed(in, *part, map);
    return;
  }
  std::optional<Shape> out = is_one_of(shape.type, "obj ply serialized")
                                 ? shape_from_file(in, shape)
                                 : primitive_shape(in, shape);
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
  set_surface(in, shape, *out);
  out->name = shape.id;
  in.scene.shapes.push_back(std::move(*out));
}

}  // namespace

void add_shape(Context& in, const Element& shape) {
  add_placed(in, shape, {});
}

}  // namespace tdpt::foreign::mitsuba
