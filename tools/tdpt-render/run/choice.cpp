#include "tools/tdpt-render/run/choice.h"

#include <algorithm>

#include "libcommon/base/error.h"
#include "tools/tdpt-render/path/bsdf/surfaces.h"
#include "tools/tdpt-render/plan/exploration.h"
#include "tools/tdpt-render/plan/longest_path.h"
#include "tools/tdpt-render/portals/portal_fit.h"
#include "tools/tdpt-render/run/portal_report.h"

namespace tdpt {
namespace {

// The integrator with the numbers that were given, one at least.
Integrator guided_as_given(const Arguments& a, Integrator guided) {
  std::array<double, 2>& chance = guided.mixture.guiding.chance;
  if (a.guide_light >= 0) chance[0] = a.guide_light;
  if (a.guide_camera >= 0) chance[1] = a.guide_camera;
  if (a.segments >= 0) guided.mixture.segments = a.segments;
  if (a.light_walks >= 0) guided.mixture.light_walks = a.light_walks;
  return guided;
}

std::vector<Candidate> candidates_of(const Request& request, const World& world) {
  if (!request.automatic) return {{request.named, label_of(request.named)}};
  return auto_candidates(world, request.guided);
}

void tell_left_out(const World& world, const std::vector<Portal>& portals, const Known& known,
                   const cli::Common& common) {
  std::vector<std::string> names, suspicious;
  for (const PortalWay& w : known.ways) {
    if (w.way != PortalWay::left_out) continue;
    const Portal& portal = portals[w.portal];
    names.push_back(portal.name);
    if (const std::string unit = unit_words(portal, world.tracer, world.scene.frame); !unit.empty())
      suspicious.push_back(portal.name + " " + unit + ": left out");
  }
  if (!names.empty())
    common.note("no light passes " + names_of(names) + " on its way to the camera: left out");
  for (const std::string& sentence : first_few(suspicious)) common.warn(sentence);
}

void warn_of_no_portal(const Request& request, const World& world, const cli::Common& common) {
  const Mixture& named = request.named.mixture;
  if (world.portals.empty() && (named.has(Technique::portal) || named.guiding != Guiding{}))
    common.warn("no portal is given, so no path is sampled through one");
}

// Whether there is more to it than the camera's own ray.
bool is_sampled(const World& world, const RenderSettings& settings) {
  return longest_path(world, settings.max_depth, settings.alpha) == settings.max_depth;
}

bool goes_through_portals(const Request& request, const World& world) {
  const Mixture& named = request.named.mixture;
  return request.automatic || named.has(Technique::portal) || named.guiding != Guiding{} ||
         (named.looks_out() && !world.windows.empty());
}

// As they were seen to be of use.
void take_portals(const Known& known, World& world, std::vector<Portal>& portals,
                  const cli::Common& common) {
  tell_left_out(world, portals, known, common);
  for (const std::string& turning : turnings(portals, known.ways)) common.note(turning);
  apply_ways(known.ways, portals);
  world.fill_openings(PortalSet(portals, world.scene.frame));
}

// By power alone a sky outranks every lamp indoors.
bool competes_with_sky(const World& world) {
  return world.lights.sky() && world.lights.shares().sky < 1;
}

// Throws InputError where a plan chooses a kind of light never that there is, or one that is not.
void check_kinds(const Lights::KindProbabilities& planned, const Lights::KindProbabilities& there,
                 const std::string& file) {
  const auto same = [](double a, double b) { return (a > 0) == (b > 0); };
  if (!same(planned.surfaces, there.surfaces) || !same(planned.lamps, there.lamps) ||
      !same(planned.parallel, there.parallel) || !same(planned.sky, there.sky))
    throw InputError(file, "surfaces", "and the other shares are of other lights");
}

void find_candidates(const Request& request, const World& world, Choice& choice) {
  choice.candidates = candidates_of(request, world);
  choice.integrator = request.named;
  if (request.automatic) choice.integrator = either_of(choice.candidates);
}

void warn_of_missing_light(const Choice& choice, const World& world, const cli::Common& common) {
  if (const std::string missed = light_missed(choice.integrator, world.scene); !missed.empty())
    common.warn(missed);
  if (world.lights.empty())
    common.warn(
        "nothing in the scene emits light, expected an emissive surface, a lamp or an "
        "--environment: the picture is black");
  else if (!may_see_surfaces(world))
    common.warn(std::string("no surface lies in the camera's view: the picture ") +
                (world.scene.sky ? "shows the sky alone" : "is black"));
}

}  // namespace

Request request_of(const Arguments& a) {
  Request request;
  request.automatic = a.integrator == "auto";
  request.named = request.automatic ? bdpt : integrator_named(a.integrator);
  if (a.guide_light < 0 && a.guide_camera < 0 && a.segments < 0 && a.light_walks < 0)
    return request;
  const Integrator& row = request.automatic ? tdpt_guided : request.named;
  const auto refuse = [&](const char* option, const char* what) {
    throw UsageError(std::string(option) + ": " + row.name + " " + what);
  };
  if (a.guide_light >= 0 && !row.mixture.techniques.walks_from_light())
    refuse("--set guide-light", "has no walks from the light");
  if (a.light_walks >= 0 && !row.mixture.techniques.walks_from_light())
    refuse("--set light-walks", "has no walks from the light");
  if (a.segments >= 0 && !row.mixture.has(Technique::portal))
    refuse("--set segments", "draws no portal segments");
  request.guided = guided_as_given(a, row);
  if (!request.automatic) request.named = request.guided;
  return request;
}

Choice choose(const Request& request, const RenderSettings& settings, const Camera& camera,
              World& world, std::vector<Portal>& portals, const cli::Common& common) {
  surfaces();  // whoever renders needs their tables: they are none of the exploration's price
  Choice choice;
  warn_of_no_portal(request, world, common);
  const bool sampled = is_sampled(world, settings);
  choice.probed = sampled && goes_through_portals(request, world);
  choice.by_arrival = sampled && competes_with_sky(world);
  const bool asks_for_depth = sampled && settings.max_depth < kMaxDepth;
  const std::vector<Portal> probed = choice.probed ? portals : std::vector<Portal>();
  if (!probed.empty() || choice.by_arrival || asks_for_depth) {
    const double share = request.automatic ? kShareBesidePilot : kShareAlone;
    const double samples = std::clamp(share * samples_foreseen(settings, world.film),
                                      kExplorationFewest, kExplorationEnough);
    const Explored explored =
        explore(world, camera, probed, settings.max_depth, settings.seed, samples);
    choice.phases.done("exploration");
    static_cast<Known&>(choice) = {explored.ways, explored.beyond};
    choice.explored = explored.samples;
    if (choice.by_arrival) world.lights.choose_by(explored.arriving);
    if (!choice.ways.empty()) take_portals(choice, world, portals, common);
  }
  find_candidates(request, world, choice);
  warn_of_missing_light(choice, world, common);
  return choice;
}

Choice choose_as_planned(const Plan& plan, const std::string& file, const Request& request,
                         const RenderSettings& settings, World& world, std::vector<Portal>& portals,
                         const cli::Common& common) {
  Choice choice;
  warn_of_no_portal(request, world, common);
  const bool sampled = is_sampled(world, settings);
  if (sampled && goes_through_portals(request, world)) {
    for (const PortalWay& way : plan.ways)
      if (way.portal >= portals.size())
        throw InputError(file, "portals", "speak of one that there is not");
    choice.ways = plan.ways;
    choice.probed = true;
    take_portals(choice, world, portals, common);
  }
  choice.by_arrival = sampled && competes_with_sky(world);
  if (choice.by_arrival) {
    check_kinds(plan.lights, world.lights.shares(), file);
    world.lights.choose_by(plan.lights);
  }
  choice.beyond = plan.beyond;
  choice.planned = true;
  find_candidates(request, world, choice);
  warn_of_missing_light(choice, world, common);
  return choice;
}

Choice choose_for_frame(Plan& plan, const Request& request, const RenderSettings& settings,
                        const Camera& camera, World& world, std::vector<Portal>& portals,
                        const cli::Common& common) {
  Choice choice = choose(request, settings, camera, world, portals, common);
  choice.planned = true;
  plan.ways = choice.ways;
  plan.lights = world.lights.shares();
  plan.beyond = choice.beyond;
  const bool is_there = std::any_of(choice.candidates.begin(), choice.candidates.end(),
                                    [&](const Candidate& c) { return c.label == plan.label; });
  if (is_there || !request.automatic) return choice;
  const Candidate first =
      expecting_connections(world, {choice.candidates.front()}, settings.max_depth).front();
  plan.integrator = first.integrator;
  plan.label = first.label;
  return choice;
}

}  // namespace tdpt
