// Lines shared by the formats of networks (.max) and cuts (.cut): the grid, the patches and their
// faces.
#pragma once
#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>

#include "libcommon/formats/cut.h"
#include "libcommon/formats/text_lines.h"
#include "libcommon/formats/viewpoint.h"
#include "libcommon/scene/sky_bins.h"

namespace tdpt::patch_lines {

inline constexpr int kDeepestLevel = 10;
inline constexpr size_t kFacesPerLine = 16;

inline Vec3d read_vec3(TextLines& in, const char* what) {
  const double x = in.real(what);
  const double y = in.real(what);
  const double z = in.real(what);
  return {x, y, z};
}

/// `camera ...` [viewpoint.h], after its keyword.
inline std::string read_camera(TextLines& in) {
  const std::string_view text = in.rest();
  if (!parse_viewpoint(text)) in.fail(TextLines::found(text) + " as camera, " + kViewpointExpected);
  return std::string(text);
}

/// The same, appended to those of the lines above.
inline void add_camera(TextLines& in, std::vector<std::string>& cameras) {
  cameras.push_back(read_camera(in));
  if (cameras.size() > kMostCameras)
    in.fail(fmt::format("one camera more than {}, expected no more", kMostCameras));
}

/// `grid X Y Z CELL`, after its keyword.
inline PatchGrid read_grid(TextLines& in) {
  PatchGrid grid;
  grid.origin = read_vec3(in, "origin of the grid");
  grid.base_cell = in.real("side of a cell");
  if (!(grid.base_cell > 0)) in.fail("a cell without size, expected a side above 0");
  in.end();
  return grid;
}

inline void write_grid(std::string& out, const char* head, const PatchGrid& g) {
  fmt::format_to(std::back_inserter(out), "{} {} {} {} {}\n", head, g.origin.x, g.origin.y,
                 g.origin.z, g.base_cell);
}

/// LEVEL I J K SAMPLES CX CY CZ NX NY NZ, after the node.
inline void read_patch(TextLines& in, Patch& p) {
  p.level = static_cast<int>(in.integer("level of the patch", 0, kDeepestLevel));
  for (int32_t& c : p.cell)
    c = static_cast<int32_t>(in.integer("cell of the patch", INT32_MIN, INT32_MAX));
  p.samples = in.real("samples of the patch");
  if (p.samples < 0) in.fail("a negative number of samples, expected 0 or more");
  p.centre = read_vec3(in, "centre of the patch");
  p.normal = read_vec3(in, "normal of the patch");
  if (!(std::abs(length(p.normal) - 1) < 1e-3))
    in.fail("a normal of another length, expected length 1");
  p.normal = normalize(p.normal);
  in.end();
}

inline void write_patch(std::string& out, const Patch& p) {
  fmt::format_to(std::back_inserter(out), "{} {} {} {} {} {} {} {} {:.6f} {:.6f} {:.6f}\n", p.level,
                 p.cell[0], p.cell[1], p.cell[2], p.samples, p.centre.x, p.centre.y, p.centre.z,
                 p.normal.x, p.normal.y, p.normal.z);
}

/// BIN SAMPLES, after the node.
inline void read_sky(TextLines& in, Patch& p) {
  p.sky = static_cast<int32_t>(in.integer("bin of the sky", 0, kSkyBins - 1));
  p.samples = in.real("samples of the bin");
  if (p.samples < 0) in.fail("a negative number of samples, expected 0 or more");
  in.end();
}

inline void write_sky(std::string& out, const Patch& p) {
  fmt::format_to(std::back_inserter(out), "{} {}\n", p.sky, p.samples);
}

/// Checks that each bin of the sky occurs at most once.
class SkyBinsSeen {
 public:
  void add(const TextLines& in, const Patch& p) {
    const auto bin = static_cast<size_t>(p.sky);
    if (seen_[bin]) in.fail(fmt::format("bin {} of the sky again, expected each once", bin));
    seen_[bin] = true;
  }

 private:
  std::array<bool, kSkyBins> seen_{};
};

/// FACE ..., after the node.
inline void read_faces(TextLines& in, Patch& p) {
  if (p.is_sky()) in.fail(fmt::format("faces of node {}, expected none of the sky", p.node));
  if (!in.more()) in.fail("nothing as face, expected at least one");
  while (in.more()) p.faces.push_back(static_cast<uint32_t>(in.integer("face", 0, UINT32_MAX)));
}

inline void write_faces(std::string& out, const char* head, const Patch& p) {
  for (size_t i = 0; i < p.faces.size(); i += kFacesPerLine) {
    fmt::format_to(std::back_inserter(out), "{} {}", head, p.node);
    for (size_t k = i; k < std::min(i + kFacesPerLine, p.faces.size()); ++k)
      fmt::format_to(std::back_inserter(out), " {}", p.faces[k]);
    out += '\n';
  }
}

/// Index of patches by node.
using NodeIndex = std::unordered_map<uint32_t, uint32_t>;

inline uint32_t patch_of(TextLines& in, const NodeIndex& index, const char* what) {
  const auto node = static_cast<uint32_t>(in.integer(what, 1, UINT32_MAX));
  const auto found = index.find(node);
  if (found == index.end())
    in.fail(fmt::format("node {} as {}, expected a patch named above", node, what));
  return found->second;
}

/// A number of 0 or more.
inline double read_amount(TextLines& in, const char* what, const char* negative) {
  const double n = in.real(what);
  if (!(n >= 0)) in.fail(fmt::format("{}, expected 0 or more", negative));
  return n;
}

/// NODE BRIGHTNESS IMPORTANCE ..., after its keyword; `light` grows as needed.
inline void read_light(TextLines& in, const NodeIndex& index, size_t cameras,
                       std::vector<PatchLight>& light) {
  const uint32_t i = patch_of(in, index, "node of light");
  light.resize(std::max<size_t>(light.size(), i + 1));
  const auto number = [&] { return read_amount(in, "light of a patch", "negative light"); };
  light[i].brightness = number();
  light[i].importance.clear();
  for (size_t k = 0; k < cameras; ++k) light[i].importance.push_back(number());
  in.end();
}

/// What is known of some patches is 0 of the others.
inline void fill_light(std::vector<PatchLight>& light, size_t patches, size_t cameras) {
  if (light.empty()) return;
  light.resize(patches);
  for (PatchLight& of_patch : light) of_patch.importance.resize(cameras, 0);
}

inline void write_light(std::string& out, const std::vector<Patch>& patches,
                        const std::vector<PatchLight>& light) {
  const auto lit = [](double n) { return n > 0; };
  for (size_t i = 0; i < light.size(); ++i) {
    const PatchLight& l = light[i];
    if (!lit(l.brightness) && std::none_of(l.importance.begin(), l.importance.end(), lit)) continue;
    fmt::format_to(std::back_inserter(out), "c light {} {:.4g}", patches[i].node, l.brightness);
    for (const double v : l.importance) fmt::format_to(std::back_inserter(out), " {:.4g}", v);
    out += '\n';
  }
}

}  // namespace tdpt::patch_lines
