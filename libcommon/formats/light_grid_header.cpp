#include "libcommon/formats/light_grid_header.h"

#include <iterator>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

#include "libcommon/formats/format_version.h"
#include "libcommon/formats/patch_lines.h"

namespace tdpt {
namespace {

constexpr std::string_view kFormat = "light grid";

class HeaderReader {
 public:
  HeaderReader(TextLines& in, LightGridHeader& all) : in_(in), all_(all), grid_(all.grid) {}

  HeaderEnd read() {
    Provenance provenance;
    HeaderEnd end{};
    bool versioned = false;
    size_t cuts = 0, cameras = 0, walls = 0, panes = 0;
    while ((end.more = in_.next())) {
      TextLines ahead = in_;
      if (ahead.rest().front() != '#') break;
      std::string_view key = in_.word().substr(1);
      if (key.empty()) key = in_.word();
      if (key == "tdpt") {
        const std::string first(in_.word());
        const std::string format = fmt::format("{} {}", first, in_.word());
        if (format != kFormat)
          in_.fail(fmt::format("{} as format, expected '{}'", TextLines::found(format), kFormat));
        in_.expect_version(format_version::light_grid);
        versioned = true;
      } else if (key == "cut") {
        keep(grid_.cuts, cuts, kMostCuts, read_cut(cuts, std::max<size_t>(1, cameras)), "cut");
        ++cuts;
      } else if (key == "wall") {
        keep(grid_.walls, walls++, kMostWalls, read_wall(), "wall");
      } else if (key == "pane") {
        keep(grid_.panes, panes++, kMostPanes, read_pane(), "pane");
      } else if (key == "camera") {
        keep(grid_.cameras, cameras++, kMostCameras, patch_lines::read_camera(in_), "camera");
      } else if (key == "rows") {
        end.rows = in_.integer("number of rows", 0, INT64_MAX);
        in_.end();
        in_.expect_whole_lines();
      } else if (key == "made" || key == "from") {
        provenance.lines.push_back(fmt::format("{} {}", key, in_.rest()));
      } else {
        read_fact(key);
      }
    }
    if (!versioned)
      in_.fail_file(fmt::format("no '# tdpt {} {}' line before the first row", kFormat,
                                format_version::light_grid));
    grid_.provenance.inherit(provenance);
    return end;
  }

 private:
  void read_fact(std::string_view key) {
    if (key == "scene") {
      same(all_.has_scene, grid_.scene_hash, std::string(in_.rest()), "scene");
    } else if (key == "grid") {
      same(all_.has_box, std::tie(grid_.origin, grid_.voxel, grid_.dim), read_box(), "grid");
    } else if (key == "kept") {
      same(all_.has_flux_share, grid_.flux_share, read_share(), "share of kept segments");
      in_.end();
    } else if (key == "bottleneck") {
      const std::string_view answer = in_.word();
      if (answer != "yes" && answer != "no")
        in_.fail(TextLines::found(answer) + " as bottleneck, expected yes or no");
      if (answer == "yes") in_.end();
      same(all_.has_answer, std::tie(grid_.bottleneck, grid_.reason),
           std::tuple(answer == "yes", std::string(in_.rest())), "bottleneck");
    }
  }

  template <class There, class Value>
  void same(bool& known, There&& there, const Value& value, const char* what) const {
    if (known && !(there == value)) contradicts(what);
    known = true;
    there = value;
  }
  [[noreturn]] void contradicts(const char* what) const {
    in_.fail(fmt::format("another {} than above or in another table, expected the same", what));
  }

