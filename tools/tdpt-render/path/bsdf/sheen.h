// Sheen of cloth, as KHR_materials_sheen has it: fibres that stand up, brightest at grazing angles.
//
// Shading frame, directions unit, on the side of z > 0; h the half vector, a = roughness^2.
//   D(h)    = (2 + 1/a) sin(h)^(1/a) / (2 pi)                         (Estevez & Kulla 2017)
//   V(v, w) = 1 / ((1 + L(v) + L(w)) 4 v_z w_z), L their fitted masking
// D V sends more than it receives at grazing angles and small roughness. There it is scaled:
//   f(v, w) = D V min(N(v), N(w)),  N = min(1, 1/E0),  E0 the directional albedo of D V,
// which changes nothing where E0 <= 1: at any angle for roughness of at least 0.25.
#pragma once
#include "libcommon/math/vec.h"

namespace tdpt::sheen {

/// The least roughness; less is taken for it.
constexpr float kLeastRoughness = 0.07f;

/// For a white sheen [1/sr]; 0 where a cosine is less than 1e-6. a in [kLeastRoughness^2, 1].
double f(const Vec3d& v, const Vec3d& w, double a);

/// Directional albedo of D V; above 1 where f is scaled.
double unscaled_albedo(double mu, double a);
/// Directional albedo of f: int f cos dw, at cosine `mu` to z; at most 1. From a table made on
/// first need, linear between nodes.
double albedo(double mu, double a);

}  // namespace tdpt::sheen
