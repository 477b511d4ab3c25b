// The portals in the plans of their scene, storey by storey.
#pragma once
#include <string>
#include <vector>

#include "libcommon/draw/canvas.h"
#include "libcommon/formats/portal.h"
#include "libcommon/scene/scene.h"
#include "tools/portalfit/portalfit.h"

namespace tdpt {

/// `why_none`: the reason if no portal is written. `found`, and of each of its portals why it is
/// left out, empty where it is written: what is left out or refused is grey, with its reason.
draw::Canvas plan_preview(const Scene& scene, const Camera& camera, const FitResult& found,
                          const std::vector<std::string>& left_out, const std::string& why_none);

}  // namespace tdpt
