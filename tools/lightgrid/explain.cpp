#include "tools/lightgrid/explain.h"

#include <fmt/format.h>

#include "libcommon/scene/uses.h"

#include "libcommon/base/counted.h"
#include "libcommon/base/number_words.h"

namespace tdpt {
namespace {

using cli::Decision;
using cli::Decisions;

Decision of_box(const Scene& scene, const LightGrid& grid, const LightGridOptions& options,
                const LightGridReport& report) {
  const Vec3d whole = box_of(scene).size() / scene.frame.scale;
  const Vec3d side = Vec3d(grid.dim[0], grid.dim[1], grid.dim[2]) * grid.voxel;
  return {"grid",
          fmt::format("{} x {} x {} voxels of {} m", grid.dim[0], grid.dim[1], grid.dim[2],
                      number_words(grid.voxel)),
          fmt::format("the patches of the cut reach over {} x {} x {} m of {} x "
                      "{} x {} m, and --resolution is {}",
                      number_words(side.x), number_words(side.y), number_words(side.z),
                      number_words(whole.x), number_words(whole.y), number_words(whole.z),
                      options.resolution),
          fmt::format("{:.1f} MiB; air marked in {}",
                      static_cast<double>(grid.count.size()) *
                          (sizeof(float) + 1 + sizeof(Vec3f) + sizeof(Vec3d)) / (1 << 20),
                      cli::price_of(report.phases, {"air"}))};
}

Decision of_batches(const std::string& cut, const LightGridReport::OfCut& c,
                    const LightGridOptions& options) {
  if (c.drawn == 0) return {cut, "nothing drawn", "no pair of it has any surface", "no segment"};
  const std::string change = fmt::format("the counts changed by {:.1f} %, {:.0f} % is settled",
                                         100 * c.change, 100 * options.tolerance);
  return {cut + ", segments", "stopped after " + counted(c.batches, "batch"),
          c.settled                    ? change
          : c.drawn >= options.samples ? fmt::format("{} are the most: ", options.samples) + change
                                       : "a signal came: " + change,
          counted(c.drawn, "segment")};
}

Decision of_leaks(const std::string& cut, const LightGridReport::OfCut& c) {
  return {cut + ", leaks", fmt::format("{} of {} visible segments kept", c.kept, c.visible),
          "short rays around the ends of the others see the wrong side of the cut",
          fmt::format("{} hidden ones dropped", c.drawn - c.visible)};
}

Decision of_lines(const std::string& cut, const LightGridReport::OfCut& c,
                  const LightGridOptions& options) {
  if (c.kept == 0)
    return {cut + ", lines", "none", "no segment joins the two sides", "no fine pass"};
  return {
      cut + ", lines", fmt::format("{} kept", c.lines),
      fmt::format("--set lines allows {}, and {} of {} drawn through the light join the two sides",
                  options.lines, c.joined, c.tried),
      counted(c.tried, "line") + " tried"};
}

}  // namespace

Decisions decisions_of(const Scene& scene, const LightGrid& grid, const LightGridOptions& options,
                       const LightGridReport& report, const std::string& device) {
  Decisions all = uses_of(scene, {"transmission", "alpha", "a sky"});
  if (report.drawn == 0) {
    all.push_back({"light grid", "empty", grid.reason, "nothing is traced"});
    return all;
  }
  if (grid.bottleneck) all.push_back(of_box(scene, grid, options, report));
  all.push_back({"lines", "traced by " + device, "--device says so or is not given",
                 fmt::format("coarse {}, fine {}", cli::price_of(report.phases, {"coarse"}),
                             cli::price_of(report.phases, {"fine"}))});
  for (size_t c = 0; c < report.cuts.size(); ++c) {
    const std::string cut = fmt::format("cut {}", c + 1);
    if (!options.own.empty()) {
      all.push_back({cut + ", lines", fmt::format("{} kept", report.cuts[c].lines),
                     "--lines-from gives them", counted(report.cuts[c].tried, "line") + " tried"});
      continue;
    }
    all.push_back(of_batches(cut, report.cuts[c], options));
    if (report.cuts[c].drawn == 0) continue;
    all.push_back(of_leaks(cut, report.cuts[c]));
    all.push_back(of_lines(cut, report.cuts[c], options));
  }
  if (!grid.bottleneck)
    all.push_back({"light grid", "empty", grid.reason, "portalfit has nothing to do"});
  return all;
}

}  // namespace tdpt
