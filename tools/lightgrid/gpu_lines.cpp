// Lines of light on a Vulkan device: compute kernels sample or trace, vote and march; stream
// compaction on the device connects them.
//
// A submission samples or traces some lines and lists those that survive; the next two kernels run
// on these lists only, which keeps work groups full: the votes cost more than everything else, and
// few traced lines reach them.
//
// If the four images of the grid do not fit, they hold one slab of it: each submission then marches
// its lines once per slab, and the host keeps the sums.
#include "tools/lightgrid/gpu_lines.h"

#include <algorithm>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/gpu/kernel.h"
#include "libcommon/scene/surface_tables.h"
#include "libcommon/trace/bvh.h"
#include "shaders/light_march.h"
#include "shaders/light_segments.h"
#include "shaders/light_segments_opaque.h"
#include "shaders/light_segments_untextured.h"
#include "shaders/light_through.h"
#include "shaders/light_through_opaque.h"
#include "shaders/light_through_untextured.h"
#include "shaders/light_votes.h"
#include "shaders/light_votes_opaque.h"
#include "shaders/light_votes_untextured.h"

namespace tdpt {
namespace {

// Target duration of a submission [s]: drivers reset devices that are busy for longer than about
// two.
constexpr double kLeast = 0.05, kMost = 0.2;
constexpr uint32_t kFirstLines = 1 << 13;
constexpr uint64_t kVoxelBytes = 16;  // for the four images

// Variants of a kernel for scenes that need all of coverage.h, none of it, or all but textures.
struct Variants {
  std::span<const uint32_t> all, opaque, untextured;
  std::span<const uint32_t> of(const CoverageTables& coverage) const {
    return coverage.coverages.empty() ? opaque : coverage.texels.empty() ? untextured : all;
  }
};
constexpr Variants kSegments{shader::light_segments_spv, shader::light_segments_opaque_spv,
                             shader::light_segments_untextured_spv},
    kThrough{shader::light_through_spv, shader::light_through_opaque_spv,
             shader::light_through_untextured_spv},
    kVotes{shader::light_votes_spv, shader::light_votes_opaque_spv,
           shader::light_votes_untextured_spv};

class GpuLines : public LineTracer {
 public:
  GpuLines(const gpu::Device& device, const Scene& scene, const LineTables& tables,
           const LightGrid& grid, uint64_t seed, const GpuLineBounds& bounds)
      : GpuLines(device, build_bvh(scene), make_coverages(scene), scene, tables, grid, seed,
                 bounds) {}

  void clear() override {
    std::fill(count_.begin(), count_.end(), 0u);
    std::fill(direction_.begin(), direction_.end(), Vec3d());
    device_.run([&](gpu::Commands& c) { clear_images(c, 0); });
  }

  void counts(std::vector<uint32_t>& count) override {
    if (slabs() == 1)
      count = images_[0].download();
    else
      count = count_;
  }

  void take_directions(std::vector<Vec3d>& sum) override {
    if (slabs() == 1) {
      add_directions(0, sum);
      device_.run([&](gpu::Commands& c) { clear_images(c, 1); });
      return;
    }
    for (size_t i = 0; i < sum.size(); ++i) {
      sum[i] += direction_[i];
      direction_[i] = {};
    }
  }

 protected:
  void trace_segments(const shader::LightParameters& p, TracedLines& out) override {
    for_pieces(p, out, [&](const shader::LightParameters& piece) {
      const double seconds = device_.run([&](gpu::Commands& c) {
        trace_with(segments_, piece, c);
        vote(piece, c);
        if (slabs() == 1) march(piece, c);
      });
      if (slabs() > 1) march_slabs(piece);
      return seconds;
    });
  }

  void trace_tries(const shader::LightParameters& p, std::span<const shader::LineTry> tries,
                   TracedLines& out) override {
    for_pieces(p, out, [&](const shader::LightParameters& piece) {
      tries_.write(std::as_bytes(tries.subspan(piece.first - p.first, piece.count)));
      return device_.run([&](gpu::Commands& c) {
        trace_with(through_, piece, c);
        vote(piece, c);
      });
    });
  }

