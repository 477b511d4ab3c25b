// Scattering at one point of a surface by the formulas as books have them, and each question
// answered by itself: against the text of shaders/shared/path. Only the tables of albedos are
// shared with it. For tests. Directions are unit, in the shading frame
// [shaders/shared/path/bsdf.h].
#pragma once
#include "tools/tdpt-render/path/bsdf/bsdf.h"

namespace tdpt::oracle {

namespace bsdf {

bool transmits(const Bsdf& b);
bool only_diffuse(const Bsdf& b);
/// Index of refraction on the side of w.
double index(const Bsdf& b, const Vec3d& w);
/// Lobes that are not Dirac [1/sr], and the density with which they are drawn.
Vec3d f(const Bsdf& b, const Vec3d& from, const Vec3d& to);
double pdf_w(const Bsdf& b, const Vec3d& from, const Vec3d& to);
/// Directional albedo: the share that leaves of what comes from `from`.
Vec3d albedo(const Bsdf& b, const Vec3d& from);
/// Of the Dirac lobe that leads from `from` to `to`.
double dirac_probability(const Bsdf& b, const Vec3d& from, const Vec3d& to);
Vec3d dirac_reflectance(const Bsdf& b, const Vec3d& from, const Vec3d& to);
/// That the diffuse lobe or the sheen is taken.
double diffuse_probability(const Bsdf& b, const Vec3d& from);

}  // namespace bsdf

/// In the coat's own frame, on the side of `from`.
namespace coat {

bool smooth(const shader::Coat& c);
/// 1 - E at cosine `mu`, of either sign.
double left_over(const shader::Coat& c, double mu);
double f(const shader::Coat& c, const Vec3d& from, const Vec3d& to);
double pdf_w(const shader::Coat& c, const Vec3d& from, const Vec3d& to);
double reflectance(const shader::Coat& c, double mu);

}  // namespace coat

}  // namespace tdpt::oracle
