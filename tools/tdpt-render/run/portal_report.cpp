#include "tools/tdpt-render/run/portal_report.h"

#include <cmath>
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

std::vector<std::string> descriptions(const std::vector<Portal>& portals) {
  std::vector<std::string> sentences;
  for (const Portal& p : portals) {
    if (p.triangles.empty()) continue;
    std::string text = fmt::format("{}: {} m2", p.name, number_words(area_of(p), 4));
    if (const auto c = p.figures.find("conductance"); c != p.figures.end())
      text += fmt::format(", conductance {}", number_words(c->second, 2));
    if (const auto light = p.figures.find(kLight); light != p.figures.end())
      text += fmt::format(", {} of the light passed it on the way to what the camera sees",
                          percent_words(light->second, 3));
    sentences.push_back(text);
  }
  return first_few(std::move(sentences));
}

std::string left_out(const Portal& portal, const PortalLight& light) {
  return fmt::format(
      "{}: {} of a small picture's light passed it on the way to the camera ({} of {} "
      "samples): left out",
      portal.name, percent_words(light.share), light.samples, light.of);
}

namespace {

// None where no portal has the figure.
const Portal* with_most(const std::vector<Portal>& portals, const char* figure) {
  const Portal* most = nullptr;
  for (const Portal& p : portals)
    if (const auto at = p.figures.find(figure);
        at != p.figures.end() && (!most || at->second > most->figures.at(figure)))
      most = &p;
  return most;
}

}  // namespace

std::string idleness(const std::vector<Portal>& portals, double share) {
  const std::string brought =
      fmt::format("segments through portals brought {} of the light", percent_words(share));
  if (const Portal* p = with_most(portals, kLight))
    return brought + fmt::format("; in a small picture before, {} passed {}",
                                 percent_words(p->figures.at(kLight)), p->name);
  if (const Portal* p = with_most(portals, "flux_share"))
    return brought + fmt::format("; of that which crosses the cut {} passes {}, says its file",
                                 percent_words(p->figures.at("flux_share")), p->name);
  return "the portals brought less than 1 % of the light: do they lie on its way?";
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

std::vector<std::string> useless_portals(const std::vector<Portal>& portals,
                                         const RenderResult& result) {
  std::vector<std::string> sentences;
  for (size_t i = 0; i < portals.size(); ++i)
    if (const PortalStatistics d = portal_statistics_of(i, result); d.useless())
      sentences.push_back(
          fmt::format("{} is useless: {} of its {} connected a lamp with the camera, they "
                      "brought {} of the light",
                      portals[i].name, percent_words(d.lit), counted(d.samples, "sample"),
                      percent_words(d.energy)));
  return first_few(std::move(sentences));
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
    for (const char* key : {"flux_share", "tightness", "conductance", kLight})
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
