// What the figures of portals say, in words. They are measured by rays and promise nothing: what a
// portal is worth to a picture only a rendering of it can tell.
#pragma once
#include <map>
#include <string>

namespace tdpt {

/// Through a cut of more conductance light finds its way without a portal.
inline constexpr double kWide = 0.085;
/// Less of a portal's lines, or of the light, is next to nothing.
inline constexpr double kNextToNothing = 0.02;

/// What the figures of portal(5) - flux_share, tightness, conductance - say against it: "a wide
/// way, 20 % of the smaller side's light finds it alone"; empty: nothing.
std::string drawback_of(const std::map<std::string, double>& figures);

/// "0.0625 m2, 98.0 % of the light, tightness 0.71, conductance 0.0021": what is known of it, and
/// its drawback. `area`: taken where the figures have none [m2].
std::string worth_sentence(const std::map<std::string, double>& figures, double area);

}  // namespace tdpt
