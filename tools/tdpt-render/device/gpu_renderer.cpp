#include "tools/tdpt-render/device/gpu_renderer.h"

#include <cstring>
#include <map>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/math/sequence.h"
#include "shaders/path_scan.h"
#include "shaders/path_steps.h"
#include "shaders/shared/path/scan_layout.h"
#include "shaders/shared/path/tables.h"

namespace tdpt {
namespace {

// For one cache if no walk ends before the limit of depth, with the ends of its segments.
constexpr uint64_t kFewestSlots = 2 * kMostOfCache * (uint64_t{kMaxDepth} + 1) + 2 * kMostOfCache;
constexpr uint64_t kMostSlots = uint64_t{1} << 24;
constexpr uint64_t kSlotsOfSample = 16;  // more than most samples need
constexpr uint64_t kWorkGroup = 64;      // invocations, one per slot

// Bytes of PATH_TABLES.
uint64_t path_bytes(const Capacity& room, bool layered) {
  using namespace shader;
  using shader::PortalSegment;
#define BYTES(binding, type, name, array, count) \
  +sizeof(type) * uint64_t {                     \
    count                                        \
  }
  return 0 PATH_TABLES(BYTES);
#undef BYTES
}

// Bytes per slot, with its share of a sample.
uint64_t slot_bytes(bool layered) {
  constexpr uint32_t kSlots = kSlotsOfSample;
  return (path_bytes({2 * kSlots, 2}, layered) - path_bytes({kSlots, 1}, layered)) /
             kSlotsOfSample +
         1;
}

[[noreturn]] void refuse(const std::string& device, const std::string& why) {
  throw Error(Exit::no_device, device + ": " + why);
}

}  // namespace

Capacity capacity_on(const std::string& name, const gpu::Limits& limits, const DeviceNeeds& needs) {
  if (needs.buffers > limits.buffers)
    refuse(name, fmt::format("a kernel binds {} buffers, the device allows {}", needs.buffers,
                             limits.buffers));
  if (needs.scene > limits.texels)
    refuse(name,
           fmt::format("the scene takes {} bytes, the device reads no more than {} from a buffer",
                       needs.scene, limits.texels));
  if (needs.film > limits.buffer)
    refuse(name, fmt::format("the film takes {} bytes, the device's largest buffer has {}",
                             needs.film, limits.buffer));
  const uint64_t fixed = needs.scene + needs.film;
  const uint64_t slot = slot_bytes(needs.layered);
  const uint64_t most = limits.memory / 4 * 3;
  if (fixed + kFewestSlots * slot > most)
    refuse(name, fmt::format("scene, film and samples take {} bytes of memory at least, of the "
                             "device's they may take {}",
                             fixed + kFewestSlots * slot, most));
  Capacity room;
  const uint64_t in_memory = std::min(most - fixed, limits.memory / 8) / slot;
  room.vertices = static_cast<uint32_t>(
      std::min({std::max(in_memory, kFewestSlots), limits.buffer / sizeof(shader::PathVertex),
                limits.texels / slot, kWorkGroup * limits.groups, kMostSlots}));
  if (room.vertices < kFewestSlots)
    refuse(name, fmt::format("samples take {} vertices at least, the device holds {}", kFewestSlots,
                             room.vertices));
  room.samples = static_cast<uint32_t>(room.vertices / kSlotsOfSample);
  return room;
}

namespace {

using gpu::Buffer;
using gpu::Device;
using gpu::Kernel;
using gpu::Memory;

constexpr size_t kOfSteps = static_cast<size_t>(Step::kSteps);

constexpr std::array<std::span<const uint32_t>, kOfSteps> kPrograms{
#define STEP(name, call) shader::path_step_##name##_spv,
#include "shaders/shared/path/steps.def"
};

static_assert(sizeof(shader::AllSettings) <= 16384);  // of uniforms, on every device

uint32_t groups_of(uint32_t count) {
  return (count + 63) / 64;
}

namespace path {
enum Table : size_t {
#define NUMBER(binding, type, name, array, count) array,
  PATH_TABLES(NUMBER)
#undef NUMBER
};
}  // namespace path

gpu::Tables room_for_paths(const Capacity& room, bool layered, const Device& device) {
  using namespace shader;
  using shader::PortalSegment;
  gpu::Tables tables;
#define ADD_ROOM(binding, type, name, array, count) tables.add_room(sizeof(type) * uint64_t{count});
  PATH_TABLES(ADD_ROOM)
#undef ADD_ROOM
  tables.upload(device);
  return tables;
}

gpu::Tables uploaded_scene(const RenderTables& t, const Device& device) {
  const shader::SceneSpans scene(t);
  gpu::Tables tables;
#define ADD(type, name, array) tables.add(scene.array);
  SCENE_TABLES(ADD)
#undef ADD
  tables.upload(device);
  return tables;
}

// Bindings are numbered in the order of the list, after the texels and the settings.
#define BINDING(number, type, name, array, count) number,
constexpr uint32_t kBindings[] = {PATH_TABLES(BINDING) FILM_BINDING};
#undef BINDING
static_assert([] {
  for (uint32_t i = 0; i < std::size(kBindings); ++i)
    if (kBindings[i] != 3 + i) return false;
  return true;
}());

class GpuMachine : public Machine {
 public:
  GpuMachine(const Device& device, const RenderTables& t, const Capacity& room, uint32_t film_words)
      : device_(device),
        room_(room),
        settings_host_{{}, t.portals.guiding, t.lights.settings, {}},
        features_(features_of(t)),
        scene_(uploaded_scene(t, device)),
        path_(room_for_paths(room, t.surfaces.features.layers, device)),
        settings_(device, sizeof(shader::AllSettings)),
        film_(device, sizeof(uint32_t) * uint64_t{film_words}),
        totals_(device, 4 * (uint64_t{shader::scan_blocks(room.flags() + 1)} + 1)),
        memory_(bind()),
        scan_flags_(device, shader::path_scan_spv,
                    {path_.part(path::flags), path_.part(path::ranks), totals_},
                    sizeof(shader::ScanParameters)),
        scan_walks_(device, shader::path_scan_spv,
                    {path_.part(path::walk_counts), path_.part(path::end_first), totals_},
                    sizeof(shader::ScanParameters)) {
    std::vector<uint32_t> firsts = path_.first_texels();
    const std::vector<uint32_t> of_scene = scene_.first_texels();
    firsts.insert(firsts.end(), of_scene.begin(), of_scene.end());
    std::memcpy(&settings_host_.first_texels, firsts.data(), firsts.size() * sizeof(uint32_t));
    device_.run([&](gpu::Commands& c) { c.clear(film_); });
  }

