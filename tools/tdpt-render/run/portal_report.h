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

/// "portal.0, portal.1 and 3 more".
std::string names_of(const std::vector<std::string>& names);

/// Of segments through portals that carried only a `share` of the light.
std::string idleness(double share);

/// A sentence for each portal, as drawn, that will work another way; only the first ones if there
/// are many.
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
