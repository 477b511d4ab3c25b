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

/// How much of the light that the camera sees passes each portal that is used, those with most of
/// it first; empty where none is, or nothing was measured.
std::string light_sentence(const std::vector<Portal>& portals);

/// "portal.0, portal.1 and 3 more".
std::string names_of(const std::vector<std::string>& names);

/// Why the segments through portals may have brought only a `share` of the light: what was measured
/// of it before, here or by portalfit, or a question where nothing was.
std::string idleness(const std::vector<Portal>& portals, double share);

/// A sentence for each of the portals, as they are drawn, that will work another way; for many the
/// first ones.
std::vector<std::string> turnings(const std::vector<Portal>& portals,
                                  const std::vector<PortalWay>& ways);

/// After rendering: which portals' samples brought next to no light. Empty where there are none, or
/// nothing was drawn through portals.
std::string useless_portals(const std::vector<Portal>& portals, const RenderResult& result);
/// The same of one portal, with its figures, for --explain.
std::string useless_portal(const std::vector<Portal>& portals, size_t portal,
                           const RenderResult& result);

/// The array `portals` of the statistics.
nlohmann::ordered_json portals_json(const std::vector<Portal>& portals, const RenderResult& result);

}  // namespace tdpt
