// What a rendering says about its portals: what was measured of them, and what their samples did.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "tools/tdpt-render/plan/portal_ways.h"
#include "tools/tdpt-render/run/render.h"

namespace tdpt {

/// A portal brought next to no light when its samples brought less than the first share of it, or
/// less than the second and less than the third share of them connected a lamp with the camera;
/// told once there are as many samples as the last says.
inline constexpr double kNoEnergy = 0.001, kLeastEnergy = 0.01, kLeastLit = 0.25;
inline constexpr uint64_t kEnoughSamples = 1000;

/// The sentences, one for each portal; of many the first ones, and how many more there are.
std::vector<std::string> first_few(std::vector<std::string> sentences);

/// The figure of a portal that says what share of a small picture's light passes it.
inline constexpr const char* kLight = "light";

/// A sentence for each portal that is used: its area, and what is known of it; for many portals the
/// first ones.
std::vector<std::string> descriptions(const std::vector<Portal>& portals);

/// Of one that no light passes, or next to none.
std::string left_out(const Portal& portal, const PortalLight& light);

/// Why the segments through portals may have brought only a `share` of the light: what was measured
/// of it before, here or by portalfit, or a question where nothing was.
std::string idleness(const std::vector<Portal>& portals, double share);

/// A sentence for each of the portals, as they are drawn, that will work another way; for many the
/// first ones.
std::vector<std::string> turnings(const std::vector<Portal>& portals,
                                  const std::vector<PortalWay>& ways);

/// After rendering: a sentence for each portal whose samples brought next to no light; for many the
/// first ones. Empty when nothing was drawn through portals.
std::vector<std::string> useless_portals(const std::vector<Portal>& portals,
                                         const RenderResult& result);

/// The array `portals` of the statistics.
nlohmann::ordered_json portals_json(const std::vector<Portal>& portals, const RenderResult& result);

}  // namespace tdpt
