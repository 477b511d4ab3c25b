#include "tools/tdpt-render/run/report.h"

#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/words.h"
#include "tools/tdpt-render/run/scene_cache.h"

namespace tdpt {
namespace {

using Json = nlohmann::ordered_json;

double total_energy(const RenderTally& tally) {
  return std::accumulate(tally.energy.begin(), tally.energy.end(), 0.0);
}

const char* words_of(PortalWay way) {
  constexpr std::array kWords{"as drawn", "from its back to its front",
                              "from its front to its back", "both ways", "left out"};
  return kWords[static_cast<size_t>(way)];
}

// What became of the samples of one portal.
Json portal_json(const Portal& portal, size_t i, const RenderResult& result) {
  const bool used = !portal.triangles.empty();
  Json j{{"name", portal.name}, {"area", used ? area_of(portal) : portal.figures.at("area")}};
  for (const char* key : {"flux_share", "tightness", "conductance"})
    if (const auto at = portal.figures.find(key); at != portal.figures.end()) j[key] = at->second;
  const std::vector<PortalWay>& ways = result.plan.explored.ways;
  if (i < ways.size()) j["way"] = words_of(ways[i]);
  const double total = total_energy(result.tally);
  RenderTally::OfPortal tally;
  if (i < result.tally.portals.size()) tally = result.tally.portals[i];
  const double lit =
      tally.drawn > 0 ? static_cast<double>(tally.lit) / static_cast<double>(tally.drawn) : 0;
  const double energy = total > 0 ? tally.energy / total : 0;
  j["samples"] = tally.drawn;
  j["lit"] = lit;
  j["energy"] = energy;
  j["useless"] = !used || (tally.drawn >= kEnoughSamples &&
                           (energy < kNoEnergy || (energy < kLeastEnergy && lit < kLeastLit)));
  return j;
}

// ---- The choice ----

Json pilot_json(const Plan& plan) {
  Json j{{"samples", plan.pilot_samples}, {"cpu", plan.pilot_cpu_seconds}};
  if (const Forecast& forecast = plan.forecast; forecast.portals_gain > 0) {
    j["portals_gain"] = forecast.portals_gain;
    j["portals_gain_interval"] = {forecast.gain_low, forecast.gain_high};
  }
  Json& candidates = j["candidates"] = Json::array();
  for (const CandidateEstimate& p : plan.forecast.estimates)
    candidates.push_back({{"integrator", p.integrator},
                          {"portals", p.with_portals},
                          {"relmse", p.relmse},
                          {"work", p.work},
                          {"cost", p.cost}});
  return j;
}

// "for the same noise bdpt would take 3.4 times as long": the best beside the chosen one.
std::string runner_up(const Forecast& forecast) {
  const std::vector<CandidateEstimate>& all = forecast.estimates;
  const CandidateEstimate* best = nullptr;
  for (size_t i = 0; i < all.size(); ++i)
    if (i != forecast.best && std::isfinite(all[i].cost) && (!best || all[i].cost < best->cost))
      best = &all[i];
  if (!best) return "all others miss light";
  const double times = best->cost / all[forecast.best].cost;
  if (times < 1.05) return best->integrator + " would do as well";
  return fmt::format("for the same noise {} would take {} times as long", best->integrator,
                     number_words(times, 2));
}

// "relmse 0.012, interval 0.011 0.014".
std::string text_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return number_words(value.get<double>(), 3);
  if (value.is_null()) return "none";
  if (!value.is_structured()) return value.dump();
  std::string text;
  for (const auto& [key, part] : value.items()) {
    if (part.is_array() && !part.empty() && part[0].is_object()) continue;  // told apart
    if (key == "name" || key == "integrator") continue;
    if (!text.empty()) text += value.is_object() ? ", " : " ";
    if (value.is_object()) text += key + " ";
    text += text_of(part);
  }
  return text;
}

bool is_black(const RenderResult& result) {
  return !result.plan.cut_short && result.nonzero() == 0;
}

}  // namespace