  // Origin, side of a voxel, voxels along each side.
  std::tuple<Vec3d, double, std::array<int, 3>> read_box() {
    const Vec3d origin = patch_lines::read_vec3(in_, "origin of the grid");
    const double voxel = in_.real("side of a voxel");
    for (int c = 0; c < 3; ++c)
      if (!(voxel > 0 && std::abs(origin[c]) + kMostVoxelsPerSide * voxel < 1e36))
        in_.fail("voxels of no size that single precision holds, expected a side above 0");
    std::array<int, 3> dim;
    size_t total = 1;
    for (int& side : dim) {
      side = static_cast<int>(in_.integer("voxels along a side", 0, kMostVoxelsPerSide));
      total *= static_cast<size_t>(side);
    }
    if (total > kMostVoxels)
      in_.fail(fmt::format("{} voxels, expected at most {}", total, kMostVoxels));
    in_.end();
    return {origin, voxel, dim};
  }

  // Number `n` of a list that all tables share, of at most `most`.
  template <class T>
  void keep(std::vector<T>& list, size_t n, size_t most, const T& value, const char* what) const {
    if (n == most) in_.fail(fmt::format("one {} more than {}", what, most));
    if (n == list.size()) list.push_back(value);
    if (!(list[n] == value)) contradicts(what);
  }

  Vec3d read_wall() {
    const Vec3d wall = patch_lines::read_vec3(in_, "wall");
    in_.end();
    if (!(std::abs(length(wall) - 1) < 1e-6))
      in_.fail(fmt::format("a wall that is {} long, expected a unit vector", length(wall)));
    return wall;
  }

  GridPane read_pane() {
    GridPane pane;
    for (Vec3d* const face : {&pane.front, &pane.back}) *face = patch_lines::read_vec3(in_, "pane");
    in_.end();
    if (!is_pane(pane))
      in_.fail("a pane without thickness, expected two places apart from each other");
    return pane;
  }

  double read_share() {
    const double share = in_.real("share");
    if (!(share >= 0 && share <= 1)) in_.fail(fmt::format("{} as share, expected 0 to 1", share));
    return share;
  }

  // Line `n` of the table of cuts.
  CutFigures read_cut(size_t n, size_t cameras) {
    in_.integer("cut", static_cast<int64_t>(n), static_cast<int64_t>(n));
    CutFigures figures;
    for (double* const share : {&figures.conductance, &figures.kept}) *share = read_share();
    if (in_.more())
      figures.camera = static_cast<uint32_t>(
          in_.integer("camera of the cut", 1, static_cast<int64_t>(cameras)) - 1);
    in_.end();
    return figures;
  }

  TextLines& in_;
  LightGridHeader& all_;
  LightGrid& grid_;
};

}  // namespace

std::string header_of(const LightGrid& grid) {
  std::string out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "# tdpt {} {}\n", kFormat, format_version::light_grid);
  for (const std::string& line : grid.provenance.lines) fmt::format_to(to, "# {}\n", line);
  if (!grid.scene_hash.empty()) fmt::format_to(to, "# scene {}\n", grid.scene_hash);
  for (const std::string& camera : grid.cameras) fmt::format_to(to, "# camera {}\n", camera);
  fmt::format_to(to, "# grid {} {} {} {} {} {} {}\n", grid.origin.x, grid.origin.y, grid.origin.z,
                 grid.voxel, grid.dim[0], grid.dim[1], grid.dim[2]);
  fmt::format_to(to, "# bottleneck {}\n", grid.bottleneck ? "yes" : "no " + grid.reason);
  if (grid.flux_share != 1) fmt::format_to(to, "# kept {}\n", grid.flux_share);
  for (size_t c = 0; c < grid.cuts.size(); ++c)
    fmt::format_to(to, "# cut {} {} {}{}\n", c, grid.cuts[c].conductance, grid.cuts[c].kept,
                   grid.cameras.size() > 1 ? fmt::format(" {}", grid.cuts[c].camera + 1) : "");
  for (const Vec3d& n : grid.walls) fmt::format_to(to, "# wall {} {} {}\n", n.x, n.y, n.z);
  for (const auto& [f, b] : grid.panes)
    fmt::format_to(to, "# pane {} {} {} {} {} {}\n", f.x, f.y, f.z, b.x, b.y, b.z);
  return out;
}

HeaderEnd read_header(TextLines& in, LightGridHeader& all) {
  return HeaderReader(in, all).read();
}

}  // namespace tdpt
