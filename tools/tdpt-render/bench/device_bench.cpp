// How many samples a device renders beside the CPU, what it spends its time on, and what that
// moves. Prints tables in Markdown, and progress on stderr; bench/run.py gpu-speed puts
// them into doc/limit.md.
#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "libcommon/base/process.h"
#include "libcommon/gpu/statistics_bench.h"
#include "shaders/path_steps.h"
#include "tools/tdpt-render/bench/bench_main.h"
#include "tools/tdpt-render/device/gpu_renderer.h"
#include "tools/tdpt-render/device/wavefront.h"
#include "tools/tdpt-render/plan/candidates.h"
#include "tools/tdpt-render/run/scene_cache.h"
#include "tools/tdpt-render/testing/rendering.h"

namespace tdpt {
namespace {

constexpr const char* kUsage =
    "usage: device_bench [OPTION]... SCENE [PORTAL.glb]...\n"
    "       device_bench --registers [--device gpu[:WHICH]]\n"
    "\n"
    "Samples per CPU second of the CPU, and per second of a device (where it is a CPU, of all its\n"
    "cores), which take turns in one run.\n"
    "  --device gpu[:WHICH]   as tdpt-render has it (gpu)\n"
    "  --integrators A,B      names; auto: what it chooses (nee,bdpt,tdpt-guided,auto)\n"
    "  --width W              of the picture (160)\n"
    "  --spp N                samples per pixel of a round (8)\n"
    "  --max-depth N          longest path (6)\n"
    "  --rounds N             after one in which kernels are made (5)\n"
    "  --registers            what the driver's compiler tells of each kernel\n";

struct Options {
  std::vector<std::string> integrators{"nee", "bdpt", "tdpt-guided", "auto"};
  std::string device = "gpu";
  int width = 160, spp = 8, max_depth = 6, rounds = 5;
  bool registers = false;
};

struct Spread {
  double least, median, most;
};
Spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {values.front(), values[values.size() / 2], values.back()};
}

double wall_seconds() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

/// How often one step ran, and the time it took: of the device, or, if it is a CPU, of all its
/// cores.
struct StepWork {
  double seconds = 0;
  uint64_t runs = 0;
};
struct DeviceWork {
  std::array<StepWork, static_cast<size_t>(Step::kSteps)> steps;
  StepWork gather;    ///< ranks and lists: pick() and place_ends()
  double making = 0;  ///< seconds of compiling kernels
};

// A machine that adds its work to `work`.
class TimedMachine : public Machine {
 public:
  TimedMachine(std::unique_ptr<Machine> machine, bool of_cores, DeviceWork& work)
      : machine_(std::move(machine)), of_cores_(of_cores), work_(work) {}
  Capacity room() const override { return machine_->room(); }
  void set(const shader::RenderParameters& p, const std::vector<uint32_t>& offsets) override {
    machine_->set(p, offsets);
  }
  void run(Step step, const shader::StepParameters& p) override {
    timed(work_.steps[static_cast<size_t>(step)], p.count, [&] {
      machine_->run(step, p);
      return 0u;
    });
  }
  uint32_t pick(uint32_t count, uint32_t first) override {
    return timed(work_.gather, count, [&] { return machine_->pick(count, first); });
  }
  void place_ends(uint32_t walks) override {
    timed(work_.gather, walks, [&] {
      machine_->place_ends(walks);
      return 0u;
    });
  }
  std::vector<uint32_t> take_film() override { return machine_->take_film(); }

 private:
  template <class F>
  uint32_t timed(StepWork& to, uint32_t invocations, const F& f) {
    const auto now = [&] { return of_cores_ ? cpu_seconds() : wall_seconds(); };
    const double before = now();
    const uint32_t result = f();
    if (invocations == 0) return result;
    to.seconds += now() - before;
    ++to.runs;
    return result;
  }
  const std::unique_ptr<Machine> machine_;
  const bool of_cores_;
  DeviceWork& work_;
};

// A renderer that adds the time of making kernels.
struct TimedRenderer : WavefrontRenderer {
  TimedRenderer(const Vista& vista_, std::unique_ptr<Machine> machine, std::string name,
                DeviceWork& work_)
      : WavefrontRenderer(vista_, std::move(machine), std::move(name)), work(work_) {}
  void prepare(const Integrator& integrator, const SampleRules& rules, const Film& film,
               bool quiet) override {
    const DeviceWork before = work;
    const double start = wall_seconds();
    WavefrontRenderer::prepare(integrator, rules, film, quiet);
    work = before;
    work.making += wall_seconds() - start;
  }
  DeviceWork& work;
};

// A scene with both renderers.
struct Stage {
  Stage(const Files& files, const Options& o, const gpu::Device& device)
      : scene(read_gltf(files[0])),
        size(picture_size(scene, scene.camera(""), o.width, 0)),
        vista(scene, scene.camera(""), size.width, size.height, portals_in(files, 1)),
        tables(vista),
        of_cores(device.info().kind == "cpu") {
    const FilmPlaces places(pixels(), {}, vista.openings.portals.portals());
    renderer = std::make_shared<TimedRenderer>(
        vista,
        std::make_unique<TimedMachine>(
            make_gpu_machine(device, tables, capacity_on(device, tables, places.words),
                             places.words),
            of_cores, work),
        device.info().name, work);
  }
  uint64_t pixels() const {
    return static_cast<uint64_t>(size.width) * static_cast<uint64_t>(size.height);
  }

