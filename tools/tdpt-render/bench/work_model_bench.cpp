// work_model_bench SCENE PORTAL... : measures what samples of the integrators that `auto` tries
// cost. Prints a line for each integrator and depth with the measured cost and the terms of the
// model: its predictions when one number of its table is 1 and the others are 0.
// bench/work_model.py fits the table to these lines. Give scenes with their portals and without.
//   --width W --height H --seconds T   default 160 120 2, T of each line
//   --device gpu[:WHICH]               on a Vulkan device, by the clock; a software one by CPU time
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <utility>

#include "libcommon/gpu/device_options.h"
#include "tools/tdpt-render/device/gpu_renderer.h"
#include "tools/tdpt-render/plan/work_model.h"
#include "tools/tdpt-render/testing/rendering.h"

namespace tdpt {
namespace {

constexpr std::pair<const char*, double WorkCosts::*> kTerms[] = {
    {"sample", &WorkCosts::sample},
    {"closest", &WorkCosts::closest},
    {"closest_deeper", &WorkCosts::closest_deeper},
    {"shadow", &WorkCosts::shadow},
    {"connect", &WorkCosts::connect},
    {"portal", &WorkCosts::portal},
    {"portal_triangle", &WorkCosts::portal_triangle},
    {"directed", &WorkCosts::directed},
    {"facets", &WorkCosts::facets},
    {"facet", &WorkCosts::facet},
    {"looking_out", &WorkCosts::looking_out},
    {"window", &WorkCosts::window},
};
static_assert(sizeof(WorkCosts) == std::size(kTerms) * sizeof(double), "a term is missing");
constexpr int kDepths[] = {3, 6, kMaxDepth};

struct Options {
  int width = 160, height = 120;
  double seconds = 2;
  std::string device = "cpu";
};

void measure(const std::string& scene_path, const std::vector<Portal>& portals, const Options& o) {
  const Scene scene = read_gltf(scene_path);
  const Vista vista(scene, scene.camera(""), o.width, o.height, portals);
  const std::optional<gpu::Device> device = device_asked(o.device);
  const std::shared_ptr<SampleRenderer> renderer =
      device ? GpuUpload(*device, vista, {}).renderer(vista) : std::make_shared<CpuRenderer>(vista);
  const bool by_clock = device && device->info().kind != "cpu";

  for (int depth : kDepths)
    for (const Candidate& c : auto_candidates(vista)) {
      Job settings;
      settings.limits.seconds = o.seconds;
      settings.max_depth = depth;
      const RenderResult r = render(*renderer, c.integrator, settings);
      const auto samples =
          r.spp() * static_cast<uint64_t>(o.width) * static_cast<uint64_t>(o.height);
      std::printf("%s\t%d\t%s\t%d\t%.6g", scene_path.c_str(), depth, c.label.c_str(),
                  Guide(vista, c.integrator.mixture).sees_portals() ? 1 : 0,
                  (by_clock ? r.progress->seconds : r.progress->cpu_seconds) * 1e9 /
                      static_cast<double>(samples));
      for (const auto& [name, member] : kTerms) {
        WorkCosts unit;
        unit.*member = 1;
        std::printf("\t%.9g",
                    sample_work(vista, c.integrator.mixture, unit, r.tally.rays, samples));
      }
      std::printf("\n");
      std::fflush(stdout);
    }
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  using namespace tdpt;
  Options o;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const bool more = i + 1 < argc;
    if (!std::strcmp(argv[i], "--width") && more)
      o.width = std::atoi(argv[++i]);
    else if (!std::strcmp(argv[i], "--height") && more)
      o.height = std::atoi(argv[++i]);
    else if (!std::strcmp(argv[i], "--seconds") && more)
      o.seconds = std::atof(argv[++i]);
    else if (!std::strcmp(argv[i], "--device") && more)
      o.device = argv[++i];
    else
      files.emplace_back(argv[i]);
  }
  if (files.empty() || o.width < 1 || o.height < 1 || !(o.seconds > 0)) {
    std::fprintf(stderr,
                 "usage: work_model_bench SCENE PORTAL... [--width W] [--height H] [--seconds T] "
                 "[--device gpu[:WHICH]]\n");
    return 2;
  }
  try {
    std::vector<Portal> portals;
    for (size_t i = 1; i < files.size(); ++i)
      for (const Portal& p : read_portals(files[i]).portals) portals.push_back(p);
    std::printf("scene\tdepth\tintegrator\tportals\tnanoseconds");
    for (const auto& [name, member] : kTerms) std::printf("\t%s", name);
    std::printf("\n");
    measure(files[0], portals, o);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "work_model_bench: %s\n", e.what());
    return 1;
  }
}