  Capacity room() const override { return room_; }

  void set(const shader::RenderParameters& p, const std::vector<uint32_t>& cache_offsets) override {
    settings_host_.render = p;
    settings_.write(std::as_bytes(std::span(&settings_host_, 1)));
    path_.write(path::cache_offsets, std::as_bytes(std::span(cache_offsets)));
    kind_ = {p.guide_light > 0 || p.guide_camera > 0,
             p.culls != 0,
             p.techniques,
             p.beta == 2,
             p.layers != 0,
             p.halves != 0,
             p.transparent != 0};
  }

  void run(Step step, const shader::StepParameters& p) override {
    if (p.count == 0) return;
    const Kernel& kernel = kernel_of(step);
    device_.run([&](gpu::Commands& c) { c.dispatch(kernel, gpu::push(p), groups_of(p.count)); });
  }

  uint32_t pick(uint32_t count, uint32_t first) override {
    if (count == 0) return 0;
    const Kernel& gather = kernel_of(Step::gather);
    device_.run([&](gpu::Commands& c) {
      scan(c, scan_flags_, count);
      c.dispatch(gather, gpu::push(shader::StepParameters{count, first, 0}), groups_of(count));
    });
    return totals_.download<uint32_t>(1, 4 * uint64_t{shader::scan_blocks(count)}).front();
  }

  void place_ends(uint32_t walks) override {
    device_.run([&](gpu::Commands& c) { scan(c, scan_walks_, walks + 1); });
  }

  std::vector<uint32_t> take_film() override {
    std::vector<uint32_t> words = film_.download<uint32_t>();
    device_.run([&](gpu::Commands& c) { c.clear(film_); });
    return words;
  }

