#include "tools/tdpt-render/device/gpu_renderer.h"

#include <cstring>
#include <map>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/gpu/kernel.h"
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

// Bytes of PATH_TABLES and PATH_WORDS.
uint64_t path_bytes(const Capacity& room, bool layered) {
  using namespace shader;
  using shader::PortalSegment;
  constexpr uint64_t words_of_film = 0;
#define BYTES(binding, type, name, array, count) \
  +sizeof(type) * uint64_t {                     \
    count                                        \
  }
#define BYTES_OF_WORDS(binding, array, count) \
  +sizeof(uint) * uint64_t {                  \
    count                                     \
  }
  return 0 PATH_TABLES(BYTES) PATH_WORDS(BYTES_OF_WORDS);
#undef BYTES
#undef BYTES_OF_WORDS
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
constexpr std::span<const uint32_t> program_of(Step step) {
  return kPrograms[static_cast<size_t>(step)];
}

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

struct Words {
#define BUFFER(binding, array, count) Buffer array;
  PATH_WORDS(BUFFER)
#undef BUFFER
};
Words words_for(const Capacity& room, uint32_t words_of_film, const Device& device) {
#define BUFFER(binding, array, count) Buffer(device, sizeof(uint32_t) * uint64_t{count}),
  return {PATH_WORDS(BUFFER)};
#undef BUFFER
}

// Bindings are numbered in the order of the list, after the texels and the settings.
#define BINDING(number, type, name, array, count) number,
#define BINDING_OF_WORDS(number, array, count) number,
constexpr uint32_t kBindings[] = {PATH_TABLES(BINDING) PATH_WORDS(BINDING_OF_WORDS)};
#undef BINDING
#undef BINDING_OF_WORDS
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
        film_words_(film_words),
        scene_(uploaded_scene(t, device)),
        path_(room_for_paths(room, t.surfaces.features.layers, device)),
        settings_(device, sizeof(shader::AllSettings)),
        words_(words_for(room, film_words, device)),
        totals_(device, 4 * (uint64_t{shader::scan_blocks(room.flags() + 1)} + 1)),
        memory_(bind()),
        flag_light_(kernel(program_of(Step::flag_light), {})),
        flag_camera_(kernel(program_of(Step::flag_camera), {})),
        gather_(kernel(program_of(Step::gather), {})),
        scan_flags_(device, shader::path_scan_spv, {words_.flags, path_.part(path::ranks), totals_},
                    sizeof(shader::ScanParameters)),
        scan_walks_(device, shader::path_scan_spv,
                    {words_.walk_counts, path_.part(path::end_first), totals_},
                    sizeof(shader::ScanParameters)) {
    std::vector<uint32_t> firsts = path_.first_texels();
    const std::vector<uint32_t> of_scene = scene_.first_texels();
    firsts.insert(firsts.end(), of_scene.begin(), of_scene.end());
    std::memcpy(&settings_host_.first_texels, firsts.data(), firsts.size() * sizeof(uint32_t));
    device_.run([&](gpu::Commands& c) { c.clear(words_.film_words); });
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

  // Drivers may defer work to the first dispatch: an empty one triggers it.
  void prepare(const std::vector<Step>& steps, ProgressBar& progress) override {
    for (const Step step : steps) {
      const Kernel& kernel = kernel_of(static_cast<size_t>(step));
      device_.run(
          [&](gpu::Commands& c) { c.dispatch(kernel, gpu::push(shader::StepParameters{}), 1); });
      progress.advance();
    }
  }

  void run(Step step, const shader::StepParameters& p) override {
    if (p.count == 0) return;
    const Kernel& kernel = kernel_of(static_cast<size_t>(step));
    device_.run([&](gpu::Commands& c) { c.dispatch(kernel, gpu::push(p), groups_of(p.count)); });
  }

  uint32_t gather(bool of_light, uint32_t first, uint32_t count) override {
    const shader::StepParameters p{count, first, 0};
    device_.run([&](gpu::Commands& c) {
      c.dispatch(of_light ? flag_light_ : flag_camera_, gpu::push(p), groups_of(count));
      scan(c, scan_flags_, count);
      c.dispatch(gather_, gpu::push(p), groups_of(count));
    });
    return total(count);
  }

  uint32_t pick(uint32_t count) override {
    if (count == 0) return 0;
    device_.run([&](gpu::Commands& c) {
      scan(c, scan_flags_, count);
      c.dispatch(gather_, gpu::push(shader::StepParameters{count, 0, 0}), groups_of(count));
    });
    return total(count);
  }

  void place_ends(uint32_t walks) override {
    device_.run([&](gpu::Commands& c) { scan(c, scan_walks_, walks + 1); });
  }

  std::vector<uint32_t> take_film() override {
    std::vector<uint32_t> words = words_.film_words.download<uint32_t>(film_words_);
    device_.run([&](gpu::Commands& c) { c.clear(words_.film_words); });
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

  // In the order of PATH_TABLES and PATH_WORDS.
  std::vector<Memory> bind() const {
    std::vector<Memory> all{path_.texels(), scene_.texels(), gpu::Uniforms(settings_)};
#define BIND(binding, type, name, array, count) all.emplace_back(path_.part(path::array));
#define BIND_WORDS(binding, array, count) all.emplace_back(words_.array);
    PATH_TABLES(BIND)
    PATH_WORDS(BIND_WORDS)
#undef BIND
#undef BIND_WORDS
    return all;
  }

  Kernel kernel(std::span<const uint32_t> program, const std::vector<uint32_t>& constants) const {
    return {device_, program, memory_, sizeof(shader::StepParameters), constants};
  }
  // Of a film and a mixture: the constants after features_of().
  using Kind = std::array<uint32_t, 7>;

  // Compiled when first run. Kinds that differ only in constants the program does not read share a
  // kernel.
  const Kernel& kernel_of(size_t step) {
    const std::set<uint32_t> read = gpu::constants_of(kPrograms[step]);
    Kind kind = kind_;
    for (uint32_t i = 0; i < kind.size(); ++i)
      if (!read.contains(static_cast<uint32_t>(features_.size()) + i)) kind[i] = 0;
    const auto key = std::pair(step, kind);
    const auto found = kernels_.find(key);
    if (found != kernels_.end()) return found->second;
    std::vector<uint32_t> constants = features_;
    constants.insert(constants.end(), kind.begin(), kind.end());
    return kernels_.emplace(key, kernel(kPrograms[step], constants)).first->second;
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
  uint32_t total(uint32_t count) const {
    return totals_.download<uint32_t>(1, 4 * uint64_t{shader::scan_blocks(count)}).front();
  }

  Device device_;
  const Capacity room_;
  shader::AllSettings settings_host_;
  const std::vector<uint32_t> features_;
  // Guided walks, culling camera, techniques, power heuristic, layers, halves, transparent.
  Kind kind_{};
  const uint32_t film_words_;
  gpu::Tables scene_, path_;
  Buffer settings_;
  Words words_;
  Buffer totals_;
  const std::vector<Memory> memory_;
  const Kernel flag_light_, flag_camera_, gather_, scan_flags_, scan_walks_;
  std::map<std::pair<size_t, Kind>, Kernel> kernels_;
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