 private:
  struct Lists {
    shader::LightList to_vote, to_march;
  };

  GpuLines(const gpu::Device& device, const Bvh& bvh, const CoverageTables& coverage,
           const Scene& scene, const LineTables& tables, const LightGrid& grid, uint64_t seed,
           const GpuLineBounds& bounds)
      : LineTracer(scene, tables, grid, seed),
        device_(device),
        bounds_(bounds),
        lines_in_submission_(std::min(kFirstLines, bounds.lines)),
        depth_(slab_depth(device.info().name, device.limits(), grid, bounds.voxels)),
        tries_(device, bounds.lines * sizeof(shader::LineTry)),
        lines_(device, bounds.lines * sizeof(shader::LineEnds)),
        fates_(device, bounds.lines * sizeof(uint32_t)),
        lists_(device, sizeof(Lists) + 2 * bounds.lines * sizeof(uint32_t)),
        images_(make_images(grid)),
        bound_(bind(bvh, coverage, tables)),
        segments_(kernel(kSegments.of(coverage))),
        through_(kernel(kThrough.of(coverage))),
        votes_(kernel(kVotes.of(coverage))),
        march_(kernel(shader::light_march_spv)) {
    if (slabs() == 1) return;
    count_.resize(grid.count.size());
    direction_.resize(grid.count.size());
  }

  std::vector<gpu::Image3D> make_images(const LightGrid& grid) const {
    const std::array<uint32_t, 3> size{static_cast<uint32_t>(grid.dim[0]),
                                       static_cast<uint32_t>(grid.dim[1]), depth_};
    std::vector<gpu::Image3D> images;
    for (const gpu::Texel texel :
         {gpu::Texel::r32ui, gpu::Texel::r32i, gpu::Texel::r32i, gpu::Texel::r32i})
      images.emplace_back(device_, size, texel);
    return images;
  }

  // In the order of light_layout.h.
  std::vector<gpu::Memory> bind(const Bvh& bvh, const CoverageTables& coverage,
                                const LineTables& t) const {
    gpu::Tables scene;
    const auto add = [&](const auto&... values) { (scene.add(values), ...); };
    add(bvh.nodes, bvh.triangles, coverage.coverage_of, coverage.coverages, coverage.texels);
    scene.upload(device_);
    std::vector<uint32_t> firsts = scene.first_texels();
    firsts.resize((sizeof(shader::LightFirstTexels) + 15) / 16 * 4);
    const auto of = [&](const auto& values) { return gpu::Buffer(device_, values); };
    std::vector<gpu::Memory> bound{scene.texels(), gpu::Uniforms(of(firsts))};
#define BIND(binding, type, array) bound.emplace_back(of(t.array));
    LIGHT_CUTS(BIND)
#undef BIND
    bound.insert(bound.end(), {tries_, lines_, fates_, lists_});
    bound.insert(bound.end(), images_.begin(), images_.end());
    return bound;
  }

  gpu::Kernel kernel(std::span<const uint32_t> program) const {
    return {device_, program, bound_, sizeof(shader::LightParameters)};
  }

  uint32_t slabs() const {
    return (static_cast<uint32_t>(common_.dim.z) + depth_ - 1) / depth_;
  }

  static void trace_with(const gpu::Kernel& kernel, const shader::LightParameters& p,
                         gpu::Commands& c) {
    c.dispatch(kernel, gpu::push(p), (p.count + LIGHT_GROUP - 1) / LIGHT_GROUP);
  }
  void vote(const shader::LightParameters& p, gpu::Commands& c) const {
    c.dispatch_indirect(votes_, gpu::push(p), lists_, offsetof(Lists, to_vote));
  }
  void march(const shader::LightParameters& p, gpu::Commands& c) const {
    c.dispatch_indirect(march_, gpu::push(p), lists_, offsetof(Lists, to_march));
  }

