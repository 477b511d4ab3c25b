#include "tools/tdpt-render/device/gpu_machine.h"

#include <chrono>
#include <map>

#include "libcommon/base/error.h"
#include "libcommon/base/threads.h"
#include "libcommon/gpu/kernel.h"
#include "libcommon/gpu/tables.h"
#include "libcommon/math/sequence.h"
#include "shaders/path_scan.h"
#include "shaders/path_step_arrive_camera.h"
#include "shaders/path_step_arrive_light.h"
#include "shaders/path_step_begin_camera_walks.h"
#include "shaders/path_step_begin_light_walks.h"
#include "shaders/path_step_begin_segments.h"
#include "shaders/path_step_choose_joins.h"
#include "shaders/path_step_choose_next_events.h"
#include "shaders/path_step_choose_seen.h"
#include "shaders/path_step_choose_segments.h"
#include "shaders/path_step_choose_sides.h"
#include "shaders/path_step_choose_splats.h"
#include "shaders/path_step_end_segments.h"
#include "shaders/path_step_estimate_segments.h"
#include "shaders/path_step_flag_camera.h"
#include "shaders/path_step_flag_light.h"
#include "shaders/path_step_flag_lit.h"
#include "shaders/path_step_gather.h"
#include "shaders/path_step_gather_sides.h"
#include "shaders/path_step_go_on_camera.h"
#include "shaders/path_step_go_on_light.h"
#include "shaders/path_step_join.h"
#include "shaders/path_step_join_segments.h"
#include "shaders/path_step_join_sides.h"
#include "shaders/path_step_list_ends.h"
#include "shaders/path_step_list_lit.h"
#include "shaders/path_step_list_starts.h"
#include "shaders/path_step_meet_lights.h"
#include "shaders/path_step_put_segments.h"
#include "shaders/path_step_scatter_ends.h"
#include "shaders/path_step_see.h"
#include "shaders/path_step_trace.h"
#include "shaders/shared/path/scan_layout.h"

