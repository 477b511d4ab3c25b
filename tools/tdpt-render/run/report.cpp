#include "tools/tdpt-render/run/report.h"

#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/counted.h"
#include "libcommon/base/number_words.h"

#include "tools/tdpt-render/run/portal_report.h"
#include "tools/tdpt-render/run/target_report.h"

namespace tdpt {
namespace {

double total_energy(const RenderResult& result) {
  return std::accumulate(result.tally.energy.begin(), result.tally.energy.end(), 0.0);
}

nlohmann::ordered_json numbers(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

nlohmann::ordered_json pilot_json(const RenderResult& result) {
  nlohmann::ordered_json j{{"samples", result.pilot_samples}, {"cpu", result.pilot_cpu_seconds}};
  if (const auto& gain = result.forecast.portals) {
    j["portals_gain"] = gain->times;
    j["portals_gain_interval"] = {gain->low, gain->high};
  }
  auto& candidates = j["candidates"] = nlohmann::ordered_json::array();
  for (const CandidateEstimate& p : result.forecast.estimates)
    candidates.push_back({{"integrator", p.integrator},
                          {"portals", p.with_portals},
                          {"relmse", p.relmse},
                          {"work", p.work},
                          {"cost", p.cost}});
  return j;
}

nlohmann::ordered_json choice_json(const Integrator& integrator, const RenderResult& result) {
  nlohmann::ordered_json j;
  j["integrator"] = integrator.name;
  if (!result.chosen_label.empty()) {
    j["chosen"] = result.chosen_label;
    if (result.pilot_samples > 0) j["pilot"] = pilot_json(result);
  }
  return j;
}

nlohmann::ordered_json summary(const Integrator& integrator, const RenderSettings& settings,
                               const RenderResult& result, const std::vector<Portal>& portals) {
  nlohmann::ordered_json j = choice_json(integrator, result);
  j["spp"] = result.spp;
  j["width"] = result.picture.width;
  j["height"] = result.picture.height;
  j["max_depth"] = nullptr;
  if (settings.max_depth < kMaxDepth) j["max_depth"] = settings.max_depth;
  j["seconds"] = result.seconds;
  j["cpu_seconds"] = result.cpu_seconds;
  j["device"] = result.renderer;
  j["mean"] = numbers(result.mean());
  j["nonzero"] = result.nonzero();
  if (result.target) j["target"] = target_json(*result.target);
  if (const auto& noise = result.noise)
    j["noise"] = {{"relmse", noise->relmse}, {"interval", {noise->low, noise->high}}};
  const RayCounts& rays = result.tally.rays;
  j["rays"] = {{"closest", rays.closest}, {"shadow", rays.shadow}, {"portal", rays.portal}};
  const double total = total_energy(result);
  auto& techniques = j["techniques"] = nlohmann::ordered_json::object();
  for (size_t i = 0; i < kTechniques; ++i)
    if (integrator.mixture.has(static_cast<Technique>(i)))
      techniques[kTechniqueNames[i]] = total > 0 ? result.tally.energy[i] / total : 0.0;
  auto& lengths = j["light_by_length"] = nlohmann::ordered_json::array();
  for (const double light : result.tally.by_length)
    lengths.push_back(total > 0 ? light / total : 0.0);
  if (const auto& beyond = result.plan.beyond)
    j["beyond"] = {{"depth", beyond->depth}, {"share", beyond->share}, {"error", beyond->error}};
  j["not_finite"] = result.tally.not_finite;
  if (!portals.empty()) j["portals"] = portals_json(portals, result);
  return j;
}

// "for the same noise bdpt would take 3.4 times as long": the best beside the chosen one.
std::string runner_up(const RenderResult& result) {
  const std::vector<CandidateEstimate>& all = result.forecast.estimates;
  const CandidateEstimate* best = nullptr;
  for (size_t i = 0; i < all.size(); ++i)
    if (i != result.chosen && std::isfinite(all[i].cost) && (!best || all[i].cost < best->cost))
      best = &all[i];
  if (!best) return "all others miss light";
  const double times = best->cost / all[result.chosen].cost;
  if (times < 1.05) return best->integrator + " would do as well";
  return fmt::format("for the same noise {} would take {} times as long", best->integrator,
                     number_words(times, 2));
}

}  // namespace

std::string summary_json(const Integrator& integrator, const RenderSettings& settings,
                         const RenderResult& result, const std::vector<Portal>& portals) {
  return summary(integrator, settings, result, portals).dump();
}

std::string stats_json(const Integrator& integrator, const RenderSettings& settings,
                       const RenderResult& result, const std::vector<Portal>& portals,
                       const std::string& mark) {
  nlohmann::ordered_json j = summary(integrator, settings, result, portals);
  if (!mark.empty()) j["frame"] = mark;
  if (!result.frames.empty()) {
    auto& frames = j["frames"] = nlohmann::ordered_json::array();
    for (const FrameRecord& f : result.frames)
      frames.push_back({{"spp", f.spp},
                        {"nonzero", f.nonzero},
                        {"mean", numbers(f.mean)},
                        {"seconds", f.seconds},
                        {"cpu_seconds", f.cpu_seconds}});
  }
  return j.dump();
}

std::string plan_json(const RenderResult& decided, const std::vector<Portal>& portals) {
  nlohmann::ordered_json j = choice_json(decided.plan.integrator, decided);
  j["spp"] = decided.plan.spp;
  j["seconds"] = decided.seconds;
  j["cpu_seconds"] = decided.cpu_seconds;
  j["device"] = decided.renderer;
  if (portals.empty()) return j.dump();
  j["portals"] = portals_json(portals, decided);
  for (auto& portal : j["portals"])
    for (const char* of_samples : {"samples", "lit", "energy"}) portal.erase(of_samples);
  return j.dump();
}

std::string length_sentence(const RenderSettings& settings, const RenderResult& result) {
  if (result.plan.beyond) return sentence(*result.plan.beyond);
  const double total = total_energy(result), last = result.tally.by_length.back();
  if (settings.max_depth < kMaxDepth || !(last > 1e-4 * total)) return "";
  return fmt::format(
      "paths of {} to {} edges hold {} of the light; what longer ones hold is left out",
      kMaxDepth / 2 + 1, kMaxDepth, percent_words(last / total));
}

std::string choice_sentence(const RenderResult& result) {
  const std::vector<CandidateEstimate>& all = result.forecast.estimates;
  const std::string chose = "rendering with " + result.chosen_label;
  if (result.longest) return chose + ": there is no light to choose by";
  if (all.empty())
    return chose + (result.interrupted ? ": stopped before it could choose"
                                       : ": the samples are too few to choose by");
  if (all.size() < 2 || !(all[result.chosen].cost > 0)) return chose;
  return chose + ": " + runner_up(result);
}

std::string verdict_sentence(const RenderResult& result) {
  const std::optional<PortalsGain>& gain = result.forecast.portals;
  if (!gain) return "";
  const std::string times =
      fmt::format("({} times as fast, {} to {})", number_words(gain->times, 2),
                  number_words(gain->low, 2), number_words(gain->high, 2));
  // Where the interval holds 1 the pilot cannot be sure.
  const bool sure = gain->low > 1 || gain->high < 1;
  if (!result.forecast.estimates[result.chosen].with_portals)
    return fmt::format("portals {} not pay in this view {}: rendering without them",
                       sure ? "do" : "probably do", times);
  return fmt::format("portals {}pay in this view {}", sure ? "" : "probably ", times);
}

Picture nonzero_picture(const Picture& picture) {
  Picture marks{picture.width, picture.height, {}};
  marks.pixels.reserve(picture.pixels.size());
  for (const Rgb& p : picture.pixels)
    marks.pixels.push_back(p != Rgb{} ? Rgb{1, 0, 0} : Rgb{0, 1, 0});
  return marks;
}

std::map<std::string, std::string> exr_attributes(const Integrator& integrator,
                                                  const std::string& chosen,
                                                  const RenderSettings& settings,
                                                  const Provenance& provenance) {
  std::map<std::string, std::string> a;
  a["integrator"] = integrator.name;
  if (!chosen.empty()) a["chosen"] = chosen;
  a["maxDepth"] = settings.max_depth < kMaxDepth ? std::to_string(settings.max_depth) : "none";
  a["seed"] = std::to_string(settings.seed);
  a["mis"] = settings.beta == 1 ? "balance" : "power";
  a["pixelFilter"] = "box, one pixel wide";
  a["colorSpace"] = "scene-linear Rec.709";
  if (!provenance.empty())
    a[provenance_attribute] = fmt::format("{}", fmt::join(provenance.lines, "\n"));
  return a;
}

std::string with_option(const std::string& provenance, const std::string& tool,
                        const std::string& option) {
  const size_t at = provenance.rfind("made by " + tool + " ");
  if (at == std::string::npos) return provenance;
  std::string text = provenance;
  text.insert(std::min(text.find('\n', at), text.size()), " " + option);
  return text;
}

}  // namespace tdpt
