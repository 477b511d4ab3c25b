#include "tools/tdpt-render/path/sample/surface.h"

#include <algorithm>

#include "libcommon/scene/pane.h"
#include "libcommon/scene/texture.h"
#include "tools/tdpt-render/path/bsdf/sheen.h"

namespace tdpt {
namespace {

template <class T>
T square(T x) {
  return x * x;
}

// glTF 2.0 appendix B with KHR_materials_specular, _ior and _transmission. Dielectric and metal
// share one microfacet lobe, since Schlick's F is linear in f0 and f90. The coat's normal is put in
// by add_lobes().
Bsdf bsdf_of(const Scene& scene, const Material& m, const SurfacePlace& place) {
  const MaterialValues v = material_values_at(scene, place);
  Bsdf b;
  const float dielectric = 1 - v.metallic;
  const float r = (m.ior - 1) / (m.ior + 1);
  const Rgb f0 = min(v.specular_color * (r * r), Rgb(1.0f)) * v.specular;
  const bool interface = m.ior != 1;
  b.f0 = v.base_color * v.metallic + f0 * dielectric;
  b.f90 = Rgb(v.metallic + (interface ? v.specular * dielectric : 0.0f));
  b.diffuse = v.base_color * (dielectric * (1 - v.transmission));
  if (m.glossy_map) b.diffuse = b.diffuse * std::max(1 - max_component(v.specular_color), 0.0f);
  if (!pane_of(m))  // past a pane rays go by
    b.through = v.base_color * (dielectric * v.transmission);
  b.alpha = square(v.roughness);
  b.eta = m.ior;
  b.thin = !m.solid;
  b.sheen = v.sheen_color;
  if (max_component(b.sheen) > 0)
    b.sheen_alpha = square(std::max(v.sheen_roughness, sheen::kLeastRoughness));
  b.coat.strength = v.coat;
  b.coat.alpha = square(v.coat_roughness);
  if (!b.only_diffuse()) b.prepare();
  return b;
}

void add_lobes(const Scene& scene, const Material& m, const SurfacePlace& place, Point& p) {
  p.simple = false;
  p.shading = shading_normal_at(scene, place, p.normal);
  if (m.plain) {
    p.bsdf = {};
    p.bsdf.diffuse = m.base_color;
    return;
  }
  p.bsdf = bsdf_of(scene, m, place);
  p.connectible = bsdf::connectible(p.bsdf);
  if (!p.bsdf.coat) return;
  p.connectible |= !coat::smooth(p.bsdf.coat);
  if (m.normal_map || m.coat_normal_map)
    p.bsdf.coat.normal =
        Vec3f(normalize(Onb<double>(p.shading).to_local(coat_normal_at(scene, place, p.normal))));
}

bool emits(const Material& m) {
  return !(m.emission.x + m.emission.y + m.emission.z <= 0);  // what is no number is told as well
}

// Out of line, for the sake of surfaces that need neither.
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
  p.source = nullptr;
  if (world.layered)
    add_layers(world, m, hit, p);
  else if (emits(m))
    add_emission(world, m, hit, p);
}

void place_in_sky(const World& world, const Vec3d& w, Point& p) {
  p = {};
  p.position = -w;
  p.source = world.lights.sky();
  p.in_sky = world.lights.look(w);
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
