// Clear coat, as KHR_materials_clearcoat has it: a colourless dielectric of index 1.5 above
// whatever lies under it, with a roughness and a normal of its own.
//
// Directions are unit and in the coat's frame: z along its normal, on the side of `from`.
// Lobe: strength F D G2 / (4 cos cos), F = 0.04 + 0.96 (1 - c)^5, one bounce [ggx.h].
// What it leaves to the layers under it is 1 - E along each of two directions, E its directional
// albedo. They take the lesser of the two, but for a diffuse lobe [bsdf.h]. The format takes it
// along the view alone, which is not reciprocal.
#pragma once
#include "libcommon/math/vec.h"
#include "tools/tdpt-render/path/bsdf/interface_albedo.h"

namespace tdpt {

struct Coat {
  float strength = 0;     ///< [0,1]; 0: none
  float alpha = 0;        ///< GGX, [0,1]; below 1e-4: smooth
  Vec3f normal{0, 0, 1};  ///< unit, in the frame of what lies under it
  explicit operator bool() const { return strength > 0; }
};

namespace coat {

constexpr double kF0 = 0.04;

bool smooth(const Coat& c);
/// 1 - E at cosine `mu`, of either sign.
double left_over(const Coat& c, double mu);

/// The lobe that is not Dirac, colourless [1/sr]; and its density, once the coat is taken.
double f(const Coat& c, const Vec3d& from, const Vec3d& to);
double pdf_w(const Coat& c, const Vec3d& from, const Vec3d& to);
/// Reflects `from`, by a Dirac lobe if smooth. False when facets send it into the surface.
bool sample(const Coat& c, const Vec3d& from, double u, double v, Vec3d& to);
/// Of a smooth coat.
double reflectance(const Coat& c, double mu);

}  // namespace coat
}  // namespace tdpt
