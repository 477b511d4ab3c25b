// Verifies a maximum flow and minimum cut from the network alone, by duality (max-flow min-cut
// theorem); shares no code with the solver.
#pragma once
#include "libcommon/math/max_flow.h"

namespace tdpt {

/// Throws Error (internal) naming the first rule violated: every flow between 0 and its capacity,
/// inflow = outflow at inner nodes, source and sink on different sides, and value of the flow =
/// capacity of the cut. By duality flow and cut are then both optimal.
void verify_max_flow(const FlowNetwork& network, const MaxFlow& result);

}  // namespace tdpt