Json stats_of(const Job& job, const Integrator& asked, const std::vector<Portal>& portals,
              const RenderResult& result, const std::string& device) {
  const Plan& plan = result.plan;
  const auto numbers = [](const Vec3d& v) { return Json{v.x, v.y, v.z}; };
  Json j{{"integrator", asked.name}};
  if (job.automatic) {
    j["chosen"] = plan.label;
    if (plan.pilot_samples > 0) j["pilot"] = pilot_json(plan);
  }
  j["spp"] = result.spp();
  j["width"] = result.picture.width;
  j["height"] = result.picture.height;
  j["max_depth"] = nullptr;
  if (job.max_depth < kMaxDepth) j["max_depth"] = job.max_depth;
  j["seconds"] = result.progress->seconds;
  j["cpu_seconds"] = result.progress->cpu_seconds;
  j["device"] = device;
  j["mean"] = numbers(result.mean());
  j["nonzero"] = result.nonzero();
  if (result.target) j["target"] = target_json(*result.target, result.progress->error_pilot);
  if (const auto& noise = result.noise)
    j["noise"] = {{"relmse", noise->relmse}, {"interval", {noise->low, noise->high}}};
  const RayCounts& rays = result.tally.rays;
  j["rays"] = {{"closest", rays.closest}, {"shadow", rays.shadow}, {"portal", rays.portal}};
  const double total = total_energy(result.tally);
  Json& techniques = j["techniques"] = Json::object();
  for (size_t i = 0; i < kTechniques; ++i)
    if (asked.mixture.has(static_cast<Technique>(i)))
      techniques[kTechniqueNames[i]] = total > 0 ? result.tally.energy[i] / total : 0.0;
  Json& lengths = j["light_by_length"] = Json::array();
  for (const double light : result.tally.by_length)
    lengths.push_back(total > 0 ? light / total : 0.0);
  if (const auto& beyond = plan.explored.beyond)
    j["beyond"] = {{"depth", beyond->depth}, {"share", beyond->share}, {"error", beyond->error}};
  j["not_finite"] = result.tally.not_finite;
  for (size_t i = 0; i < portals.size(); ++i)
    j["portals"].push_back(portal_json(portals[i], i, result));
  for (const FrameRecord& f : result.frames)
    j["frames"].push_back({{"spp", f.spp},
                           {"nonzero", f.nonzero},
                           {"mean", numbers(f.mean)},
                           {"seconds", f.seconds},
                           {"cpu_seconds", f.cpu_seconds}});
  return j;
}

cli::Decisions decisions_of(const Json& stats) {
  cli::Decisions all;
  const auto add = [&](const std::string& name, const Json& value) {
    all.push_back({name, text_of(value), "", ""});
  };
  for (const auto& [key, value] : stats.items()) {
    if (key == "frames") continue;
    if (value.is_array() && !value.empty() && value[0].is_object()) {
      for (const Json& record : value) add(record["name"].get<std::string>(), record);
      continue;
    }
    add(key, value);
    if (key == "pilot")
      for (const Json& candidate : value["candidates"])
        add(candidate["integrator"].get<std::string>(), candidate);
  }
  return all;
}

std::string choice_sentence(const RenderResult& result, bool lit) {
  const Forecast& forecast = result.plan.forecast;
  const std::string chose = "rendering with " + result.plan.label;
  if (!lit) return chose + ": there is no light to choose by";
  if (!result.plan.is_new) return chose;
  if (forecast.estimates.empty())
    return chose + (result.progress->interrupted ? ": stopped before it could choose"
                                                 : ": the samples are too few to choose by");
  if (forecast.estimates.size() < 2 || !(forecast.estimates[forecast.best].cost > 0)) return chose;
  return chose + ": " + runner_up(forecast);
}

std::string verdict_sentence(const RenderResult& result) {
  const Forecast& forecast = result.plan.forecast;
  if (!(forecast.portals_gain > 0)) return "";
  // Where the interval holds 1 the pilot cannot be sure.
  const bool sure = forecast.gain_low > 1 || forecast.gain_high < 1;
  if (!forecast.estimates[forecast.best].with_portals)
    return fmt::format("portals {}do not pay in this view: rendering without them",
                       sure ? "" : "probably ");
  return fmt::format("portals {}pay in this view ({} times as fast, {} to {})",
                     sure ? "" : "probably ", number_words(forecast.portals_gain, 2),
                     number_words(forecast.gain_low, 2), number_words(forecast.gain_high, 2));
}

std::string length_sentence(const Job& job, const RenderResult& result) {
  if (const auto& beyond = result.plan.explored.beyond) return sentence(*beyond);
  const double total = total_energy(result.tally), last = result.tally.by_length.back();
  if (job.max_depth < kMaxDepth || !(last > 1e-4 * total)) return "";
  return fmt::format(
      "paths of {} to {} edges hold {} of the light; what longer ones hold is left out",
      kMaxDepth / 2 + 1, kMaxDepth, percent_words(last / total));
}