  const Scene scene;
  const PictureSize size;
  Vista vista;
  RenderTables tables;
  const bool of_cores;  // the device is a CPU
  DeviceWork work;
  std::shared_ptr<SampleRenderer> renderer;
};

// Measurements of one integrator over all rounds.
struct Measured {
  std::string label;
  std::vector<double> cpu, device, ratio;  // samples per second [one_round()]
  double making = 0;                       // seconds of compiling kernels
  DeviceWork work;                         // of all rounds
  RayCounts rays;
  double samples = 0;  // on the device
};

Job settings_of(const Options& o, int round) {
  Job s;
  s.limits.spp = static_cast<uint64_t>(o.spp);
  s.max_depth = o.max_depth;
  s.seed = static_cast<uint64_t>(1 + round);
  return s;
}

// The integrator of that name, or the one `auto` would choose on the device.
Candidate candidate_of(const std::string& name, const Options& o, Stage& stage) {
  if (name != "auto") return {integrator_named(name), name};
  const std::vector<Candidate> all = auto_candidates(stage.vista);
  const RenderResult result = render(*stage.renderer, all, settings_of(o, 0));
  const Candidate& chosen = all[result.plan.forecast.best];
  return {chosen.integrator, "auto: " + chosen.label};
}

// One round: samples per CPU second, or per second of a device that is not a CPU.
double one_round(const Candidate& c, const Job& settings, const Stage& stage,
                 SampleRenderer& renderer, RenderResult& result) {
  const bool of_cores = !renderer.on_device() || stage.of_cores;
  const auto now = [&] { return of_cores ? cpu_seconds() : wall_seconds(); };
  const double before = now();
  result = render(renderer, c.integrator, settings);
  return static_cast<double>(stage.pixels() * settings.limits.spp) / (now() - before);
}

Measured measure(const std::string& name, const Options& o, Stage& stage) {
  Measured m;
  stage.work = {};
  const Candidate c = candidate_of(name, o, stage);
  m.label = c.label;
  for (int round = 0; round <= o.rounds; ++round) {
    const Job settings = settings_of(o, round);
    RenderResult result;
    CpuRenderer cpu_renderer(stage.vista);
    const double cpu = one_round(c, settings, stage, cpu_renderer, result);
    const double device = one_round(c, settings, stage, *stage.renderer, result);
    fmt::print(stderr, "{} round {}: {:.0f} and {:.0f} samples per second, {:.3f}\n", m.label,
               round, cpu, device, device / cpu);
    if (round == 0) {
      m.making = stage.work.making;
      stage.work = {};
      continue;
    }
    m.cpu.push_back(cpu);
    m.device.push_back(device);
    m.ratio.push_back(device / cpu);
    m.rays.merge(result.tally.rays);
    m.samples += static_cast<double>(stage.pixels() * settings.limits.spp);
  }
  m.work = stage.work;
  return m;
}

void print_speeds(const std::string& scene, const std::vector<Measured>& all) {
  std::puts(
      "| scene | integrator | CPU: samples per CPU second | device: per second of its own | device "
      "over CPU | making "
      "kernels [s] |\n|---|---|---|---|---|---|");
  for (const Measured& m : all) {
    const Spread r = spread_of(m.ratio);
    fmt::print("| {} | {} | {:.0f} | {:.0f} | {:.2f} ({:.2f} to {:.2f}) | {:.0f} |\n", scene,
               m.label, spread_of(m.cpu).median, spread_of(m.device).median, r.median, r.least,
               r.most, m.making);
  }
}

void print_rays(const std::string& scene, const Measured& m) {
  const StepWork& begun = m.work.steps[static_cast<size_t>(Step::begin_camera_walks)];
  fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.1f} | {} | {:.0f} |\n", scene, m.label,
             static_cast<double>(m.rays.closest) / m.samples,
             static_cast<double>(m.rays.shadow) / m.samples,
             static_cast<double>(m.rays.connect) / m.samples, begun.runs,
             m.samples / static_cast<double>(begun.runs));
}

