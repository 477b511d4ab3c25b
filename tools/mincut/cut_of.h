// From a maximum flow to a cut of patches, and whether it is a bottleneck of the light.
#pragma once
#include "libcommon/formats/dimacs.h"

namespace tdpt {

struct CutLimits {
  double least_area = 0.03;  ///< share of the area that the smaller side must have
  double largest_conductance = 0.12;
};

/// Cut of a network with patches, without provenance. The result has been verified.
CutFile cut_of(const DimacsFile& problem, const MaxFlow& flow, const CutLimits& limits);

/// Cut of a plain network as text: `s` value, `n` side of each node, `a` arcs of the cut.
std::string plain_cut_text(const DimacsFile& problem, const MaxFlow& flow,
                           const Provenance& provenance);

}  // namespace tdpt
