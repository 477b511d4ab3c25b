// The portals in the plans of their scene, storey by storey.
#pragma once
#include <string>
#include <vector>

#include "libcommon/draw/canvas.h"
#include "libcommon/formats/portal.h"
#include "libcommon/scene/scene.h"
#include "tools/portalfit/portalfit.h"

namespace tdpt {

/// What was refused is grey, with its reason. `why_none`: the reason if there is no portal.
draw::Canvas plan_preview(const Scene& scene, const Camera& camera, const FitResult& found,
                          const std::string& why_none);

}  // namespace tdpt