namespace tdpt {
namespace {

using gpu::Buffer;
using gpu::Device;
using gpu::Kernel;
using gpu::Memory;

constexpr size_t kOfSteps = static_cast<size_t>(Step::kSteps);

// In the order of Step.
constexpr std::array<std::span<const uint32_t>, kOfSteps> kPrograms{
    shader::path_step_begin_light_walks_spv,
    shader::path_step_begin_camera_walks_spv,
    shader::path_step_go_on_light_spv,
    shader::path_step_go_on_camera_spv,
    shader::path_step_trace_spv,
    shader::path_step_arrive_light_spv,
    shader::path_step_arrive_camera_spv,
    shader::path_step_list_ends_spv,
    shader::path_step_list_starts_spv,
    shader::path_step_meet_lights_spv,
    shader::path_step_begin_segments_spv,
    shader::path_step_end_segments_spv,
    shader::path_step_put_segments_spv,
    shader::path_step_gather_sides_spv,
    shader::path_step_choose_next_events_spv,
    shader::path_step_choose_joins_spv,
    shader::path_step_choose_splats_spv,
    shader::path_step_choose_sides_spv,
    shader::path_step_choose_seen_spv,
    shader::path_step_choose_segments_spv,
    shader::path_step_flag_lit_spv,
    shader::path_step_list_lit_spv,
    shader::path_step_estimate_segments_spv,
    shader::path_step_scatter_ends_spv,
    shader::path_step_see_spv,
    shader::path_step_join_spv,
    shader::path_step_join_sides_spv,
    shader::path_step_join_segments_spv};

struct Settings {
  shader::RenderParameters render;
  shader::GuideParameters guiding;
  shader::LightSettings lights;
  uint32_t first_texels[4 * shader::kFirstTexels];
};
// As std140 has them: what is nested begins and ends at multiples of 16 bytes, an array has
// elements of as many.
static_assert(offsetof(Settings, guiding) % 16 == 0 && offsetof(Settings, lights) % 16 == 0 &&
              offsetof(Settings, first_texels) % 16 == 0 && sizeof(shader::SkyTable) % 16 == 0 &&
              sizeof(Settings) % 16 == 0);

uint32_t groups_of(uint32_t count) {
  return (count + 63) / 64;
}

// Tables of path.tables that kernels read of a submission, and in its order.
enum PathTable : size_t {
  kPoolOffsets,
  kAlive,
  kRanks,
  kEndFirst,
  kWalkLast,
  kVertices,
  kDensities,
  kRays,
  kJoinings,
  kScatterings,
  kEnds,
  kSegments,
  kSides,
  kLitSegments,
  kLitFirst,
  kEstimates,
  kBsdfs
};

gpu::Tables room_for_paths(const Room& room, bool layers, const Device& device) {
  const uint64_t vertices = room.vertices, samples = room.samples, joinings = room.joinings();
  gpu::Tables t;
  t.add_room(4 * kMostOfPool);
  t.add_room(4 * uint64_t{room.flags()});
  t.add_room(4 * uint64_t{room.flags()});
  t.add_room(4 * (samples + 1));
  t.add_room(4 * samples);
  t.add_room(vertices * sizeof(shader::PathVertex));
  t.add_room(vertices * sizeof(shader::PathDensity));
  t.add_room(2 * samples * sizeof(shader::WalkRay));
  t.add_room(joinings * sizeof(shader::Joining));
  t.add_room(2 * joinings * sizeof(shader::Scattering));
  t.add_room((vertices + 2 * samples) * sizeof(shader::JoinEnd));
  t.add_room(samples * sizeof(shader::PortalSegment));
  t.add_room(samples * shader::kSegmentSides * sizeof(shader::SegmentSide));
  t.add_room(4 * samples);
  t.add_room(4 * (samples + 1));
  t.add_room(4 * room.estimates());
  t.add_room(layers ? vertices * sizeof(shader::PathBsdf) : 0);
  t.upload(device);
  return t;
}

// Those of a scene, in the order of path.tables.
gpu::Tables uploaded_scene(const RenderTables& t, const Device& device) {
  const std::vector<shader::uvec4> sobol(shader::sobol_points.begin(), shader::sobol_points.end());
  const SurfaceTables& s = t.surfaces;
  const LightTables& l = t.lights;
  gpu::Tables tables;
  const auto add = [&](const auto&... values) { (tables.add(values), ...); };
  add(t.bvh.nodes, t.bvh.triangles, sobol, s.faces, s.materials, s.material_maps, s.maps,
      s.texel_words, s.face_corners, s.corner_attributes, t.curves, s.coverage.coverage_of,
      s.coverage.coverages);
  add(l.words, l.emitters, l.lamps, l.suns, l.texels, l.panels, l.windows, l.frames);
  add(t.portals.facets, t.portals.polygons, t.portals.corners, t.portals.pairs);
  tables.upload(device);
  return tables;
}

class GpuMachine : public Machine {
 public:
  GpuMachine(const Device& device, const RenderTables& t, const Room& room, uint32_t film_words,
             DeviceWork* work)
      : device_(device),
        room_(room),
        work_(work),
        settings_host_{{}, t.portals.guiding, t.lights.settings, {}},
        features_(features_of(t)),
        film_words_(film_words),
        scene_(uploaded_scene(t, device)),
        path_(room_for_paths(room, t.surfaces.features.layers, device)),
        settings_(device, sizeof(Settings)),
        walk_counts_(device, 4 * (uint64_t{room.samples} + 1)),
        film_(device, 4 * uint64_t{film_words}),
        flags_(device, 4 * (uint64_t{room.flags()} + 1)),
        totals_(device, 4 * (uint64_t{shader::scan_blocks(room.flags() + 1)} + 1)),
        memory_(bind()),
        flag_light_(kernel(shader::path_step_flag_light_spv, {})),
        flag_camera_(kernel(shader::path_step_flag_camera_spv, {})),
        gather_(kernel(shader::path_step_gather_spv, {})),
        scan_flags_(device, shader::path_scan_spv, {flags_, path_.part(kRanks), totals_},
                    sizeof(shader::ScanParameters)),
        scan_walks_(device, shader::path_scan_spv, {walk_counts_, path_.part(kEndFirst), totals_},
                    sizeof(shader::ScanParameters)) {
    std::vector<uint32_t> firsts = path_.first_texels();
    const std::vector<uint32_t> of_scene = scene_.first_texels();
    firsts.insert(firsts.end(), of_scene.begin(), of_scene.end());
    if (firsts.size() > std::size(settings_host_.first_texels))
      throw Error(Exit::internal, "there are more tables than kFirstTexels tells of");
    std::copy(firsts.begin(), firsts.end(), settings_host_.first_texels);
    device_.run([&](gpu::Commands& c) { c.clear(film_); });
  }

  Room room() const override { return room_; }

  void set(const shader::RenderParameters& p, const std::vector<uint32_t>& pool_offsets) override {
    settings_host_.render = p;
    settings_.write(std::as_bytes(std::span(&settings_host_, 1)));
    path_.write(kPoolOffsets, std::as_bytes(std::span(pool_offsets)));
    kind_ = {p.guide_light > 0 || p.guide_camera > 0,
             p.culls != 0,
             p.techniques,
             p.beta == 2,
             p.layers != 0,
             p.transparent != 0};
  }

