// regret_bench SCENE PORTAL... : what `auto` loses by not knowing which integrator is best: the
// true error x work of each, from pictures against a converged one, and what is chosen from few
// samples, and its cost. bench/promises.py makes tables of the lines.
//   --width W --height H --seconds T   default 96 72 2, CPU seconds for the truth of each
//                                      integrator, at most four times as many where its error is
//                                      not known to a fifth by then, and twelve times as many for
//                                      the converged picture; 0: no truth
//   --seeds N                          pictures of each length, default 8
//   --lengths N,N...                   samples per pixel, default 4,8,16,32,64,256
//   --depth N --camera NAME --environment FILE
//                                      as in tdpt-render, default no limit, the first and none
//   --name NAME                        of the scene, for the output
//
//   truth  SCENE INTEGRATOR  relMSE of a sample, its standard error, CPU ns of a sample, ns by the
//                            work model
//   told   SCENE SPP SEED INTEGRATOR  relMSE and work of a sample, as a pilot estimates them
//   choice SCENE SPP SEED INTEGRATOR  that was chosen, CPU s of the pilot, its groups; pixels; the
//                                     gain by portals and its interval
#include <cmath>

#include "libcommon/base/process.h"
#include "libcommon/options/sky_options.h"
#include "tools/tdpt-render/bench/bench_main.h"
#include "tools/tdpt-render/plan/exploration.h"
#include "tools/tdpt-render/plan/work_model.h"
#include "tools/tdpt-render/testing/rendering.h"