std::string way_sentence(const Portal& portal, PortalWay way) {
  if (way == PortalWay::left_out)
    return "no light passes " + portal.name + " on its way to the camera: left out";
  const PortalWay drawn = portal.both_ways ? PortalWay::both : PortalWay::front;
  if (way == PortalWay::as_drawn || way == drawn) return "";
  return fmt::format("{}: is drawn otherwise, but light passes it {}: works that way", portal.name,
                     words_of(way));
}

std::string idleness_sentence(const std::vector<Portal>& portals, const RenderResult& result) {
  if (!result.plan.integrator.mixture.has(Technique::portal)) return "";
  std::vector<std::string> names;
  for (size_t i = 0; i < portals.size(); ++i)
    if (!portals[i].triangles.empty() && portal_json(portals[i], i, result).at("useless"))
      names.push_back(portals[i].name);
  if (names.empty()) return "";
  return fmt::format("next to no light came through {}: of no use", fmt::join(names, ", "));
}

void report_before(const Job& job, const Vista& vista, const Integrator& asked,
                   const std::vector<Portal>& portals, const std::vector<PortalWay>& ways,
                   const cli::Common& common) {
  const Mixture& named = job.named.mixture;
  if (portals.empty() && (named.has(Technique::portal) || named.guiding != Guiding{}))
    common.warn("no portal is given, so no path is sampled through one");
  for (size_t i = 0; i < ways.size(); ++i)
    if (const std::string sentence = way_sentence(portals[i], ways[i]); !sentence.empty())
      common.note(sentence);
  if (const std::string missed = light_missed(asked, vista.world->scene); !missed.empty())
    common.warn(missed);
  if (vista.world->lights.empty())
    common.warn(
        "nothing in the scene emits light, expected an emissive surface, a lamp or an "
        "--environment: the picture is black");
  else if (!may_see_surfaces(vista))
    common.warn(std::string("no surface lies in the camera's view: the picture ") +
                (vista.world->scene.sky ? "shows the sky alone" : "is black"));
}

void report_choice(const Session& session, const RenderResult& result, const cli::Common& common) {
  if (const std::string verdict = verdict_sentence(result); !verdict.empty()) common.note(verdict);
  if (session.job.automatic) common.note(choice_sentence(result, !session.is_shorter()));
  for (const Tally::SamplePixel& place : result.tally.not_finite_at)
    common.warn(fmt::format(
        "pixel {} {} sample {}: a contribution was not finite, or beyond what a splat holds, and "
        "is left out",
        place.x, place.y, place.sample));
}

void report_after(const Session& session, const std::vector<Portal>& portals,
                  const RenderResult& result, const RenderArguments& a, const cli::Common& common) {
  const Progress& progress = *result.progress;
  // With less light to be found than that, the cause was named before.
  const bool black = is_black(result);
  if (black && !session.is_shorter() && !session.job.alpha && session.job.max_depth == kMaxDepth)
    common.warn("no sample found light: the picture is black; " + why_black(session.vista));
  if (const std::string idle = idleness_sentence(portals, result);
      !idle.empty() && !session.is_shorter())
    common.note(idle);
  common.note(fmt::format("{}: {} per pixel{} at {} x {} in {:.1f} s ({:.1f} CPU s)",
                          session.job.automatic ? result.plan.label : result.plan.integrator.name,
                          counted(result.spp(), "sample"), a.shard.empty() ? "" : " of the shard",
                          result.picture.width, result.picture.height, progress.seconds,
                          progress.cpu_seconds));
  if (progress.interrupted)
    common.note("stopped by a signal; the picture holds the samples named above");
  if (result.plan.cut_short && !(a.checkpoint.empty() && a.resume.empty()))
    common.note("not all was decided before the signal: no checkpoint is kept");
  if (result.target)
    common.note(target_sentence(*result.target, result.spp()));
  else if (!black && !result.plan.cut_short && (result.noise || !session.is_shorter()))
    common.note((a.filters() ? "before filtering " : "") +
                noise_sentence(result.noise, progress.seconds));
  if (const std::string length = length_sentence(session.job, result); !length.empty())
    common.note(length);
}

std::string outcome_words(const Vista& vista, const RenderResult& result) {
  std::string noise;
  if (is_black(result))
    noise = ", all black: " + why_black(vista);
  else if (result.noise)
    noise = ", " + words_of(*result.noise);
  return fmt::format("{} per pixel in {}{}", counted(result.spp(), "sample"),
                     duration_words(result.progress->seconds), noise);
}

}  // namespace tdpt
