// Lines of light on a Vulkan device: compute kernels sample or trace, vote and march; stream
// compaction on the device connects them.
//
// A submission samples or traces some lines and lists those that survive; the next two kernels run
// on these lists only, which keeps work groups full: the votes cost more than everything else, and
// few traced lines reach them.
#include <algorithm>

#include "libcommon/gpu/kernel.h"
#include "libcommon/scene/surface_tables.h"
#include "libcommon/trace/bvh.h"
#include "shaders/light_march.h"
#include "shaders/light_segments.h"
#include "shaders/light_through.h"
#include "shaders/light_votes.h"
#include "tools/lightgrid/line_tracer.h"

namespace tdpt {
namespace {

// Target duration of a submission [s]: drivers reset devices that are busy for longer than about
// two.
constexpr double kLeast = 0.05, kMost = 0.2;
constexpr uint32_t kFirstLines = 1 << 13;

class GpuLines : public LineTracer {
 public:
  GpuLines(const gpu::Device& device, const Scene& scene, const LineTables& tables,
           const LightGrid& grid, uint64_t seed, uint32_t most_lines)
      : GpuLines(device, build_bvh(scene), make_coverages(scene), scene, tables, grid, seed,
                 most_lines) {}

  void clear() override { clear_images(0); }
  void counts(std::vector<uint32_t>& count) override { count = images_[0].download(); }
  void take_directions(std::vector<Vec3d>& sum) override {
    for (int c = 0; c < 3; ++c) {
      const std::vector<uint32_t> units = images_[static_cast<size_t>(c) + 1].download();
      for (size_t i = 0; i < sum.size(); ++i)
        sum[i][c] += static_cast<int32_t>(units[i]) * (1 / double{LIGHT_DIRECTION_UNITS});
    }
    clear_images(1);
  }

 protected:
  void trace_segments(const shader::LightParameters& p, TracedLines& out) override {
    for_pieces(p, out, [&](const shader::LightParameters& piece) {
      return device_.run([&](gpu::Commands& c) {
        trace_with(segments_, piece, c);
        vote(piece, c);
        c.dispatch_indirect(march_, gpu::push(piece), lists_, offsetof(Lists, to_march));
      });
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
           uint32_t most_lines)
      : LineTracer(scene, tables, grid, seed),
        device_(device),
        most_lines_(most_lines),
        lines_in_submission_(std::min(kFirstLines, most_lines)),
        tries_(device, most_lines * sizeof(shader::LineTry)),
        lines_(device, most_lines * sizeof(shader::LineEnds)),
        fates_(device, most_lines * sizeof(uint32_t)),
        lists_(device, sizeof(Lists) + 2 * most_lines * sizeof(uint32_t)),
        images_(make_images(grid)),
        bound_(bind(bvh, coverage, tables)),
        features_{!coverage.coverages.empty(), !coverage.texels.empty()},
        segments_(kernel(shader::light_segments_spv)),
        through_(kernel(shader::light_through_spv)),
        votes_(kernel(shader::light_votes_spv)),
        march_(kernel(shader::light_march_spv)) {}

  std::vector<gpu::Image3D> make_images(const LightGrid& grid) const {
    const std::array<uint32_t, 3> size{static_cast<uint32_t>(grid.dim[0]),
                                       static_cast<uint32_t>(grid.dim[1]),
                                       static_cast<uint32_t>(grid.dim[2])};
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
    std::vector<gpu::Memory> bound{scene.texels(), of(firsts).uniforms()};
#define BIND(binding, type, array) bound.emplace_back(of(t.array));
    LIGHT_CUTS(BIND)
#undef BIND
    bound.insert(bound.end(), {tries_, lines_, fates_, lists_});
    bound.insert(bound.end(), images_.begin(), images_.end());
    return bound;
  }

  gpu::Kernel kernel(std::span<const uint32_t> program) const {
    return {device_, program, bound_, sizeof(shader::LightParameters), features_};
  }

  static void trace_with(const gpu::Kernel& kernel, const shader::LightParameters& p,
                         gpu::Commands& c) {
    c.dispatch(kernel, gpu::push(p), (p.count + LIGHT_GROUP - 1) / LIGHT_GROUP);
  }
  void vote(const shader::LightParameters& p, gpu::Commands& c) const {
    c.dispatch_indirect(votes_, gpu::push(p), lists_, offsetof(Lists, to_vote));
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
        lines_in_submission_ = std::min(2 * lines_in_submission_, most_lines_);
    }
  }

  void clear_images(size_t from) {
    device_.run([&](gpu::Commands& c) {
      for (size_t i = from; i < images_.size(); ++i) c.clear(images_[i]);
    });
  }

  gpu::Device device_;
  const uint32_t most_lines_;
  uint32_t lines_in_submission_;
  gpu::Buffer tries_, lines_, fates_, lists_;
  std::vector<gpu::Image3D> images_;  // counts, then directions along x, y, z
  const std::vector<gpu::Memory> bound_;
  const std::vector<uint32_t> features_;  // constants of light_bindings.glsl
  const gpu::Kernel segments_, through_, votes_, march_;
};

}  // namespace

std::unique_ptr<LineTracer> make_gpu_lines(const gpu::Device& device, const Scene& scene,
                                           const LineTables& tables, const LightGrid& grid,
                                           uint64_t seed, uint32_t most_lines) {
  return std::make_unique<GpuLines>(device, scene, tables, grid, seed, most_lines);
}

}  // namespace tdpt
