#include "tools/tdpt-render/run/explain.h"

#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "libcommon/base/counted.h"
#include "libcommon/base/number_words.h"
#include "libcommon/scene/uses.h"
#include "tools/tdpt-render/run/portal_report.h"

namespace tdpt {
namespace {

using cli::Decision;
using cli::Decisions;

void append(Decisions& all, Decisions more) {
  all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

// No light arrives except along the camera's own ray.
constexpr const char* kNothingBeyond = "no path beyond the camera's ray can bring light";

Decision rect_lights(const Rendered& r) {
  const size_t n = r.world.next_events.rect_lights().size();
  if (n > 0)
    return {"rectangular lights", "used",
            fmt::format("{} flat rectangles are all that emits: next events choose among them by "
                        "what arrives",
                        n),
            "four corners looked at for each rectangular light and next event"};
  return {
      "rectangular lights", "left out",
      fmt::format("the surfaces that emit are not one big rectangle or 2 to {}", kMostRectLights),
      "next events draw by power alone"};
}

Decision windows(const Rendered& r) {
  if (r.result.longest) return {"windows", "left out", kNothingBeyond, "no next event is made"};
  const size_t n = r.world.windows.windows().size();
  if (n > 0)
    return {"windows", "used", fmt::format("{} facets of portals show the sky", n),
            "each next event towards the sky looks through them"};
  return {"windows", "left out",
          r.world.scene.sky ? "no portal shows the sky" : "there is no sky to look for",
          "no summed-area table is made"};
}

// CPU time, and its share of the rendering if there is one.
std::string price_in(double cpu_seconds, const Rendered& r) {
  if (r.result.spp == 0) return cli::price_of(cpu_seconds);
  return cli::price_of(cpu_seconds) + ", " +
         percent_words(cpu_seconds / std::max(r.result.cpu_seconds, 1e-9)) + " of the rendering";
}

Decision exploration(const Rendered& r) {
  if (r.choice.explored == 0)
    return {"exploration", "left out",
            r.choice.planned ? "a plan says what it would tell" : "nothing hangs on it",
            "no sample is thrown away"};
  double cpu = 0;
  for (const Phases::Phase& p : r.choice.phases.all()) cpu += p.cpu_seconds;
  return {"exploration", counted(r.choice.explored, "sample") + " drawn",
          "they tell which portals the light passes, which kinds of light arrive, and what a limit "
          "of depth leaves out",
          price_in(cpu, r)};
}

// How a kind of light is selected.
Decision kinds_of_light(const Rendered& r) {
  if (r.result.longest)
    return {"kinds of light", "none chosen", kNothingBeyond, "nothing is measured"};
  const Lights::KindProbabilities s = r.world.lights.shares();
  const std::string shares = fmt::format("surfaces {}, lamps {}, parallel light {}, the sky {}",
                                         number_words(s.surfaces, 2), number_words(s.lamps, 2),
                                         number_words(s.parallel, 2), number_words(s.sky, 2));
  if (r.choice.by_arrival)
    return {"kinds of light", r.choice.planned ? "chosen as planned" : "chosen by what arrives",
            "by power a sky would outrank every lamp indoors: " + shares,
            r.choice.planned ? "nothing is measured" : "measured by the exploration"};
  return {"kinds of light", "chosen by power", "no sky stands beside other lights: " + shares,
          "nothing is measured"};
}

std::string way_words(PortalWay::Way way) {
  switch (way) {
    case PortalWay::as_drawn:
      return "used as drawn";
    case PortalWay::front:
      return "used from its back to its front";
    case PortalWay::back:
      return "used from its front to its back";
    case PortalWay::both:
      return "used both ways";
    case PortalWay::left_out:
      return "left out";
  }
  return "";
}

Decisions portals(const Rendered& r) {
  if (r.portals.empty())
    return {
        {"portals", "left out", "none is given that can be used", "no edge is tested against any"}};
  if (r.result.longest) return {{"portals", "left out", kNothingBeyond, "no segment is drawn"}};
  if (!r.choice.probed)
    return {{"portals", "left out", fmt::format("{} goes through none", r.choice.integrator.name),
             "nothing is measured"}};
  Decisions all;
  if (r.choice.planned)
    all.push_back(
        {"portals", "as planned", "a plan tells which way each works", "nothing is measured"});
  else
    all.push_back(
        {"portals", "looked at",
         fmt::format("a small picture tells which of the {} the light passes, and which way",
                     r.portals.size()),
         "measured by the exploration"});
  for (const PortalWay& w : r.choice.ways) {
    const Portal& portal = r.portals[w.portal];
    all.push_back(
        {portal.name, way_words(w.way),
         r.choice.planned ? "the plan says so" : "the small picture's light says so",
         w.way == PortalWay::left_out
             ? "no edge is tested against it"
             : "each edge is tested against " + counted(portal.triangles.size(), "triangle")});
  }
  return all;
}

// What the portals are worth, and of each that was of no use why.
Decisions worth_of_portals(const Rendered& r) {
  Decisions all;
  if (const std::optional<PortalsGain>& gain = r.result.forecast.portals) {
    const auto& estimates = r.result.forecast.estimates;
    all.push_back(
        {"worth of portals", estimates[r.result.chosen].with_portals ? "used" : "not used",
         fmt::format("{} has {} times, {} to {}, the efficiency of {}, the best without them",
                     estimates[gain->with].integrator, number_words(gain->times, 2),
                     number_words(gain->low, 2), number_words(gain->high, 2),
                     estimates[gain->without].integrator),
         "measured by the pilot"});
  }
  for (size_t i = 0; i < r.portals.size(); ++i)
    if (const std::string why = useless_portal(r.portals, i, r.result); !why.empty())
      all.push_back({r.portals[i].name, "useless", why, ""});
  return all;
}

Decision pilot(const Rendered& r) {
  if (r.choice.candidates.size() < 2)
    return {"pilot", "left out",
            r.request.automatic ? "there is one candidate only" : "the integrator is named",
            "no sample is thrown away"};
  if (r.choice.planned)
    return {"pilot", "left out", "a plan says who renders", "no sample is thrown away"};
  if (r.result.longest) return {"pilot", "left out", kNothingBeyond, "no sample is thrown away"};
  if (r.result.forecast.estimates.empty())
    return {"pilot", "left out", "the samples asked for cannot spare the fewest that tell anything",
            "the first candidate renders"};
  return {
      "pilot", counted(r.result.pilot_samples, "sample") + " drawn",
      fmt::format("auto weighs {} candidates by what they would find", r.choice.candidates.size()),
      price_in(r.result.pilot_cpu_seconds, r)};
}

// Why the candidate rendered or did not.
std::string why(const Rendered& r, size_t i) {
  const std::vector<CandidateEstimate>& all = r.result.forecast.estimates;
  const CandidateEstimate &p = all[i], &chosen = all[r.result.chosen];
  if (!std::isfinite(p.cost)) return "it misses light that others found";
  if (i == r.result.chosen) return "it is likely to take the least time for the same noise";
  if (!(chosen.cost > 0)) return "no error showed";
  return fmt::format("for the same noise it would take about {} times as long",
                     number_words(p.cost / chosen.cost, 2));
}

Decisions candidates(const Rendered& r) {
  Decisions all;
  if (!r.request.automatic) return all;
  for (const Candidate& c : possible_candidates(r.world))
    if (const std::string missed = light_missed(c.integrator, r.world.scene); !missed.empty())
      all.push_back({c.label, "not weighed", missed, "no work"});
  for (size_t i = 0; i < r.result.forecast.estimates.size(); ++i) {
    const CandidateEstimate& p = r.result.forecast.estimates[i];
    all.push_back({p.integrator, i == r.result.chosen ? "chosen" : "refused", why(r, i),
                   fmt::format("relMSE {} x {} us a sample", number_words(p.relmse),
                               number_words(1e-3 * p.work))});
  }
  if (r.world.portals.empty())
    all.push_back({"integrators with portals", "not weighed", "no portal can be used", "no work"});
  return all;
}

Decisions techniques(const Rendered& r) {
  const Integrator& ran = r.result.plan.integrator;
  const auto& energy = r.result.tally.energy;
  const double total = std::accumulate(energy.begin(), energy.end(), 0.0);
  Decisions all;
  for (size_t i = 0; i < kTechniques; ++i) {
    const bool worth = !r.result.longest || static_cast<int>(i) < *r.result.longest;
    const bool has = worth && ran.mixture.has(static_cast<Technique>(i));
    all.push_back(
        {fmt::format("technique {}", kTechniqueNames[i]), has ? "run" : "left out",
         worth ? fmt::format("{} {}", r.result.plan.label, has ? "combines it" : "does without")
               : "no path that it makes can bring light",
         has ? fmt::format("brought {:.1f} % of the light",
                           total > 0 ? 100 * energy[i] / total : 0.0)
             : ""});
  }
  return all;
}

Decisions outputs(const Rendered& r) {
  const RenderSettings& s = r.settings;
  const auto asked = [](const char* what, bool done, const char* option, const char* price) {
    return Decision{what, done ? "made" : "left out",
                    fmt::format("{} is {}", option, done ? "given" : "not given"),
                    done ? price : "no memory, no sums"};
  };
  return {asked("layers", s.layers, "--layers", "a sum more for each contribution"),
          asked("frames", s.frames, "--stats", "measured aside, not in the times given"),
          asked("alpha", s.alpha, "--alpha", "a count for each sample")};
}

Decision depth(const Rendered& r) {
  if (r.result.longest)
    return {"length of paths", r.result.longest == 0 ? "nothing sampled" : "camera rays only",
            r.world.lights.empty() ? "nothing emits light" : "no surface lies in the camera's view",
            "no path beyond is traced"};
  if (r.settings.max_depth >= kMaxDepth)
    return {"length of paths", "not limited", "--max-depth is not given",
            "Russian roulette ends walks"};
  return {"length of paths", fmt::format("{} edges at most", r.settings.max_depth),
          "--max-depth says so",
          r.result.plan.beyond ? fmt::format("leaves out about {} of the light",
                                             percent_words(r.result.plan.beyond->share))
                               : "what that leaves out is not known"};
}

Decision error_pilot(const Rendered& r) {
  const TargetOutcome& target = *r.result.target;
  if (target.pilot_samples == 0)
    return {"error pilot", "left out", target.dark ? kNothingBeyond : "a limit came before it",
            "no sample is thrown away"};
  return {"error pilot", fmt::format("{} samples a pixel drawn", target.pilot_samples),
          target.fixed > 0 ? fmt::format("they tell that {} take the relMSE to {}", target.fixed,
                                         number_words(target.error))
                           : "no light was met, or a limit came first",
          cli::price_of(target.pilot_cpu_seconds)};
}

std::string why_so_many(const Rendered& r) {
  if (r.result.longest == 0) return "each is black, and none is traced";
  if (r.result.interrupted) return "a signal ended the rendering";
  if (r.result.render_state && r.result.render_state->whole > 0) return "the shard has so many";
  if (r.settings.spp > 0 && r.result.spp >= r.settings.spp) return "so many were asked for";
  if (r.settings.fixed && !r.result.target) return "--time allows so many, by the plan";
  using Stop = TargetOutcome::Stop;
  if (!r.result.target || r.result.target->stop == Stop::time) return "--time was up";
  return r.result.target->stop == Stop::unlit ? "the pilot, of as many, met no light"
         : r.result.target->retried           ? "the pilot fixed fewer, and --set retry so many"
                                              : "the pilot fixed so many";
}

Decision samples_planned(const Rendered& r) {
  const RenderSettings& s = r.settings;
  const uint64_t spp = r.result.plan.spp;
  const char* const why = r.result.longest == 0         ? "each is black, and none is traced"
                          : s.spp > 0 && spp == s.spp   ? "so many were asked for"
                          : !r.result.target            ? "--time allows so many"
                          : r.result.target->fixed == 0 ? "the pilot, of as many, met no light"
                                                        : "the pilot fixed so many";
  return {"samples", fmt::format("{} a pixel to come", spp), why,
          cli::price_of(r.result.cpu_seconds) + " so far"};
}

Decisions decisions_of_integrator(const Rendered& r) {
  Decisions all = uses_of(r.world.scene, all_needs());
  all.push_back(rect_lights(r));
  all.push_back(exploration(r));
  append(all, portals(r));
  all.push_back(windows(r));
  all.push_back(kinds_of_light(r));
  all.push_back(pilot(r));
  append(all, candidates(r));
  append(all, worth_of_portals(r));
  return all;
}

Decision samples(const Rendered& r) {
  const RayCounts& rays = r.result.tally.rays;
  return {"samples", fmt::format("{} a pixel", r.result.spp), why_so_many(r),
          fmt::format("{}; {} closest, {} shadow, {} portal rays",
                      cli::price_of(r.result.cpu_seconds), rays.closest, rays.shadow, rays.portal)};
}

}  // namespace

Decisions decisions_of(const Rendered& r) {
  Decisions all = decisions_of_integrator(r);
  append(all, techniques(r));
  append(all, outputs(r));
  all.push_back(depth(r));
  if (r.result.target) all.push_back(error_pilot(r));
  all.push_back(samples(r));
  return all;
}

Decisions decisions_of_plan(const Rendered& r) {
  Decisions all = decisions_of_integrator(r);
  if (r.result.target) all.push_back(error_pilot(r));
  all.push_back(samples_planned(r));
  return all;
}

}  // namespace tdpt
