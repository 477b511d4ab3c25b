// Finds the bottlenecks of a network of patches: the pivot pairs of the paper's section 4.1 are the
// arcs that a minimum cut (series_cut.h) crosses.
#pragma once
#include "libcommon/formats/dimacs.h"
#include "libcommon/math/series_cut.h"

namespace tdpt {

struct FoundCuts {
  CutFile file;                 ///< without provenance
  std::vector<CutFacts> facts;  ///< by cut
  std::vector<SeriesCut::Refused> refused;
  size_t drops = 0, passed = 0, closets = 0;  ///< as in SeriesCut
  size_t flows = 0;                           ///< maximum flows, each verified
};

/// At most `most` cuts of a network with patches, each verified.
FoundCuts cut_of(const DimacsFile& problem, size_t most, const CutLimits& limits);

/// The cut of a plain network as text: `s` value, `n` side of each node, `a` arcs of the cut.
std::string plain_cut_text(const DimacsFile& problem, const MaxFlow& flow,
                           const Provenance& provenance);

}  // namespace tdpt
