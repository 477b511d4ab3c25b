// Finds the bottlenecks of a network of patches: the pivot pairs of the paper's section 4.1 are the
// arcs that a minimum cut (series_cut.h) crosses.
#pragma once
#include "libcommon/flow/max_flow.h"
#include "libcommon/flow/series_cut.h"
#include "libcommon/formats/dimacs.h"

namespace tdpt {

struct FoundCuts {
  CutFile file;                 ///< without provenance
  std::vector<CutFacts> facts;  ///< by cut
  std::vector<SeriesCut> cameras;
};

/// At most `most` cuts for each camera of a network with patches, each verified. Cameras are cut
/// one by one and not as one sink of all: a lamp in room B that lights room A through their door
/// would lose that door as soon as a camera stands in B, too.
FoundCuts cut_of(const DimacsFile& problem, size_t most, const CutLimits& limits);

/// The cut of a plain network as text: `s` value, `n` side of each node, `a` arcs of the cut.
std::string plain_cut_text(const DimacsFile& problem, const MaxFlow& flow,
                           const Provenance& provenance);

/// Verifies a maximum flow and minimum cut from the network alone, by duality (max-flow min-cut
/// theorem); shares no code with the solver. Throws Error (internal) naming the first rule
/// violated: every flow between 0 and its capacity, inflow = outflow at inner nodes, source and
/// sink on different sides, and value of the flow = capacity of the cut. By duality flow and cut
/// are then both optimal.
void verify_max_flow(const FlowNetwork& network, const MaxFlow& result);

}  // namespace tdpt
