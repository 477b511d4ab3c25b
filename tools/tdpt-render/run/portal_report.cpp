#include "tools/tdpt-render/run/portal_report.h"

#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/counted.h"
#include "libcommon/base/number_words.h"

namespace tdpt {
namespace {

constexpr size_t kMostSentences = 4;

// What became of the samples of one portal, as shares.
struct PortalStatistics {
  uint64_t samples = 0;
  double lit = 0;     // of the samples
  double energy = 0;  // of the picture's
  bool useless() const {
    return samples >= kEnoughSamples &&
           (energy < kNoEnergy || (energy < kLeastEnergy && lit < kLeastLit));
  }
};

PortalStatistics portal_statistics_of(size_t portal, const RenderResult& result) {
  PortalStatistics d;
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

std::string names_of(const std::vector<std::string>& names) {
  if (names.size() <= kMostSentences) return fmt::format("{}", fmt::join(names, ", "));
  const size_t named = kMostSentences - 1;
  return fmt::format(
      "{} and {} more",
      fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(named), ", "),
      names.size() - named);
}

std::string idleness(double share) {
  return fmt::format("paths that begin in the portals brought {} of the light",
                     percent_words(share));
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

std::string useless_portals(const std::vector<Portal>& portals, const RenderResult& result) {
  std::vector<std::string> names;
  for (size_t i = 0; i < portals.size(); ++i)
    if (portal_statistics_of(i, result).useless()) names.push_back(portals[i].name);
  if (names.empty()) return "";
  return "next to no light came through " + names_of(names) + ": " +
         (names.size() == 1 ? "it was" : "they were") + " of no use";
}

std::string useless_portal(const std::vector<Portal>& portals, size_t portal,
                           const RenderResult& result) {
  const PortalStatistics d = portal_statistics_of(portal, result);
  if (!d.useless() || portals.size() <= portal) return "";
  return fmt::format("{} of its {} connected a lamp with the camera, they brought {} of the light",
                     percent_words(d.lit), counted(d.samples, "sample"), percent_words(d.energy));
}

nlohmann::ordered_json portals_json(const std::vector<Portal>& portals,
                                    const RenderResult& result) {
  auto list = nlohmann::ordered_json::array();
  for (size_t i = 0; i < portals.size(); ++i) {
    const PortalStatistics d = portal_statistics_of(i, result);
    const bool used = !portals[i].triangles.empty();
    nlohmann::ordered_json entry{
        {"name", portals[i].name},
        {"area", used ? area_of(portals[i]) : portals[i].figures.at("area")}};
    for (const char* key : {"flux_share", "tightness", "conductance"})
      if (const auto at = portals[i].figures.find(key); at != portals[i].figures.end())
        entry[key] = at->second;
    entry["samples"] = d.samples;
    entry["lit"] = d.lit;
    entry["energy"] = d.energy;
    entry["useless"] = d.useless() || !used;
    list.push_back(std::move(entry));
  }
  return list;
}

}  // namespace tdpt
