// The text of --explain: what the scene uses, which portals and integrators were considered, what
// ran, and the cost of each.
#pragma once
#include "libcommon/cli/decision.h"
#include "tools/tdpt-render/run/choice.h"

namespace tdpt {

/// Everything that decided the rendering.
struct Rendered {
  const World& world;
  const std::vector<Portal>& portals;  ///< those in use, with the ways they work
  const Request& request;
  const Choice& choice;
  const RenderSettings& settings;
  const RenderResult& result;
};

cli::Decisions decisions_of(const Rendered& r);
/// For the result of decide(): the decisions made before the first sample.
cli::Decisions decisions_of_plan(const Rendered& r);

}  // namespace tdpt
