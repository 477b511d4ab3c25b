// What a rendering says about its portals: what they promised, and what their samples did.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "tools/tdpt-render/render.h"

namespace tdpt {

/// A portal brought next to no light when less than the first share of its samples joined a lamp
/// with the camera, and these brought less than the second share of the light; told once there are
/// as many samples as the third says.
inline constexpr double kLeastLit = 0.01, kLeastEnergy = 0.01;
inline constexpr uint64_t kEnoughSamples = 1000;

/// A sentence for each portal: area, and what its figures promise (portal(5)); for many portals the
/// first ones.
std::vector<std::string> promises(const std::vector<Portal>& portals);

/// After rendering: a sentence for each portal whose samples brought next to no light; for many the
/// first ones. Empty when nothing was drawn through portals.
std::vector<std::string> disappointments(const std::vector<Portal>& portals,
                                         const RenderResult& result);

/// The array `portals` of the statistics.
nlohmann::ordered_json portals_json(const std::vector<Portal>& portals, const RenderResult& result);

}  // namespace tdpt
