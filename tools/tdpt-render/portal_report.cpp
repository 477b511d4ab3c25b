#include "tools/tdpt-render/portal_report.h"

#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/formats/portal_worth.h"

namespace tdpt {
namespace {

constexpr size_t kMostSentences = 4;

// [m2]
double area_of(const Portal& portal) {
  double sum = 0;
  for (const auto& t : portal.triangles)
    sum += 0.5 * length(cross(portal.vertices[t[1]] - portal.vertices[t[0]],
                              portal.vertices[t[2]] - portal.vertices[t[0]]));
  return sum;
}

// What became of the samples of one portal, as shares.
struct Deeds {
  uint64_t samples = 0;
  double lit = 0;     // of the samples
  double energy = 0;  // of the picture's
  bool useless() const {
    return samples >= kEnoughSamples &&
           (energy < kNoEnergy || (energy < kLeastEnergy && lit < kLeastLit));
  }
};

Deeds deeds_of(size_t portal, const RenderResult& result) {
  Deeds d;
  if (portal >= result.tally.portals.size()) return d;
  const RenderTally::OfPortal& tally = result.tally.portals[portal];
  const auto& all = result.tally.energy;
  const double total = std::accumulate(all.begin(), all.end(), 0.0);
  d.samples = tally.drawn;
  if (tally.drawn > 0) d.lit = static_cast<double>(tally.lit) / static_cast<double>(tally.drawn);
  if (total > 0) d.energy = tally.energy / total;
  return d;
}

}  // namespace

std::vector<std::string> first_few(std::vector<std::string> sentences) {
  if (sentences.size() <= kMostSentences) return sentences;
  const size_t more = sentences.size() - (kMostSentences - 1);
  sentences.resize(kMostSentences - 1);
  sentences.push_back(fmt::format("and {} more portals", more));
  return sentences;
}

std::vector<std::string> promises(const std::vector<Portal>& portals) {
  std::vector<std::string> sentences;
  for (const Portal& p : portals)
    sentences.push_back(p.name + ": " + worth_sentence(p.figures, area_of(p)));
  return first_few(std::move(sentences));
}

std::vector<std::string> turnings(const std::vector<Portal>& portals,
                                  const std::vector<PortalWay>& ways) {
  std::vector<std::string> sentences;
  const auto say = [&](const PortalWay& w, const char* words) {
    sentences.push_back(portals[w.portal].name + ": " + words);
  };
  for (const PortalWay& w : ways) {
    const bool double_sided = portals[w.portal].both_ways;
    if (w.way == PortalWay::back && !double_sided)
      say(w, "its front faces the light, not the camera: turned round");
    else if (w.way == PortalWay::both && !double_sided)
      say(w, "light passes it both ways, so it works both ways");
    else if (w.way == PortalWay::back)
      say(w, "is double-sided, light passes it from its front to its back: works that way alone");
    else if (w.way == PortalWay::front && double_sided)
      say(w, "is double-sided, light passes it from its back to its front: works that way alone");
  }
  return first_few(std::move(sentences));
}

std::vector<std::string> disappointments(const std::vector<Portal>& portals,
                                         const RenderResult& result) {
  std::vector<std::string> sentences;
  for (size_t i = 0; i < portals.size(); ++i)
    if (const Deeds d = deeds_of(i, result); d.useless())
      sentences.push_back(fmt::format(
          "{} is useless: {:.2g} % of its {} samples joined a lamp with the camera, they "
          "brought {:.2g} % of the light",
          portals[i].name, 100 * d.lit, d.samples, 100 * d.energy));
  return first_few(std::move(sentences));
}

nlohmann::ordered_json portals_json(const std::vector<Portal>& portals,
                                    const RenderResult& result) {
  auto list = nlohmann::ordered_json::array();
  for (size_t i = 0; i < portals.size(); ++i) {
    const Deeds d = deeds_of(i, result);
    nlohmann::ordered_json entry{{"name", portals[i].name}, {"area", area_of(portals[i])}};
    for (const char* key : {"flux_share", "tightness", "conductance", "expected_gain"})
      if (const auto at = portals[i].figures.find(key); at != portals[i].figures.end())
        entry[key] = at->second;
    entry["samples"] = d.samples;
    entry["lit"] = d.lit;
    entry["energy"] = d.energy;
    entry["useless"] = d.useless() || verdict_of(portals[i].figures).worth == Worth::useless;
    list.push_back(std::move(entry));
  }
  return list;
}

}  // namespace tdpt
