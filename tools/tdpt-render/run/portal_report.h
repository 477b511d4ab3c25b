// What a rendering reports about its portals: the measurements, and what their samples contributed.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "tools/tdpt-render/plan/portal_ways.h"
#include "tools/tdpt-render/run/render.h"

namespace tdpt {

/// A portal is useless if its samples carried less than kNoEnergy of the light, or less than
/// kLeastEnergy while less than kLeastLit of them connected a lamp with the camera; needs
/// kEnoughSamples.
inline constexpr double kNoEnergy = 0.001, kLeastEnergy = 0.01, kLeastLit = 0.25;
inline constexpr uint64_t kEnoughSamples = 1000;

/// The first of the sentences, one for each portal, and how many more there are.
std::vector<std::string> first_few(std::vector<std::string> sentences);

/// Name of the figure for the share of a small picture's light that passes the portal.
inline constexpr const char* kLight = "light";

/// A sentence for each portal in use, with its area and what is known of it; only the first ones if
/// there are many.
std::vector<std::string> descriptions(const std::vector<Portal>& portals);

/// For a portal that no light passes, or next to none.
std::string left_out(const Portal& portal, const PortalLight& light);

/// Why the segments through portals may have carried only a `share` of the light: from earlier
/// measurements, here or by portalfit; a question if there are none.
std::string idleness(const std::vector<Portal>& portals, double share);

/// A sentence for each portal, as drawn, that will work another way; only the first ones if there
/// are many.
std::vector<std::string> turnings(const std::vector<Portal>& portals,
                                  const std::vector<PortalWay>& ways);

/// After rendering: a sentence for each portal whose samples carried next to no light; only the
/// first ones if there are many. Empty if nothing was sampled through portals.
std::vector<std::string> useless_portals(const std::vector<Portal>& portals,
                                         const RenderResult& result);

/// The array `portals` of the statistics.
nlohmann::ordered_json portals_json(const std::vector<Portal>& portals, const RenderResult& result);

}  // namespace tdpt