 private:
  static std::vector<uint32_t> features_of(const RenderTables& t) {
    const SurfaceFeatures& f = t.surfaces.features;
    return {f.layers,
            f.normals,
            f.textures,
            f.colours,
            f.coats,
            f.sheen,
            f.transmission,
            f.absorption,
            f.panes,
            f.coverage,
            f.coverage_textures,
            t.lights.has_sky,
            t.lights.has_sky_map,
            t.lights.has_lamps,
            t.lights.has_rect_lights,
            t.lights.has_windows,
            t.lights.prefers,
            !t.portals.facets.empty(),
            !t.portals.pairs.empty()};
  }

  // In the order of kBindings.
  std::vector<Memory> bind() const {
    std::vector<Memory> all{path_.texels(), scene_.texels(), settings_.uniforms()};
#define BIND(binding, type, name, array, count) all.emplace_back(path_.part(path::array));
    PATH_TABLES(BIND)
#undef BIND
    all.emplace_back(film_);
    return all;
  }

  // The constants after features_of(): those of a film and a mixture.
  using Kind = std::array<uint32_t, 7>;

  // Compiled when first run. Kinds that differ only in constants the program does not read share a
  // kernel.
  const Kernel& kernel_of(Step step) {
    const std::span<const uint32_t> program = kPrograms[static_cast<size_t>(step)];
    const std::set<uint32_t> read = gpu::constants_of(program);
    Kind kind = kind_;
    for (uint32_t i = 0; i < kind.size(); ++i)
      if (!read.contains(static_cast<uint32_t>(features_.size()) + i)) kind[i] = 0;
    const auto key = std::pair(step, kind);
    const auto found = kernels_.find(key);
    if (found != kernels_.end()) return found->second;
    std::vector<uint32_t> constants = features_;
    constants.insert(constants.end(), kind.begin(), kind.end());
    const Kernel kernel(device_, program, memory_, sizeof(shader::StepParameters), constants);
    return kernels_.emplace(key, kernel).first->second;
  }

  void scan(gpu::Commands& c, const Kernel& kernel, uint32_t count) const {
    const uint32_t blocks = shader::scan_blocks(count);
    const auto phase = [&](uint32_t which, uint32_t groups) {
      c.dispatch(kernel, gpu::push(shader::ScanParameters{count, which}), groups);
    };
    phase(shader::SCAN_BLOCKS, blocks);
    phase(shader::SCAN_OF_TOTALS, 1);
    phase(shader::SCAN_SPREAD, blocks);
  }

  Device device_;
  const Capacity room_;
  shader::AllSettings settings_host_;
  const std::vector<uint32_t> features_;
  // Guided walks, culling camera, techniques, power heuristic, layers, halves, transparent.
  Kind kind_{};
  gpu::Tables scene_, path_;
  Buffer settings_, film_, totals_;
  const std::vector<Memory> memory_;
  const Kernel scan_flags_, scan_walks_;
  std::map<std::pair<Step, Kind>, Kernel> kernels_;
};

}  // namespace

static uint64_t scene_bytes(const RenderTables& tables) {
  const shader::SceneSpans scene(tables);
  uint64_t bytes = 0;
#define ADD(type, name, array) bytes += scene.array.size_bytes();
  SCENE_TABLES(ADD)
#undef ADD
  return bytes;
}

Capacity capacity_on(const gpu::Device& device, const RenderTables& tables, uint32_t film_words) {
  size_t buffers = 0;
  for (const std::span<const uint32_t> program : kPrograms)
    buffers = std::max(buffers, gpu::storage_buffers_in(program));
  return capacity_on(device.info().name, device.limits(),
                     {scene_bytes(tables), sizeof(uint32_t) * uint64_t{film_words},
                      tables.surfaces.features.layers, buffers});
}

std::unique_ptr<Machine> make_gpu_machine(const gpu::Device& device, const RenderTables& tables,
                                          const Capacity& room, uint32_t film_words) {
  return std::make_unique<GpuMachine>(device, tables, room, film_words);
}

GpuUpload::GpuUpload(const gpu::Device& device, const Vista& vista, const FilmPlanes& planes)
    : device_(device),
      tables_(vista),
      film_words_(
          FilmPlaces(vista.view.film.pixels(), planes, vista.openings.portals.portals()).words),
      room_(capacity_on(device, tables_, film_words_)) {}

std::shared_ptr<SampleRenderer> GpuUpload::renderer(const Vista& vista) {
  tables_.follow(vista);
  return std::make_shared<WavefrontRenderer>(
      vista, make_gpu_machine(device_, tables_, room_, film_words_), device_.info().name);
}

}  // namespace tdpt
