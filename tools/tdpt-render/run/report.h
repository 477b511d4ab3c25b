// What a rendering reports about itself: --stats, --json, and the attributes of the picture.
#pragma once
#include "tools/tdpt-render/run/render.h"

namespace tdpt {

/// JSON with the keys of tdpt-render(1) that are known before the picture is written, one object;
/// with `frames` when the result has them. `mark`: of a frame of a shot [Job::mark].
std::string stats_json(const Integrator& integrator, const RenderSettings& settings,
                       const RenderResult& result, const std::vector<Portal>& portals = {},
                       const std::string& mark = "");
/// The same without `frames`, which are long.
std::string summary_json(const Integrator& integrator, const RenderSettings& settings,
                         const RenderResult& result, const std::vector<Portal>& portals = {});

/// For a decision without a picture: who would render, how many samples, and the measurements
/// behind it.
std::string plan_json(const RenderResult& decided, const std::vector<Portal>& portals);

/// How much light the limit on path length leaves out, by --max-depth or by the hard stop; empty if
/// negligible.
std::string length_sentence(const RenderSettings& settings, const RenderResult& result);

/// What `auto` chose, and why.
std::string choice_sentence(const RenderResult& result);
/// Efficiency of the best candidate with portals against the best without, as measured before
/// rendering; empty if unknown.
std::string verdict_sentence(const RenderResult& result);

/// --set nonzero: red where a pixel got some contribution, green where it is black.
Picture nonzero_picture(const Picture& picture);

/// String attributes of the EXR header, except the number of samples and the target's. `chosen`:
/// label of the choice of `auto`; empty: there was no choice.
std::map<std::string, std::string> exr_attributes(const Integrator& integrator,
                                                  const std::string& chosen,
                                                  const RenderSettings& settings,
                                                  const Provenance& provenance);
/// Provenance with one more option in the last command of `tool`.
std::string with_option(const std::string& provenance, const std::string& tool,
                        const std::string& option);

}  // namespace tdpt
