// limit_bench SCENE PORTAL... : how far rendering is from only tracing its rays. It renders a
// frame, then gives the same rays to Embree again: the same queries (robust mode, the renderer's
// flags) in the same order, on as many threads, each with the rays it made. Prints a line for each
// integrator, number of threads and seed, taking turns. bench/speed.py makes doc/limit.md of these
// lines.
//   --integrators A,B --threads 1,2 --seeds N --width W --spp N   default: as below
//
// Only for opaque scenes: deciding whether a ray is stopped is the renderer's work.
#include <ctime>
#include <stdexcept>

#include "libcommon/base/process.h"
#include "libcommon/scene/scene.h"
#include "libcommon/testing/ray_record.h"
#include "tools/tdpt-render/bench/bench_main.h"
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/run/scene_cache.h"
#include "tools/tdpt-render/testing/rendering.h"

namespace tdpt {
namespace {

struct Options {
  std::vector<std::string> integrators{"nee", "bdpt", "tdpt-org", "tdpt-guided"}, threads{"1", "2"};
  int seeds = 5, width = 240, spp = 8;
};

struct Seconds {
  double cpu = 0, wall = 0;
};

double now() {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

template <class Work>
Seconds time_of(const Work& work) {
  const double cpu = cpu_seconds(), wall = now();
  work();
  return {cpu_seconds() - cpu, now() - wall};
}

void measure(const std::string& scene, const Options& o, const Vista& vista,
             const Integrator& integrator, int threads, int seed) {
  Job settings;
  settings.limits.spp = static_cast<uint64_t>(o.spp);
  settings.seed = static_cast<uint64_t>(seed);
  limit_threads(threads);
  ray_record::begin();
  const RayCounts rays = render(vista, integrator, settings).tally.rays;
  ray_record::end();
  uint64_t others = 0;
  const Seconds frame = time_of([&] { render(vista, integrator, settings); });
  const Seconds raw = time_of([&] { others = ray_record::cast_again(); });
  const auto samples =
      static_cast<double>(settings.limits.spp) * vista.view.film.width() * vista.view.film.height();
  std::printf("%s\t%s\t%d\t%d\t%.0f\t%llu\t%llu\t%llu\t%llu\t%.6f\t%.6f\t%.6f\t%.6f\n",
              scene.c_str(), integrator.name, threads, seed, samples,
              static_cast<unsigned long long>(rays.closest),
              static_cast<unsigned long long>(rays.shadow),
              static_cast<unsigned long long>(ray_record::rays()),
              static_cast<unsigned long long>(others), frame.cpu, raw.cpu, frame.wall, raw.wall);
  std::fflush(stdout);
}

void run(const Files& files, const Options& o) {
  const Scene scene = read_gltf(files[0]);
  for (const Material& m : scene.materials)
    if (pane_of(m) || m.alpha_mode != Material::Alpha::opaque)
      throw std::runtime_error(files[0] + ": not opaque");
  const Camera camera = scene.camera("");
  const PictureSize size = picture_size(scene, camera, o.width, 0);
  const Vista vista(scene, camera, size.width, size.height, portals_in(files, 1));
  std::printf(
      "scene\tintegrator\tthreads\tseed\tsamples\tclosest\tshadow\trays\tother\tframe_cpu\traw_cpu"
      "\tframe_wall\traw_wall\n");
  for (int seed = 1; seed <= o.seeds; ++seed)
    for (const std::string& name : o.integrators)
      for (const std::string& threads : o.threads)
        measure(files[0], o, vista, integrator_named(name), std::stoi(threads), seed);
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  tdpt::Options o;
  return tdpt::run_bench({argv + 1, argv + argc},
                         "usage: limit_bench SCENE PORTAL... [--integrators A,B] [--threads 1,2] "
                         "[--seeds N] [--width W] [--spp N]",
                         {{"--integrators", &o.integrators},
                          {"--threads", &o.threads},
                          {"--seeds", &o.seeds},
                          {"--width", &o.width},
                          {"--spp", &o.spp}},
                         1, [&](const tdpt::Files& files) { tdpt::run(files, o); });
}
