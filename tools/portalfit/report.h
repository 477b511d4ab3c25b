// What a run says of the portals: a line each, and the text of --explain, which names each that is
// written or refused, with its figure and the limit.
#pragma once
#include <string>
#include <vector>

#include "libcommon/base/process.h"
#include "libcommon/cli/cli.h"
#include "libcommon/formats/portal.h"
#include "tools/portalfit/portalfit.h"

namespace tdpt {

/// Of the phases only `fit` is used.
cli::Decisions decisions_of(const LightGrid& grid, const PortalFitOptions& options,
                            const FitResult& found, const Phases& phases);

/// "3 portals: portal.0 0.69 m2, ..."; of many only the first are named.
/// There is at least one; each has its figures.
std::string portals_sentence(const std::vector<Portal>& portals);

}  // namespace tdpt
