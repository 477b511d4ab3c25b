// What --explain says about a network: which features of the scene matter to it, what each round of
// splitting changed, and why the rounds stopped.
#pragma once
#include "libcommon/cli/decision.h"
#include "tools/ffgraph/rounds.h"
#include "tools/ffgraph/triangle_flow.h"

namespace tdpt {

cli::Decisions decisions_of(const Scene& scene, const LightFlow& flow, const GraphReport& report);
cli::Decisions decisions_of(const Scene& scene, const TriangleSettings& settings,
                            const TriangleReport& report);

}  // namespace tdpt
