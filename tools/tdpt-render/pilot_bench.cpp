// pilot_bench SCENE PORTAL... : what pilots of `auto` conclude, seed by seed: for each candidate
// its relMSE x work beside the least. To be held against long runs.
//   --width W --height H --rounds R --seeds N   default 160 120 2 5
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tools/tdpt-render/portal_probe.h"
#include "tools/tdpt-render/render.h"

int main(int argc, char** argv) {
  using namespace tdpt;
  int width = 160, height = 120, rounds = 2, seeds = 5;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    int* number = !std::strcmp(argv[i], "--width")    ? &width
                  : !std::strcmp(argv[i], "--height") ? &height
                  : !std::strcmp(argv[i], "--rounds") ? &rounds
                  : !std::strcmp(argv[i], "--seeds")  ? &seeds
                                                      : nullptr;
    if (!number)
      files.emplace_back(argv[i]);
    else if (++i < argc)
      *number = std::atoi(argv[i]);
  }
  if (files.empty() || width < 1 || height < 1 || rounds < 1) {
    std::fprintf(stderr, "usage: pilot_bench SCENE PORTAL... [--width W] [--height H] ...\n");
    return 2;
  }
  try {
    const Scene scene = read_gltf(files[0]);
    std::vector<Portal> portals;
    for (size_t i = 1; i < files.size(); ++i)
      for (const Portal& p : read_portals(files[i]).portals) portals.push_back(p);
    const World world(scene, scene.camera(""), width, height, portals);
    probe(world, portals);
    const std::vector<Candidate> candidates = auto_candidates(world, portals);
    for (int seed = 1; seed <= seeds; ++seed) {
      RenderSettings settings;
      settings.seed = static_cast<uint64_t>(seed);
      settings.pilot = PilotPlan{candidates.size(), static_cast<uint64_t>(rounds), 1};
      settings.spp = 2 * static_cast<uint64_t>(rounds) * candidates.size() + 1;
      const RenderResult r = render(world, candidates, settings);
      const PilotRecord& best = r.pilot[r.chosen];
      std::printf("seed %d  %-9s", seed, best.integrator.c_str());
      for (const PilotRecord& p : r.pilot)
        std::printf("  %s %.2f (%.3g)", p.integrator.c_str(),
                    p.relmse * p.work / (best.relmse * best.work), p.relmse);
      std::printf("\n");
      std::fflush(stdout);
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "pilot_bench: %s\n", e.what());
    return 1;
  }
}
