// What a rendering says about itself: --stats, --json, and the attributes of the picture.
#pragma once
#include "tools/tdpt-render/run/render.h"

namespace tdpt {

/// JSON with the keys of tdpt-render(1), one object; with `frames` when the result has them.
std::string stats_json(const Integrator& integrator, const RenderSettings& settings,
                       const RenderResult& result, const std::vector<Portal>& portals = {});
/// The same without `frames`, which are long.
std::string summary_json(const Integrator& integrator, const RenderSettings& settings,
                         const RenderResult& result, const std::vector<Portal>& portals = {});

/// Of what was decided without rendering: who would render, how many samples, and what tells it.
std::string plan_json(const RenderResult& decided, const std::vector<Portal>& portals);

/// What the length of paths leaves out, by --max-depth or by the hard stop; empty where that is
/// nothing to speak of.
std::string length_sentence(const RenderSettings& settings, const RenderResult& result);

/// What `auto` chose, and why.
std::string choice_sentence(const RenderResult& result);
/// How efficient the best of the candidates with portals is beside the best without, as measured
/// before rendering; empty where that is not known.
std::string verdict_sentence(const RenderResult& result);

/// --set nonzero: red where a pixel got some contribution, green where it is black.
Picture nonzero_picture(const Picture& picture);

/// String attributes of the EXR header, but for the number of samples and the target's. `chosen`:
/// label of what `auto` chose; empty: there was no choice.
std::map<std::string, std::string> exr_attributes(const Integrator& integrator,
                                                  const std::string& chosen,
                                                  const RenderSettings& settings,
                                                  const Provenance& provenance);
/// Lines of provenance with one more option in the last command of that tool.
std::string with_option(const std::string& provenance, const std::string& tool,
                        const std::string& option);

}  // namespace tdpt
