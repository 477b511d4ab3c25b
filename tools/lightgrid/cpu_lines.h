// A line tracer that runs the kernel on all cores with any ray tracer.
#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "tools/lightgrid/line_kernel.h"

namespace tdpt {

template <class Rays>
class CpuLines : public LineTracer {
 public:
  CpuLines(Rays rays, const Scene& scene, const LineTables& tables, const LightGrid& grid,
           uint64_t seed)
      : LineTracer(scene, tables, grid, seed), rays_(std::move(rays)), sums_(grid.count.size()) {}

  void clear() override { sums_.clear(); }
  void counts(std::vector<uint32_t>& count) override { sums_.counts(count); }
  void take_directions(std::vector<Vec3d>& sum) override { sums_.take_directions(sum); }

 protected:
  void trace_segments(const shader::LightParameters& p, TracedLines& out) override {
    parallel(p, [&](auto& kernel, uint32_t i) { out.fate[i] = kernel.segment(i, out.ends[i]); });
  }
  void trace_tries(const shader::LightParameters& p, std::span<const shader::LineTry> tries,
                   TracedLines& out) override {
    parallel(p, [&](auto& kernel, uint32_t i) {
      out.fate[i] = kernel.try_through(i, tries[i], out.ends[i]);
    });
  }

 private:
  template <class Trace>
  void parallel(const shader::LightParameters& p, const Trace& trace) {
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, p.count, 256), [&](const auto& range) {
      shader::LineKernel<Rays> kernel(rays_, tables_, p, sums_);
      for (uint32_t i = range.begin(); i < range.end(); ++i) trace(kernel, i);
    });
  }

  Rays rays_;
  VoxelSums sums_;
};

}  // namespace tdpt
