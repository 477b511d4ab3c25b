// What the readers of pbrt's materials share.
#pragma once
#include <functional>
#include <string>

#include "tools/tdpt-import/pbrt/surfaces.h"

namespace tdpt::foreign::pbrt {

/// A material that is being read; values are of its parameters.
struct Reader {
  Context& context;
  const Textures& textures;
  const Surfaces& named;
  const std::string& kind;
  const Parameters& list;

  Colour colour(const std::string& name, float absent) const;
  Number number(const std::string& name, double absent) const;
  /// Without the variation over the surface that glTF does not have for this.
  Rgb flat_colour(const std::string& name, float absent) const;
  float flat_number(const std::string& name, double absent) const;
  void lose(const std::string& what) const;
};

/// GGX alpha; `prefix` + "roughness" is the default of "uroughness" and "vroughness".
Number alpha(const Reader& r, double absent, const std::string& prefix = "");

/// Clamped to 0..1.
Colour scaled(const Colour& c, float k);

/// A glossy lobe ks * Fresnel(ior) beside, not above, a Lambertian kd: of the light that enters,
/// the part kd / (1 - share reflected) must come out.
Material lobes(const Reader& r, const Colour& kd, const Rgb& ks, double ior, const Number& alpha);

/// A dielectric surface between bodies.
Surface body(const Reader& r, double ior, const Colour& tint, const Number& alpha);

struct SurfaceKind {
  const char* name;
  Surface (*read)(const Reader&);
};
/// None for kinds that are not of that version alone.
const SurfaceKind* kind_v3(const std::string& name);
const SurfaceKind* kind_v4(const std::string& name);

}  // namespace tdpt::foreign::pbrt
