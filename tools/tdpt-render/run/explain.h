// What --explain says of a rendering: what the scene uses, which portals and integrators were
// weighed, what ran, and the price of each.
#pragma once
#include "libcommon/cli/decision.h"
#include "tools/tdpt-render/run/choice.h"

namespace tdpt {

/// All that a rendering was decided by.
struct Rendered {
  const World& world;
  const std::vector<Portal>& portals;  ///< those that could be used, as they then worked
  const Request& request;
  const Choice& choice;
  const RenderSettings& settings;
  const RenderResult& result;
};

cli::Decisions decisions_of(const Rendered& r);
/// Of what decide() tells: those that come before the first sample.
cli::Decisions decisions_of_plan(const Rendered& r);

}  // namespace tdpt
