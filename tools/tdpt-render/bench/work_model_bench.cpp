// work_model_bench SCENE PORTAL... : measures what samples of the integrators that `auto` tries
// cost. Prints a line for each integrator and depth with the measured cost and the terms of the
// model: its predictions when one number of its table is 1 and the others are 0.
// bench/work_model.py fits the table to these lines. Give scenes with their portals and without.
//   --width W --height H --seconds T   default 160 120 2, T of each line
//   --device gpu[:WHICH]               on a Vulkan device, by the clock; a software one by CPU time
#include <iterator>
#include <utility>

#include "libcommon/gpu/device_options.h"
#include "tools/tdpt-render/bench/bench_main.h"
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

void measure(const Files& files, const Options& o) {
  std::printf("scene\tdepth\tintegrator\tportals\tnanoseconds");
  for (const auto& [name, member] : kTerms) std::printf("\t%s", name);
  std::printf("\n");
  const Scene scene = read_gltf(files[0]);
  const Vista vista(scene, scene.camera(""), o.width, o.height, portals_in(files, 1));
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
      std::printf("%s\t%d\t%s\t%d\t%.6g", files[0].c_str(), depth, c.label.c_str(),
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
  tdpt::Options o;
  return tdpt::run_bench({argv + 1, argv + argc},
                         "usage: work_model_bench SCENE PORTAL... [--width W] [--height H] "
                         "[--seconds T] [--device gpu[:WHICH]]",
                         {{"--width", &o.width},
                          {"--height", &o.height},
                          {"--seconds", &o.seconds},
                          {"--device", &o.device}},
                         1, [&](const tdpt::Files& files) { tdpt::measure(files, o); });
}
