#include "tools/tdpt-render/path/sample/surface.h"

#include "libcommon/scene/texture.h"
#include "tools/tdpt-render/path/bsdf/surfaces.h"

namespace tdpt {
namespace {

void add_lobes(const Scene& scene, const Material& m, const SurfacePlace& place, Point& p) {
  p.simple = false;
  p.shading = shading_normal_at(scene, place, p.normal);
  const shader::Surfaces& text = surfaces();
  if (m.plain) {
    p.bsdf = text.diffuse_bsdf(m.base_color);
    return;
  }
  const bool bent_coat = m.coat > 0 && (m.maps[MAP_NORMAL] || m.maps[MAP_COAT_NORMAL]);
  text.put_material(material_at(scene, place), bent_coat,
                    bent_coat ? coat_normal_at(scene, place, p.normal) : p.normal, p);
}

bool emits(const Material& m) {
  return !(m.emission.x + m.emission.y + m.emission.z <= 0);  // true for NaN, so it is reported
}

// Out of line, so that surfaces that need neither stay fast.
[[gnu::noinline]] void add_emission(const World& world, const Material& m, const Hit& hit,
                                    Point& p) {
  p.emission = m.plain ? m.emission : emission_at(world.scene, {hit.triangle, hit.b1, hit.b2});
  if (p.emission != Rgb{}) p.source = &world.lights.surface(m.double_sided);
}
[[gnu::noinline]] void add_layers(const World& world, const Material& m, const Hit& hit, Point& p) {
  const Scene& scene = world.scene;
  const bool flat = scene.smooth.empty() || !scene.smooth[hit.triangle];
  if (!(m.plain && flat)) add_lobes(scene, m, {hit.triangle, hit.b1, hit.b2}, p);
  if (emits(m)) add_emission(world, m, hit, p);
}

}  // namespace

void place_on_surface(const World& world, const Hit& hit, Point& p) {
  const Material& m = world.scene.material_of(hit.triangle);
  p.position = hit.position;
  p.normal = hit.normal;
  p.triangle = hit.triangle;
  p.material = &m;
  p.simple = true;
  p.connectible = true;
  p.color = m.base_color;
  p.source = nullptr;
  if (world.layered)
    add_layers(world, m, hit, p);
  else if (emits(m))
    add_emission(world, m, hit, p);
}

void place_in_sky(const LightSelection& selection, const Vec3d& w, Point& p) {
  p = {};
  p.position = -w;
  p.source = selection.lights().sky();
  p.in_sky = selection.look(w);
  p.connectible = false;
}

void place_on_light(const World& world, const Lights::Point& light, Point& p) {
  if (light.source->is_surface()) {
    Hit hit;
    hit.triangle = light.triangle;
    hit.b1 = light.b1;
    hit.b2 = light.b2;
    hit.position = light.position;
    hit.normal = world.tracer.shape(light.triangle).normal;
    place_on_surface(world, hit, p);
    if (p.material->alpha_mode != Material::Alpha::opaque)
      p.emission *= coverage_at(world.scene, {light.triangle, light.b1, light.b2});
    p.connectible = true;
  } else {
    p = {};
    p.position = light.position;
    p.in_sky = light.in_sky;
  }
  p.source = light.source;
}

}  // namespace tdpt