// Shares of the device's time, the largest first.
void print_shares(const std::string& scene, const Measured& m) {
  std::vector<std::pair<double, std::string>> shares{{m.work.gather.seconds, "flags and lists"}};
  for (size_t i = 0; i < kStepNames.size(); ++i)
    shares.emplace_back(m.work.steps[i].seconds, kStepNames[i]);
  std::sort(shares.rbegin(), shares.rend());
  double whole = 0;
  for (const auto& [seconds, name] : shares) whole += seconds;
  fmt::print("* {}, {}:", scene, m.label);
  const char* between = " ";
  for (const auto& [seconds, name] : shares) {
    if (seconds < 0.01 * whole) break;
    fmt::print("{}{} {:.0f} %", between, name, 100 * seconds / whole);
    between = ", ";
  }
  std::puts("");
}

// Whether a driver's statistic concerns occupancy or memory, by the names of Mesa's drivers and
// NVIDIA's.
bool tells_of_room(const std::string& name) {
  constexpr const char* kNames[] = {"SGPRs",          "VGPRs",        "Spilled SGPRs",
                                    "Spilled VGPRs",  "Scratch size", "Subgroups per SIMD",
                                    "Code size",      "Spill count",  "Fill count",
                                    "Register Count", "Stack Size",   "Local Memory Size",
                                    "Binary Size"};
  return std::find(std::begin(kNames), std::end(kNames), name) != std::end(kNames);
}

// Of each step's kernel, specialised for a scene with every feature, or for the least: diffuse
// surfaces behind portals.
std::array<std::vector<gpu::Statistic>, kStepNames.size()> step_statistics(
    const gpu::Device& device, bool least) {
  // In the order of path_bindings.glsl.
  std::vector<uint32_t> constants;
  if (least) {
    constants.assign(19, 0);
    constants[17] = 1;  // portals
    constants.insert(constants.end(), {1, 0, 31, 0, 0, 0, 0});
  }
  const std::array<std::span<const uint32_t>, kStepNames.size()> programs{
#define STEP(name, call) shader::path_step_##name##_spv,
#include "shaders/shared/path/steps.def"
  };
  std::array<std::vector<gpu::Statistic>, kStepNames.size()> all;
  for (size_t i = 0; i < all.size(); ++i)
    all[i] = statistics_of(device, programs[i], sizeof(shader::StepParameters), constants);
  return all;
}

void print_registers(const gpu::Device& device) {
  const auto most = step_statistics(device, false), least = step_statistics(device, true);
  std::string names = "| kernel |", rule = "|---|";
  for (const gpu::Statistic& s : most[0])
    if (tells_of_room(s.name)) names += " " + s.name + " |", rule += "---|";
  fmt::print("{}\n{}\n", names, rule);
  for (size_t step = 0; step < most.size(); ++step) {
    fmt::print("| {} |", kStepNames[step]);
    for (size_t i = 0; i < most[step].size(); ++i)
      if (tells_of_room(most[step][i].name))
        fmt::print(" {:.0f} ({:.0f}) |", most[step][i].value, least[step][i].value);
    std::puts("");
  }
  fmt::print(stderr, "device: {}\n", device.info().name);
}

void run(const Files& files, const Options& o) {
  if (files.empty() == !o.registers || !o.device.starts_with("gpu")) throw UsageError(kUsage);
  const gpu::Device device = gpu::Device::open(o.device.size() > 4 ? o.device.substr(4) : "");
  if (o.registers) return print_registers(device);
  Stage stage(files, o, device);
  const std::string scene = files[0].substr(files[0].find_last_of('/') + 1);
  std::vector<Measured> all;
  for (const std::string& name : o.integrators) all.push_back(measure(name, o, stage));
  print_speeds(scene, all);
  std::puts(
      "\n| scene | integrator | closest-hit rays | shadow rays | estimates of connections | "
      "submissions | samples of one |\n|---|---|---|---|---|---|---|");
  for (const Measured& m : all) print_rays(scene, m);
  std::puts("");
  for (const Measured& m : all) print_shares(scene, m);
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  tdpt::Options o;
  return tdpt::run_bench({argv + 1, argv + argc}, tdpt::kUsage,
                         {{"--device", &o.device},
                          {"--integrators", &o.integrators},
                          {"--width", &o.width},
                          {"--spp", &o.spp},
                          {"--max-depth", &o.max_depth},
                          {"--rounds", &o.rounds},
                          {"--registers", &o.registers}},
                         0, [&](const tdpt::Files& files) { tdpt::run(files, o); });
}
