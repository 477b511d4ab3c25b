// target_bench SCENE FOLDER [PORTAL...]: renders pictures of many seeds with --target-error, and
// their references; bench/promises.py runs it.
//   --width W --height H    default 32 24
//   --integrator NAME       default bdpt; auto
//   --target E              relMSE, default 0.05
//   --threads N             default all cores
//   --seeds N               default 100; FOLDER/SEED.exr, and a line of statistics each:
//                             SEED, samples fixed, relMSE estimated, low, high, pilot's samples,
//                             reached
// Also FOLDER/SEED.reference.exr, the mean of all other pictures, which is independent of it.
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "libcommon/base/output_file.h"
#include "libcommon/base/process.h"
#include "tools/tdpt-render/testing/rendering.h"

namespace tdpt {
namespace {

struct Settings {
  int width = 32, height = 24, threads = 0;
  uint64_t seeds = 100;
  double target = 0.05;
  std::string integrator = "bdpt";
};

void write_picture(const std::string& path, const Picture& picture) {
  ExrFile exr;
  exr.picture = picture;
  write_output(path, exr_bytes(exr));
}

void write_pictures(const std::string& folder, const std::vector<Picture>& pictures) {
  std::vector<Vec3d> sums(pictures[0].pixels.size(), Vec3d(0, 0, 0));
  for (const Picture& p : pictures)
    for (size_t i = 0; i < sums.size(); ++i) sums[i] += Vec3d(p.pixels[i]);
  const double share = 1 / static_cast<double>(pictures.size() - 1);
  for (size_t k = 0; k < pictures.size(); ++k) {
    const std::string stem = folder + "/" + std::to_string(k + 1);
    write_picture(stem + ".exr", pictures[k]);
    Picture others = pictures[k];
    for (size_t i = 0; i < sums.size(); ++i)
      others.pixels[i] = Vec3f((sums[i] - Vec3d(pictures[k].pixels[i])) * share);
    write_picture(stem + ".reference.exr", others);
  }
}

void measure(const std::vector<std::string>& files, const Settings& s) {
  const Scene scene = read_gltf(files[0]);
  std::vector<Portal> portals;
  for (size_t i = 2; i < files.size(); ++i)
    for (const Portal& p : read_portals(files[i]).portals) portals.push_back(p);
  const Vista vista(scene, scene.camera(""), s.width, s.height, portals);
  std::vector<Candidate> candidates;
  if (s.integrator == "auto") {
    candidates = auto_candidates(vista);
  } else {
    const Integrator named = integrator_named(s.integrator);
    candidates.push_back({named, named.name});
  }
  Job settings;
  settings.limits.target_error = s.target;
  std::vector<Picture> pictures;
  for (uint64_t seed = 1; seed <= s.seeds; ++seed) {
    settings.seed = seed;
    const RenderResult r = render(vista, candidates, settings);
    pictures.push_back(r.picture);
    const TargetOutcome& t = *r.target;
    const Noise noise = t.noise.value_or(Noise{-1, 0, 0});
    std::printf("%llu %llu %.5g %.5g %.5g %llu %d\n", static_cast<unsigned long long>(seed),
                static_cast<unsigned long long>(t.fixed), noise.relmse, noise.low, noise.high,
                static_cast<unsigned long long>(r.plan.error_pilot.samples()), t.reached());
    std::fflush(stdout);
  }
  write_pictures(files[1], pictures);
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
    else if (is("--threads"))
      settings.threads = std::atoi(argv[++i]);
    else if (is("--seeds"))
      settings.seeds = std::strtoull(argv[++i], nullptr, 10);
    else
      files.emplace_back(argv[i]);
  }
  if (files.size() < 2 || settings.width < 1 || settings.height < 1 || settings.seeds < 2 ||
      settings.threads < 0 || !(settings.target > 0)) {
    std::fprintf(stderr,
                 "usage: target_bench SCENE FOLDER [PORTAL...] [--width W] [--height H] "
                 "[--integrator NAME] [--target E] [--threads N] [--seeds N]\n");
    return 2;
  }
  try {
    limit_threads(settings.threads);
    measure(files, settings);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "target_bench: %s\n", e.what());
    return 1;
  }
}
