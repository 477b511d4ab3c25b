// device_bench SCENE PORTAL... : one picture by the CPU, by the twin of a device, and by a device,
// taking turns: seconds per sample, and how far the means are apart.
//   --integrators A,B --width W --spp N --depth K --rounds N --machines cpu,twin,gpu --gpu WHICH -o
//   STEM
#include <cstdio>
#include <ctime>
#include <sstream>

#include "libcommon/base/output_file.h"
#include "libcommon/base/threads.h"
#include "tools/tdpt-render/device/gpu_machine.h"
#include "tools/tdpt-render/device/twin.h"
#include "tools/tdpt-render/device/wavefront.h"
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/picture_size.h"
#include "tools/tdpt-render/render.h"

namespace tdpt {
namespace {

struct Options {
  std::vector<std::string> files, integrators{"nee", "bdpt", "tdpt-org", "tdpt-guided"},
      machines{"cpu", "twin"};
  int width = 64, spp = 16, depth = 6, rounds = 1;
  std::string gpu, stem;
};

std::vector<std::string> listed(const std::string& list) {
  std::vector<std::string> words;
  std::istringstream in(list);
  for (std::string word; std::getline(in, word, ',');) words.push_back(word);
  return words;
}

void run(const Options& o) {
  const Scene scene = read_gltf(o.files[0]);
  std::vector<Portal> portals;
  for (size_t i = 1; i < o.files.size(); ++i)
    for (const Portal& p : read_portals(o.files[i]).portals) portals.push_back(p);
  const Camera camera = scene.camera("");
  const PictureSize size = picture_size(camera, o.width, 0);
  const World world(scene, camera, size.width, size.height, portals);
  const RenderTables tables(world);
  const uint64_t pixels = static_cast<uint64_t>(size.width) * static_cast<uint64_t>(size.height);
  const FilmPlaces places(pixels, false, world.portals.portals());
  StepTimes times;
  std::shared_ptr<SampleRenderer> gpu, twin;
  for (const std::string& machine : o.machines) {
    if (machine == "twin")
      twin = std::make_shared<WavefrontRenderer>(
          world, make_twin(tables, {1u << 19, 1u << 14}, places.words));
    if (machine == "gpu") {
      const gpu::Device device = gpu::Device::open(o.gpu);
      gpu = std::make_shared<WavefrontRenderer>(
          world, make_gpu_machine(device, tables, room_on(device, tables, places.words),
                                  places.words, &times));
    }
  }
  for (int round = 0; round < o.rounds; ++round)
    for (const std::string& name : o.integrators)
      for (const std::string& machine : o.machines) {
        RenderSettings settings;
        settings.spp = static_cast<uint64_t>(o.spp);
        settings.max_depth = o.depth;
        settings.seed = static_cast<uint64_t>(1 + round);
        times = {};
        if (machine == "twin") settings.device = twin;
        if (machine == "gpu") settings.device = gpu;
        const double cpu = cpu_seconds();
        const RenderResult result = render(world, integrator_named(name), settings);
        const double spent = cpu_seconds() - cpu;
        const Vec3d mean = result.mean();
        std::printf(
            "%-12s %-5s mean %.6g %.6g %.6g  %.0f ns/sample  rays %llu %llu %llu %llu left out "
            "%llu\n",
            name.c_str(), machine.c_str(), mean.x, mean.y, mean.z,
            1e9 * spent / static_cast<double>(pixels * settings.spp),
            static_cast<unsigned long long>(result.tally.rays.closest),
            static_cast<unsigned long long>(result.tally.rays.shadow),
            static_cast<unsigned long long>(result.tally.rays.portal),
            static_cast<unsigned long long>(result.tally.rays.join),
            static_cast<unsigned long long>(result.tally.not_finite));
        std::printf("   ");
        for (size_t t = 0; t < kTechniques; ++t)
          std::printf(" %s %.5g", kTechniqueNames[t],
                      result.tally.energy[t] / static_cast<double>(pixels * settings.spp));
        std::printf("\n");
        if (machine == "gpu") {
          for (size_t s = 0; s < times.of.size(); ++s) std::printf(" %.3f", times.of[s]);
          std::printf(" gather %.3f s\n", times.gather);
        }
        std::fflush(stdout);
        if (!o.stem.empty())
          write_output(o.stem + "-" + name + "-" + machine + ".exr",
                       exr_bytes({result.picture, {}, {}, {}, {}, 0}));
      }
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  tdpt::Options o;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word[0] != '-') {
      o.files.push_back(word);
      continue;
    }
    const std::string value = argv[++i];
    if (word == "--integrators") o.integrators = tdpt::listed(value);
    if (word == "--machines") o.machines = tdpt::listed(value);
    if (word == "--width") o.width = std::stoi(value);
    if (word == "--spp") o.spp = std::stoi(value);
    if (word == "--depth") o.depth = std::stoi(value);
    if (word == "--rounds") o.rounds = std::stoi(value);
    if (word == "--gpu") o.gpu = value;
    if (word == "-o") o.stem = value;
  }
  tdpt::run(o);
  return 0;
}
