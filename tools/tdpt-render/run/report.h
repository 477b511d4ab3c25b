// What a rendering tells about itself: --stats and --json, --explain, which prints the same as
// text, and the sentences of a plain run.
#pragma once
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "libcommon/options/render_options.h"
#include "tools/tdpt-render/run/render.h"

namespace tdpt {

/// The statistics of tdpt-json(5) that are known before the picture is written. `asked`: the only
/// candidate, or `auto` with the techniques of all. `portals`: with the ways they work. `device`:
/// the renderer's name.
nlohmann::ordered_json stats_of(const Job& job, const Integrator& asked,
                                const std::vector<Portal>& portals, const RenderResult& result,
                                const std::string& device = "cpu");

/// Statistics as text: a decision for each, and for each portal and candidate. `frames`, which are
/// long, are left out.
cli::Decisions decisions_of(const nlohmann::ordered_json& stats);

/// Before rendering: what is missing in the scene, and what becomes of each portal.
void report_before(const Job& job, const Vista& vista, const Integrator& asked,
                   const std::vector<Portal>& portals, const std::vector<PortalWay>& ways,
                   const cli::Common& common);
/// After it: who rendered and why, and what was not finite;
void report_choice(const Session& session, const RenderResult& result, const cli::Common& common);
/// and of a picture that is no frame of a shot what portals brought, and how noisy it is.
void report_after(const Session& session, const std::vector<Portal>& portals,
                  const RenderResult& result, const RenderArguments& a, const cli::Common& common);
/// "16 samples per pixel in 3 s, relMSE 0.012, 0.011 to 0.014".
std::string outcome_words(const Vista& vista, const RenderResult& result);

/// What `auto` chose, and why. `lit`: whether paths beyond the camera's rays can bring light.
std::string choice_sentence(const RenderResult& result, bool lit = true);
/// Efficiency of the best candidate with portals against the best without, as measured before
/// rendering; empty if unknown.
std::string verdict_sentence(const RenderResult& result);
/// How much light the limit on path length leaves out, by --max-depth or by the hard stop; empty if
/// negligible.
std::string length_sentence(const Job& job, const RenderResult& result);
/// A portal that will not work as it is drawn; else empty.
std::string way_sentence(const Portal& portal, PortalWay way);
/// Portals whose samples carried little light; empty if there are none.
std::string idleness_sentence(const std::vector<Portal>& portals, const RenderResult& result);

/// A portal is useless if its samples carried less than kNoEnergy of the light, or less than
/// kLeastEnergy while less than kLeastLit of them connected a lamp with the camera; needs
/// kEnoughSamples.
inline constexpr double kNoEnergy = 0.001, kLeastEnergy = 0.01, kLeastLit = 0.25;
inline constexpr uint64_t kEnoughSamples = 1000;

}  // namespace tdpt
