// The figures of portals in words. They are measured with rays and are no promise: only a rendering
// shows what a portal gains for a picture.
#pragma once
#include <map>
#include <string>

namespace tdpt {

/// Above this conductance of the cut, light finds its way without a portal.
inline constexpr double kWide = 0.085;
/// Shares of a portal's lines below this are negligible.
inline constexpr double kNextToNothing = 0.02;

/// What the figures of portal(5) - tightness, conductance - say against a portal: "a
/// wide way, 20 % of the smaller side's light finds it alone"; empty: nothing.
std::string drawback_of(const std::map<std::string, double>& figures);

/// "0.0625 m2, tightness 0.71, conductance 0.0021": the known figures and the
/// drawback. `area`: used if the figures have none [m2].
std::string worth_sentence(const std::map<std::string, double>& figures, double area);

}  // namespace tdpt
