// By pbrt-v4's materials.cpp and bxdfs.h.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/pbrt/surface_reader.h"

namespace tdpt::foreign::pbrt {
namespace {

Surface diffuse_v4(const Reader& r) {
  return {diffuse(r.colour("reflectance", 0.5f))};
}

double ior_v4(const Reader& r, const std::string& name, double absent) {
  const double ior = index_of(r.context, r.list, name, absent);
  return ior == 0 ? 1 : ior;
}

void lose_in_coat(const Reader& r) {
  if (!is_black(r.flat_colour("albedo", 0))) r.lose("scattering in the coat is left out");
  if (r.list.integer("maxdepth", 10) < 10) r.lose("light of many bounces in the coat is kept");
  r.list.ignore({"nsamples", "g"});  // how it is sampled and scatters
}

Surface coateddiffuse(const Reader& r) {
  const float thickness = r.flat_number("thickness", 0.01);
  lose_in_coat(r);
  const double ior = ior_v4(r, "eta", 1.5);
  if (!(ior > 0)) Source::fail(r.list.place, "the index of refraction is not above 0");
  return {plastic_under_layer(r.colour("reflectance", 0.5f), ior, alpha(r, 0),
                              std::clamp(thickness, 0.0f, 100.0f))};
}

Surface conductor_v4(const Reader& r) {
  const Number a = alpha(r, 0);
  if (r.list.find("reflectance")) return {metal(r.colour("reflectance", 0.5f), a)};
  return metal_of(r, a);
}

Surface coatedconductor(const Reader& r) {
  const Number a = alpha(r, 0, "conductor."), coat = alpha(r, 0, "interface.");
  Surface s = r.list.find("reflectance") ? Surface{metal(r.colour("reflectance", 0.5f), a)}
                                         : metal_of(r, a, "conductor.");
  s.material.coat = 1;
  s.material.coat_roughness = std::sqrt(coat.texture ? 0.5f : coat.factor);
  if (std::abs(ior_v4(r, "interface.eta", 1.5) - 1.5) > 0.01)
    r.lose("the coat's index of refraction becomes 1.5");
  if (r.flat_number("thickness", 0.01) > 0.01f) r.lose("absorption in the coat is left out");
  lose_in_coat(r);
  r.lose("the metal's reflectance below the coat becomes that in air");
  return s;
}

Surface dielectric(const Reader& r) {
  return body(r, ior_v4(r, "eta", 1.5), {}, alpha(r, 0));
}

Surface thindielectric(const Reader& r) {
  const double ior = ior_v4(r, "eta", 1.5);
  if (!(ior > 0)) Source::fail(r.list.place, "the index of refraction is not above 0");
  return {glass(ior < 1 ? 1 / ior : ior, {}, {0.0f, {}, {}}, false)};
}

Surface diffusetransmission(const Reader& r) {
  const float scale = static_cast<float>(r.list.number("scale", 1));
  r.colour("transmittance", 0.25f);
  r.lose("light that is scattered through the surface is left out");
  return {diffuse(scaled(r.colour("reflectance", 0.25f), scale))};
}

constexpr SurfaceKind kKinds[] = {
    {"diffuse", diffuse_v4},
    {"coateddiffuse", coateddiffuse},
    {"conductor", conductor_v4},
    {"coatedconductor", coatedconductor},
    {"dielectric", dielectric},
    {"thindielectric", thindielectric},
    {"diffusetransmission", diffusetransmission},
};

}  // namespace

const SurfaceKind* kind_v4(const std::string& name) {
  const auto* it = std::find_if(std::begin(kKinds), std::end(kKinds),
                                [&](const SurfaceKind& k) { return name == k.name; });
  return it == std::end(kKinds) ? nullptr : it;
}

}  // namespace tdpt::foreign::pbrt
