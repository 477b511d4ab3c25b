// What --explain says of a network: what of the scene matters to it, what each round of splitting
// brought, and why there was no other.
#pragma once
#include "libcommon/cli/decision.h"
#include "tools/ffgraph/rounds.h"
#include "tools/ffgraph/triangle_flow.h"

namespace tdpt {

cli::Decisions decisions_of(const Scene& scene, const GraphSettings& settings,
                            const LightFlow& flow, const GraphReport& report);
cli::Decisions decisions_of(const Scene& scene, const TriangleSettings& settings,
                            const TriangleReport& report);

}  // namespace tdpt
