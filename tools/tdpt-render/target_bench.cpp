// target_bench SCENE FOLDER [PORTAL...]: pictures of many seeds with --target-error, and what they
// are held against; bench/target-error.sh runs it.
//   --width W --height H    default 32 24
//   --integrator NAME       default bdpt; auto
//   --target E              relMSE, default 0.05
//   --seeds N               default 100; FOLDER/SEED.exr, and a line of statistics each:
//                             SEED, samples fixed, relMSE estimated, low, high, pilot's samples,
//                             reached
//   --reference N           samples of each pixel of FOLDER/reference.exr; default 0: none is made
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "libcommon/base/output_file.h"
#include "tools/tdpt-render/render.h"

namespace tdpt {
namespace {

struct Settings {
  int width = 32, height = 24;
  uint64_t seeds = 100, reference = 0;
  double target = 0.05;
  std::string integrator = "bdpt";
};

void write_picture(const std::string& path, const Picture& picture) {
  ExrFile exr;
  exr.picture = picture;
  write_output(path, exr_bytes(exr));
}

void measure(const std::vector<std::string>& files, const Settings& s) {
  const Scene scene = read_gltf(files[0]);
  std::vector<Portal> portals;
  for (size_t i = 2; i < files.size(); ++i)
    for (const Portal& p : read_portals(files[i]).portals) portals.push_back(p);
  const World world(scene, scene.camera(""), s.width, s.height, portals);
  std::vector<Candidate> candidates;
  if (s.integrator == "auto") {
    candidates = auto_candidates(world);
  } else {
    const Integrator named = integrator_named(s.integrator);
    candidates.push_back({named, named.name});
  }
  RenderSettings settings;
  if (s.reference > 0) {
    settings.spp = s.reference;
    settings.seed = 1000000;
    write_picture(files[1] + "/reference.exr", render(world, candidates, settings).picture);
  }
  settings.spp = 0;
  settings.target_error = s.target;
  for (uint64_t seed = 1; seed <= s.seeds; ++seed) {
    settings.seed = seed;
    const RenderResult r = render(world, candidates, settings);
    write_picture(files[1] + "/" + std::to_string(seed) + ".exr", r.picture);
    const TargetOutcome& t = *r.target;
    std::printf("%llu %llu %.5g %.5g %.5g %llu %d\n", static_cast<unsigned long long>(seed),
                static_cast<unsigned long long>(t.fixed), t.relmse.value_or(-1), t.low, t.high,
                static_cast<unsigned long long>(t.pilot_samples), t.reached());
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  using namespace tdpt;
  Settings settings;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const bool more = i + 1 < argc;
    const auto is = [&](const char* option) { return more && !std::strcmp(argv[i], option); };
    if (is("--width"))
      settings.width = std::atoi(argv[++i]);
    else if (is("--height"))
      settings.height = std::atoi(argv[++i]);
    else if (is("--integrator"))
      settings.integrator = argv[++i];
    else if (is("--target"))
      settings.target = std::atof(argv[++i]);
    else if (is("--seeds"))
      settings.seeds = std::strtoull(argv[++i], nullptr, 10);
    else if (is("--reference"))
      settings.reference = std::strtoull(argv[++i], nullptr, 10);
    else
      files.emplace_back(argv[i]);
  }
  if (files.size() < 2 || settings.width < 1 || settings.height < 1 || !(settings.target > 0)) {
    std::fprintf(stderr,
                 "usage: target_bench SCENE FOLDER [PORTAL...] [--width W] [--height H] "
                 "[--integrator NAME] [--target E] [--seeds N] [--reference N]\n");
    return 2;
  }
  try {
    measure(files, settings);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "target_bench: %s\n", e.what());
    return 1;
  }
}
