// What a portal is worth: the gain in efficiency, 1 / (relMSE x CPU time), that a portal's figures
// let expect of rendering with it, before anything is rendered.
//
// Method: a model of the variance under the balance heuristic with three constants fitted to
// measurements, good to a factor of two (doc/portal-worth.md).
//
// G    expected gain of tdpt-org over bdpt
// c    conductance of the cut less its leaks: share of the smaller side's light that crosses
// S    share of the cut's light that the portals cover (kStrays aside)
// t    tightness: share of a portal's lines that pass to the other side
// g_0  time of a sample without portals to that of one with them
//
// A path of bidirectional path tracing gets through the opening by luck, with a density that falls
// with c; a portal's segment always lies in it, and joins the two sides with probability t. Under
// the balance heuristic the densities of techniques add, so the light that the portals cover costs
// 1 / (1 + (c_0 t / c)^p) of what it did, and the rest what it did:
//   G = g_0 / (1 - S + S / (1 + (c_0 t / c)^p)).
// p would be 1 if every path had to find the way through in one stroke; light that lamps throw
// straight through, and walks that pass by themselves, soften it. g_0, c_0 and p are measured.
#pragma once
#include <map>
#include <string>

namespace tdpt {

/// The share of the lines that may be leaks and strays instead of light: so much of it may be
/// missing and S is 1 all the same.
inline constexpr double kStrays = 0.15;

/// Gain G, ratio of efficiencies 1 / (relMSE x CPU time) of tdpt-org and bdpt; shares are clamped
/// to 0..1, a conductance of 0 counts as 1e-9.
double expected_gain(double share, double tightness, double conductance);

/// Below the first a portal is useless, below the second it gains little.
inline constexpr double kNoGain = 1.1, kLittleGain = 1.5;
/// Less of the light, or of a portal's lines, is next to nothing.
inline constexpr double kNextToNothing = 0.1, kFewLines = 0.02;

enum class Worth { unknown, useful, little, useless };
struct Verdict {
  Worth worth;
  std::string words;  ///< "useful", "little gain", "useless: <reason>", "worth unknown: <reason>"
};
/// From the figures of portal(5): flux_share, tightness, conductance, expected_gain.
Verdict verdict_of(const std::map<std::string, double>& figures);

/// "0.0625 m2, 98 % of the light, tightness 0.71, expected gain 2.7: useful" - what is known of it.
/// `area`: taken where the figures have none [m2].
std::string worth_sentence(const std::map<std::string, double>& figures, double area);

}  // namespace tdpt
