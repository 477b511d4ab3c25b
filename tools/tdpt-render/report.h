// What a rendering says about itself: --stats, --json, and the attributes of the picture.
#pragma once
#include "tools/tdpt-render/render.h"

namespace tdpt {

/// JSON with the keys of tdpt-render(1), one object.
std::string stats_json(const Integrator& integrator, const RenderSettings& settings,
                       const RenderResult& result);

/// String attributes of the EXR header.
std::map<std::string, std::string> exr_attributes(const Integrator& integrator,
                                                  const RenderSettings& settings,
                                                  const RenderResult& result,
                                                  const Provenance& provenance);

}  // namespace tdpt