  // Drivers may leave some of the work to the first dispatch: one of nothing is enough.
  void prepare(const std::vector<Step>& steps, Progress& progress) override {
    const auto start = std::chrono::steady_clock::now();
    for (const Step step : steps) {
      const Kernel& kernel = kernel_of(static_cast<size_t>(step));
      device_.run(
          [&](gpu::Commands& c) { c.dispatch(kernel, gpu::push(shader::StepParameters{}), 1); });
      progress.advance();
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (work_) work_->making += took.count();
  }

  void run(Step step, const shader::StepParameters& p) override {
    if (p.count == 0) return;
    const size_t i = static_cast<size_t>(step);
    const Kernel& kernel = kernel_of(i);
    const double seconds =
        timed([&](gpu::Commands& c) { c.dispatch(kernel, gpu::push(p), groups_of(p.count)); });
    if (work_) add(work_->steps[i], seconds, p.count);
  }

  uint32_t gather(bool of_light, uint32_t first, uint32_t count) override {
    const shader::StepParameters p{count, first, 0};
    const double seconds = timed([&](gpu::Commands& c) {
      c.dispatch(of_light ? flag_light_ : flag_camera_, gpu::push(p), groups_of(count));
      scan(c, scan_flags_, count);
      c.dispatch(gather_, gpu::push(p), groups_of(count));
    });
    if (work_) add(work_->gather, seconds, count);
    return total(count);
  }

  uint32_t pick(uint32_t count) override {
    if (count == 0) return 0;
    const double seconds = timed([&](gpu::Commands& c) {
      scan(c, scan_flags_, count);
      c.dispatch(gather_, gpu::push(shader::StepParameters{count, 0, 0}), groups_of(count));
    });
    if (work_) add(work_->gather, seconds, count);
    return total(count);
  }

  void place_ends(uint32_t walks) override {
    const double seconds = timed([&](gpu::Commands& c) { scan(c, scan_walks_, walks + 1); });
    if (work_) add(work_->gather, seconds, walks);
  }

  std::vector<uint32_t> take_film() override {
    std::vector<uint32_t> words = film_.download<uint32_t>(film_words_);
    device_.run([&](gpu::Commands& c) { c.clear(film_); });
    return words;
  }

 private:
  static void add(StepWork& to, double seconds, uint32_t invocations) {
    to.seconds += seconds;
    ++to.runs;
    to.invocations += invocations;
  }
  double timed(const std::function<void(gpu::Commands&)>& record) {
    const bool of_cores = device_.info().kind == "cpu";
    const double before = of_cores ? cpu_seconds() : 0;
    const double seconds = device_.run(record);
    return of_cores ? cpu_seconds() - before : seconds;
  }

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
            t.lights.has_panels,
            t.lights.has_windows,
            t.lights.prefers,
            !t.portals.facets.empty(),
            !t.portals.pairs.empty()};
  }

  // In the order of shaders/path_bindings.glsl.
  std::vector<Memory> bind() const {
    const auto written = [&](PathTable table) { return path_.part(table); };
    return {path_.texels(),
            scene_.texels(),
            gpu::Uniforms(settings_),
            written(kVertices),
            written(kBsdfs),
            written(kDensities),
            walk_counts_,
            written(kWalkLast),
            written(kAlive),
            written(kRays),
            written(kEnds),
            written(kJoinings),
            written(kScatterings),
            written(kSegments),
            written(kSides),
            film_,
            flags_,
            written(kLitSegments),
            written(kLitFirst),
            written(kEstimates)};
  }

  Kernel kernel(std::span<const uint32_t> program, const std::vector<uint32_t>& constants) const {
    return {device_, program, memory_, sizeof(shader::StepParameters), constants};
  }
  // Made when they are first run. Those of kinds that differ in nothing that the program reads are
  // one.
  const Kernel& kernel_of(size_t step) {
    const std::set<uint32_t> read = gpu::constants_of(kPrograms[step]);
    std::array<uint32_t, 6> kind = kind_;
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
  const Room room_;
  DeviceWork* const work_;  // or none
  Settings settings_host_;
  const std::vector<uint32_t> features_;
  // Walks are directed, the camera culls, techniques, power heuristic, layers, transparent.
  std::array<uint32_t, 6> kind_{};
  const uint32_t film_words_;
  gpu::Tables scene_, path_;
  Buffer settings_, walk_counts_, film_, flags_, totals_;
  const std::vector<Memory> memory_;
  const Kernel flag_light_, flag_camera_, gather_, scan_flags_, scan_walks_;
  std::map<std::pair<size_t, std::array<uint32_t, 6>>, Kernel> kernels_;
};

}  // namespace

std::array<std::vector<gpu::Statistic>, kOfSteps> step_statistics(const gpu::Device& device,
                                                                  bool least) {
  // In the order of features_of() and kind_.
  std::vector<uint32_t> constants;
  if (least) {
    constants.assign(19, 0);
    constants[17] = 1;  // portals
    constants.insert(constants.end(), {1, 0, 31, 0, 0, 0});
  }
  std::array<std::vector<gpu::Statistic>, kOfSteps> all;
  for (size_t i = 0; i < kOfSteps; ++i)
    all[i] = statistics_of(device, kPrograms[i], sizeof(shader::StepParameters), constants);
  return all;
}

Room room_on(const gpu::Device& device, const RenderTables& tables, uint32_t film_words) {
  size_t buffers = 0;
  for (const std::span<const uint32_t> program : kPrograms)
    buffers = std::max(buffers, gpu::storage_buffers_in(program));
  return room_on(device.info().name, device.limits(),
                 {shares_of(tables), sizeof(uint32_t) * uint64_t{film_words},
                  tables.surfaces.features.layers, buffers});
}

std::unique_ptr<Machine> make_gpu_machine(const gpu::Device& device, const RenderTables& tables,
                                          const Room& room, uint32_t film_words, DeviceWork* work) {
  return std::make_unique<GpuMachine>(device, tables, room, film_words, work);
}

}  // namespace tdpt
