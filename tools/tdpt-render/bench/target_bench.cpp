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
#include "libcommon/base/output_file.h"
#include "libcommon/base/process.h"
#include "tools/tdpt-render/bench/bench_main.h"
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

void measure(const Files& files, const Settings& s) {
  const Scene scene = read_gltf(files[0]);
  const Vista vista(scene, scene.camera(""), s.width, s.height, portals_in(files, 2));
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
  tdpt::Settings s;
  return tdpt::run_bench({argv + 1, argv + argc},
                         "usage: target_bench SCENE FOLDER [PORTAL...] [--width W] [--height H] "
                         "[--integrator NAME] [--target E] [--threads N] [--seeds N]",
                         {{"--width", &s.width},
                          {"--height", &s.height},
                          {"--integrator", &s.integrator},
                          {"--target", &s.target},
                          {"--threads", &s.threads},
                          {"--seeds", &s.seeds}},
                         2, [&](const tdpt::Files& files) {
                           tdpt::limit_threads(s.threads);
                           tdpt::measure(files, s);
                         });
}
