// The light of the pictures on its way from patch to patch: finite-element radiosity on the
// network, solved once for how bright patches are and once per camera for what they mean to its
// picture.
//
// n_i, n_ij  samples and etendue of patches and pairs [etendue.h]: A_i F_ij ~ n_ij / 2
// D_i        power that reaches patch i straight from lamps and sky (first hits of light walks)
// W_i        what patch i means to a picture: the pixels that show it (first hits of camera
//            walks), half as they are and half each divided by its light. So light that few bright
//            pixels have counts, and light that many dark ones have
// r_i        albedo
//   n_i e_i = D_i + sum_j n_ij/2 r_j e_j     irradiance e_i
//   n_i m_i = W_i + sum_j n_ij/2 r_j m_j     importance m_i, the adjoint
// With E_i the power that patch i itself emits, the share of the picture's light that goes from i
// to j without a surface in between is
//   n_ij/2 b_i v_j,  b_i = (E_i / n_i + r_i e_i) / sum_k W_k r_k e_k,  v_j = r_j m_j.
// What a camera sees of the lamps themselves does not count. All cameras share one b, that of the
// first; v of each is scaled so that the formula gives the share of its own picture's light.
#pragma once
#include <vector>

#include "libcommon/formats/cut.h"
#include "tools/ffgraph/etendue.h"

namespace tdpt {

/// What the solution needs to know of each patch; of a bin of the sky only `emitted` counts.
struct LightTerms {
  std::vector<double> emitted;            ///< E_i
  std::vector<double> direct;             ///< D_i, in the same unit
  std::vector<double> albedo;             ///< r_i
  std::vector<std::vector<double>> seen;  ///< of each camera W_i
};

/// b and v of each patch, v 0 for cameras that none of the light reaches; empty if it reaches none.
std::vector<PatchLight> camera_light(const PatchMap& patches, const Etendue& etendue,
                                     const LightTerms& terms);

/// Albedo of each material of a scene, luminance: that of its factors and of the mean of its
/// texture; what it transmits is no part of it.
std::vector<double> albedos_of(const Scene& scene);

}  // namespace tdpt