namespace tdpt {
namespace {

constexpr size_t kPictures = 8, kMostPictures = 32;  // of each integrator
constexpr double kKnown = 0.2;       // relative error from which on its error is known
constexpr double kOfReference = 12;  // its time, in that of an integrator

struct Settings {
  int width = 96, height = 72, seeds = 8, depth = kMaxDepth;
  double seconds = 2;
  std::vector<std::string> lengths{"4", "8", "16", "32", "64", "256"};
  std::string camera, environment;
  std::string name;  // of the scene in the output; empty: its file
};

// Pictures of one integrator, all of equally many samples.
struct Pictures {
  uint64_t spp = 0;
  double cpu_seconds = 0;
  double work = 0;  // of a sample, by the work model [ns]
  std::vector<std::vector<double>> luminance;
};

void render_one(const Vista& vista, const Integrator& integrator, uint64_t spp, uint64_t seed,
                int depth, Pictures& pictures) {
  Job how;
  how.max_depth = depth;
  how.limits.spp = spp;
  how.seed = seed;
  how.quiet = true;
  const RenderResult r = render(vista, integrator, how);
  pictures.spp = spp;
  pictures.cpu_seconds += r.progress->cpu_seconds;
  pictures.work =
      sample_work(vista, integrator.mixture, work_costs(vista, integrator.mixture, false),
                  r.tally.rays, spp * r.picture.pixels.size());
  std::vector<double>& l = pictures.luminance.emplace_back();
  for (const Rgb& p : r.picture.pixels) l.push_back(luminance(p));
}

// relMSE of one sample, its mean over pictures and that mean's standard error.
struct TrueError {
  double mean = 0, error = 0;
};

// Each picture against the reference. A mean of the pictures themselves would not do: a bright
// sample in it would pass for brightness, and noisy integrators would look better than they are.
TrueError error_of(const Pictures& p, const std::vector<double>& reference) {
  double mean = 0;
  for (const double r : reference) mean += r / static_cast<double>(reference.size());
  const auto n = static_cast<double>(p.luminance.size());
  double sum = 0, squares = 0;
  for (const auto& l : p.luminance) {
    double relmse = 0;
    for (size_t k = 0; k < l.size(); ++k)
      relmse += (l[k] - reference[k]) * (l[k] - reference[k]) /
                (reference[k] * reference[k] + 0.01 * mean * mean);
    relmse *= static_cast<double>(p.spp) / static_cast<double>(l.size());
    sum += relmse;
    squares += relmse * relmse;
  }
  const double m = sum / n;
  return {m, std::sqrt(std::max(squares / n - m * m, 0.0) / (n - 1))};
}

// By the candidate that a pilot thinks best, which need not be it.
std::vector<double> reference_of(const Vista& vista, const std::vector<Candidate>& candidates,
                                 const Settings& s) {
  SampleRules rules;
  rules.max_depth = s.depth;
  rules.seed = 3000;
  Pilot pilot(vista, candidates, rules);
  Film film(s.width, s.height, vista.world->lights.power());
  pilot.draw(2048, film);
  const Integrator& best = candidates[pilot.forecast().best].integrator;
  Pictures few, many;
  render_one(vista, best, 4, 3000, s.depth, few);
  render_one(vista, best, static_cast<uint64_t>(4 + 4 * kOfReference * s.seconds / few.cpu_seconds),
             3001, s.depth, many);
  return many.luminance[0];
}

// For the candidates and all other integrators that can render the scene.
void print_truths(const char* name, const Vista& vista, const std::vector<Candidate>& candidates,
                  const Settings& s) {
  std::vector<Candidate> all = candidates;
  for (const Integrator& i : kIntegrators) {
    const bool there =
        std::any_of(all.begin(), all.end(), [&](const Candidate& c) { return c.label == i.name; });
    const bool portal_one = i.mixture.has(Technique::portal);
    if (!there && light_missed(i, vista.world->scene).empty() &&
        !(portal_one && vista.openings.portals.empty()))
      all.push_back({i, label_of(i)});
  }
  const std::vector<double> reference = reference_of(vista, candidates, s);
  for (const Candidate& c : all) {
    Pictures first, p;
    render_one(vista, c.integrator, 4, 1000, s.depth, first);
    const auto spp =
        static_cast<uint64_t>(std::max(4.0, 4 * s.seconds / kPictures / first.cpu_seconds));
    TrueError v;
    for (size_t n = 0; n < kPictures || (n < kMostPictures && v.error > kKnown * v.mean); ++n) {
      render_one(vista, c.integrator, spp, 2000 + n, s.depth, p);
      v = error_of(p, reference);
    }
    const auto samples = static_cast<double>(spp * p.luminance.size() * reference.size());
    std::printf("truth\t%s\t%s\t%.5g\t%.3g\t%.5g\t%.5g\n", name, c.label.c_str(), v.mean, v.error,
                p.cpu_seconds * 1e9 / samples, p.work);
  }
}

void measure(const Files& files, const Settings& s) {
  const char* const name = s.name.empty() ? files[0].c_str() : s.name.c_str();
  Scene scene = read_gltf(files[0]);
  std::vector<Portal> portals = portals_in(files, 1);
  std::vector<cli::Common::Input> read;
  SkyArguments sky;
  sky.environment = s.environment;
  add_sky(scene, sky, {}, read);
  const Camera& camera = scene.camera(s.camera);
  Vista vista(scene, camera, s.width, s.height, portals);
  // As in the program: portals are first turned to the way that light passes.
  apply_ways(explore(vista, camera, portals, s.depth, 1).ways, portals);
  vista.openings = Openings(*vista.world, portals);
  const std::vector<Candidate> candidates =
      expecting_connections(vista, auto_candidates(vista), s.depth);
  if (s.seconds > 0) print_truths(name, vista, candidates, s);
  const auto pixels = static_cast<uint64_t>(s.width) * static_cast<uint64_t>(s.height);
  Film film(s.width, s.height, vista.world->lights.power());
  for (const std::string& word : s.lengths)
    for (int seed = 1; seed <= s.seeds; ++seed) {
      const uint64_t length = std::stoull(word);
      const double cpu = cpu_seconds();
      SampleRules rules;
      rules.max_depth = s.depth;
      rules.seed = static_cast<uint64_t>(seed);
      Pilot pilot(vista, candidates, rules);
      pilot.draw(kFewestGroups, film);
      const uint64_t enough = groups_for(static_cast<double>(length * pixels), pilot);
      if (enough > pilot.groups()) pilot.draw(enough - pilot.groups(), film);
      const Forecast told = pilot.forecast();
      const double spent = cpu_seconds() - cpu;
      film.clear();
      for (const CandidateEstimate& p : told.estimates)
        std::printf("told\t%s\t%llu\t%d\t%s\t%.5g\t%.5g\n", name,
                    static_cast<unsigned long long>(length), seed, p.integrator.c_str(),
                    p.cost / p.work, p.work);
      std::printf("choice\t%s\t%llu\t%d\t%s\t%.5g\t%llu\t%d\t%.5g\t%.5g\t%.5g\n", name,
                  static_cast<unsigned long long>(length), seed,
                  told.estimates[told.best].integrator.c_str(), spent,
                  static_cast<unsigned long long>(pilot.groups()), s.width * s.height,
                  told.portals_gain, told.gain_low, told.gain_high);
    }
  std::fflush(stdout);
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  tdpt::Settings s;
  return tdpt::run_bench({argv + 1, argv + argc},
                         "usage: regret_bench SCENE PORTAL... [--width W] [--height H] "
                         "[--seconds T] [--seeds N] [--lengths N,N...] [--depth N] "
                         "[--camera NAME] [--environment FILE] [--name NAME]",
                         {{"--width", &s.width},
                          {"--height", &s.height},
                          {"--seconds", &s.seconds},
                          {"--seeds", &s.seeds},
                          {"--lengths", &s.lengths},
                          {"--depth", &s.depth},
                          {"--camera", &s.camera},
                          {"--environment", &s.environment},
                          {"--name", &s.name}},
                         1, [&](const tdpt::Files& files) { tdpt::measure(files, s); });
}