  // Calls trace(parameters) in portions that keep a submission short, and fetches the results;
  // trace returns the seconds that the submission took.
  template <class Trace>
  void for_pieces(const shader::LightParameters& p, TracedLines& out, const Trace& trace) {
    static const std::vector<Lists> kEmpty{{{0, 1, 1, 0}, {0, 1, 1, 0}}};
    for (uint32_t done = 0; done < p.count;) {
      shader::LightParameters piece = p;
      piece.first = p.first + done;
      piece.count = std::min(p.count - done, lines_in_submission_);
      lists_.write(std::as_bytes(std::span(kEmpty)));
      const double seconds = trace(piece);
      lines_.read(std::as_writable_bytes(std::span(out.ends).subspan(done, piece.count)));
      fates_.read(std::as_writable_bytes(std::span(out.fate).subspan(done, piece.count)));
      done += piece.count;
      if (seconds > kMost)
        lines_in_submission_ = std::max(lines_in_submission_ / 2, 1u);
      else if (seconds < kLeast && piece.count == lines_in_submission_)
        lines_in_submission_ = std::min(2 * lines_in_submission_, bounds_.lines);
    }
  }

  void march_slabs(shader::LightParameters p) {
    const size_t layer = static_cast<size_t>(p.dim.x) * static_cast<size_t>(p.dim.y);
    for (uint32_t s = 0; s < slabs(); ++s) {
      const Slab slab = slab_of(s, depth_, p.dim.z);
      p.slab_low = slab.low;
      p.slab_high = slab.high;
      device_.run([&](gpu::Commands& c) {
        clear_images(c, 0);
        march(p, c);
      });
      const size_t first = layer * static_cast<size_t>(p.slab_low);
      const std::vector<uint32_t> count = images_[0].download();
      for (size_t i = 0; i < count.size() && first + i < count_.size(); ++i)
        count_[first + i] += count[i];
      add_directions(first, direction_);
    }
  }

  // Adds the directions in the images, whose first voxel is `first`.
  void add_directions(size_t first, std::vector<Vec3d>& sum) const {
    for (int c = 0; c < 3; ++c) {
      const std::vector<uint32_t> units = images_[static_cast<size_t>(c) + 1].download();
      for (size_t i = 0; i < units.size() && first + i < sum.size(); ++i)
        sum[first + i][c] += static_cast<int32_t>(units[i]) * (1 / double{LIGHT_DIRECTION_UNITS});
    }
  }

  void clear_images(gpu::Commands& commands, size_t from) const {
    for (size_t i = from; i < images_.size(); ++i) commands.clear(images_[i]);
  }

  gpu::Device device_;
  const GpuLineBounds bounds_;
  uint32_t lines_in_submission_;
  const uint32_t depth_;
  gpu::Buffer tries_, lines_, fates_, lists_;
  std::vector<gpu::Image3D> images_;  // counts, then directions along x, y, z
  const std::vector<gpu::Memory> bound_;
  const gpu::Kernel segments_, through_, votes_, march_;
  // Used with slabs only.
  std::vector<uint32_t> count_;
  std::vector<Vec3d> direction_;
};

}  // namespace

uint32_t slab_depth(const std::string& device, const gpu::Limits& limits, const LightGrid& grid,
                    uint64_t most_voxels) {
  for (const int side : {grid.dim[0], grid.dim[1]})
    if (static_cast<uint32_t>(side) > limits.image_side)
      throw Error(Exit::no_device,
                  fmt::format("{}: the grid has {} voxels along one side, the device's images at "
                              "most {}",
                              device, side, limits.image_side));
  const auto layer = static_cast<uint64_t>(grid.dim[0]) * static_cast<uint64_t>(grid.dim[1]);
  // Half of the memory is left to the scene and to other programs.
  const uint64_t voxels =
      std::min({most_voxels, limits.image / sizeof(uint32_t), limits.memory / 2 / kVoxelBytes});
  return static_cast<uint32_t>(std::clamp<uint64_t>(
      voxels / layer, 1,
      std::min<uint64_t>(static_cast<uint64_t>(grid.dim[2]), limits.image_side)));
}

std::unique_ptr<LineTracer> make_gpu_lines(const gpu::Device& device, const Scene& scene,
                                           const LineTables& tables, const LightGrid& grid,
                                           uint64_t seed, const GpuLineBounds& bounds) {
  return std::make_unique<GpuLines>(device, scene, tables, grid, seed, bounds);
}

}  // namespace tdpt
