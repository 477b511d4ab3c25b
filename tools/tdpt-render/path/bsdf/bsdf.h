// Scattering at one point of a surface, after textures: glTF metallic-roughness with specular, ior,
// transmission, sheen, and what a clear coat leaves of it. The coat's own lobe, which may have
// another normal, comes on top in coated.h.
//
// Directions are unit, point away from the surface and are given in the shading frame: z along the
// shading normal of the front side. `from` is where a walk came from, `to` where it goes.
//
// f is symmetric, f(a, b) = f(b, a), because it relates basic radiance L/n^2:
//   L_o / n_o^2 = int f (L_i / n_i^2) n_i^2 |cos_i| dw_i,   n = index(side).
// The radiance BSDF is f * n_o^2, n_o on the camera's side. Perfectly smooth lobes (Dirac) are kept
// apart: f and pdf_w never include them. A walk's weight is f n_to^2 |cos_to| / pdf_w, or
// dirac_reflectance / dirac_probability: their mean is at most 1, whatever the side.
//
// Interface: GGX, height-correlated Smith, one bounce among microfacets (what shadows lose is lost:
// rough metal and rough glass darken). Its reflectance goes from f0 to f90: opaque, by Schlick's
// (1 - cos)^5; with `through`, by the exact curve of unpolarised light for eta, so that
// f0 = ((eta-1)/(eta+1))^2, f90 = 1 is exact; all of it where reflection is total.
// Diffuse under it: diffuse/pi (1 - E(from)) (1 - E(to)) / (1 - E_avg), E the interface's own
// directional albedo: white under any interface reflects all that the interface does not.
// Opaque and thin surfaces look the same from both sides. A solid's diffuse lobe is on its front
// only; with both `diffuse` and `through`, whose sum is to be at most 1 and eta at least 1,
// Schlick's curve (of the cosine before the front) takes the exact one's place, so that E stays
// known. A thin sheet transmits by the reflected lobe, mirrored to the other side.
// Above it all but a coat lies the sheen [sheen.h]. It leaves to the others the lesser of
// 1 - max(colour) E_s along the two directions, as KHR_materials_sheen has it. A coat leaves the
// lesser of c = 1 - E_c [coat.h], but to the diffuse lobe (1 - E) c at both ends over their common
// average, so that white under any coat is white. Inside a solid there is neither.
#pragma once
#include <cstdint>

#include "libcommon/math/vec.h"
#include "tools/tdpt-render/path/bsdf/coat.h"
#include "tools/tdpt-render/path/bsdf/interface_albedo.h"

namespace tdpt {

struct Bsdf {
  Rgb diffuse{};       ///< colour under the interface, [0,1]
  Rgb f0{};            ///< reflectance of the interface at normal incidence
  Rgb f90{};           ///< and at grazing incidence (Schlick); all 0: no interface
  Rgb through{};       ///< colour of what goes through; 0: opaque
  float alpha = 1;     ///< GGX, [0,1]; below 1e-4, or for |eta - 1| < 1e-4 in a solid: smooth
  float eta = 1;       ///< index behind the front side / before it; used when `through` is not 0
  bool thin = false;   ///< transmits straight on, without refraction
  InterfaceRow row{};  ///< of alpha, where many will ask [prepare()]

  Rgb sheen{};            ///< colour, [0,1]
  float sheen_alpha = 0;  ///< squared roughness; 0: no sheen
  Coat coat;
  Rgb under_coat{-1};  ///< average of what interface and coat leave to the diffuse lobe [prepare()]

  /// After all else is set; what is not prepared is found each time, to the same bits.
  void prepare();

  /// One diffuse lobe and nothing else.
  bool only_diffuse() const {
    return !(f90.x > 0 || f90.y > 0 || f90.z > 0 || through.x > 0 || through.y > 0 ||
             through.z > 0 || layers_above());
  }
  bool has_sheen() const { return sheen_alpha > 0; }
  bool layers_above() const { return coat || has_sheen(); }
  bool transmits() const { return through.x > 0 || through.y > 0 || through.z > 0; }
  /// Index of refraction on the side of w.
  double index(const Vec3d& w) const {
    return w.z < 0 && !thin && transmits() ? static_cast<double>(eta) : 1.0;
  }
};

namespace bsdf {

/// Whether some lobe is not Dirac, so that connections can be made here.
bool connectible(const Bsdf& b);

/// Lobes that are not Dirac [1/sr]; 0 where a direction lies in the surface.
Rgb f(const Bsdf& b, const Vec3d& from, const Vec3d& to);
/// Density with which sample() takes `to` by a lobe that is not Dirac, including the choice of the
/// lobe.
double pdf_w(const Bsdf& b, const Vec3d& from, const Vec3d& to);

/// Directional albedo: the share that leaves of what comes from `from`. Of opaque surfaces within
/// 0.01, of rough transmission about; inside a rough solid 1.
Rgb albedo(const Bsdf& b, const Vec3d& from);

struct Scattered {
  Vec3d to;
  bool dirac;
};
/// Three uniform numbers in [0,1). False when the walk is absorbed: pdf_w and dirac_probability add
/// up to 1 less the probability of that.
bool sample(const Bsdf& b, const Vec3d& from, double choice, double u, double v, Scattered& out);

/// Of the Dirac lobe that leads from `from` to `to` (reflection on the same side, transmission on
/// the other): the probability that sample() takes it, and its symmetric reflectance or
/// transmittance of basic radiance.
double dirac_probability(const Bsdf& b, const Vec3d& from, const Vec3d& to);
/// That sample() tries a Dirac lobe, whichever way it leads.
double any_dirac_probability(const Bsdf& b, const Vec3d& from);
/// That sample() takes the diffuse lobe or the sheen.
double diffuse_probability(const Bsdf& b, const Vec3d& from);
Rgb dirac_reflectance(const Bsdf& b, const Vec3d& from, const Vec3d& to);

}  // namespace bsdf
}  // namespace tdpt
