// Lines shared by the formats of networks (.max) and cuts (.cut): the patches of a scene.
#pragma once
#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <unordered_map>
#include <utility>

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

/// A number of 0 or more.
inline double read_amount(TextLines& in, const char* what, const char* negative) {
  const double n = in.real(what);
  if (!(n >= 0)) in.fail(fmt::format("{}, expected 0 or more", negative));
  return n;
}

/// Reads what both formats have. Nodes come before what names them.
class PatchReader {
 public:
  PatchReader(TextLines& in, PatchFile& out) : in_(in), out_(out) {}

  /// A comment, after its 'c', if it is of these; returns its first word.
  std::string_view comment() {
    const std::string whole(in_.rest());
    const std::string_view word = in_.word();
    if (word == "made" || word == "from") {
      out_.provenance.lines.push_back(whole);
    } else if (word == "scene") {
      out_.scene_hash = std::string(in_.word());
      if (out_.scene_hash.empty()) in_.fail("nothing as hash of the scene, expected one");
    } else if (word == "camera") {
      out_.cameras.push_back(read_camera(in_));
      if (out_.cameras.size() > kMostCameras)
        in_.fail(fmt::format("one camera more than {}, expected no more", kMostCameras));
    } else if (word == "grid") {
      grid();
    } else if (word == "light") {
      light();
    }
    return word;
  }

  /// NODE, which is new.
  uint32_t node(const char* what) {
    const auto node = static_cast<uint32_t>(in_.integer(what, 1, UINT32_MAX));
    if (!index_.emplace(node, static_cast<uint32_t>(out_.patches.size())).second)
      in_.fail(fmt::format("node {} again, expected each node once", node));
    return node;
  }
  /// LEVEL I J K SAMPLES CX CY CZ NX NY NZ of a patch, BIN SAMPLES of the sky.
  void geometry(uint32_t node, bool sky) {
    Patch p;
    p.node = node;
    if (sky)
      bin(p);
    else
      patch(p);
    in_.end();
    out_.patches.push_back(std::move(p));
  }
  /// NODE, whose patch is above: its index.
  uint32_t patch_above(const char* what) {
    const auto node = static_cast<uint32_t>(in_.integer(what, 1, UINT32_MAX));
    const auto found = index_.find(node);
    if (found == index_.end())
      in_.fail(fmt::format("node {} as {}, expected a patch named above", node, what));
    return found->second;
  }
  /// NODE FACE ...
  void faces() {
    Patch& p = out_.patches[patch_above("node of a face")];
    if (p.is_sky()) in_.fail(fmt::format("faces of node {}, expected none of the sky", p.node));
    if (!in_.more()) in_.fail("nothing as face, expected at least one");
    while (in_.more()) p.faces.push_back(static_cast<uint32_t>(in_.integer("face", 0, UINT32_MAX)));
  }

  /// After the last line.
  void finish() {
    if (out_.scene_hash.empty()) in_.fail_file("no 'c scene' line, expected the hash of the scene");
    if (!has_grid_) in_.fail_file("no 'c grid' line, expected the grid of the patches");
    for (const Patch& p : out_.patches)
      if (p.faces.empty() && !p.is_sky())
        in_.fail_file(fmt::format("node {} has no faces, expected at least one", p.node));
    if (out_.light.empty()) return;
    // What is known of some patches is 0 of the others.
    out_.light.resize(out_.patches.size());
    for (PatchLight& l : out_.light) l.importance.resize(out_.number_of_cameras(), 0);
  }

 private:
  // X Y Z CELL
  void grid() {
    if (has_grid_) in_.fail("a second grid, expected one");
    has_grid_ = true;
    out_.grid.origin = read_vec3(in_, "origin of the grid");
    out_.grid.base_cell = in_.real("side of a cell");
    if (!(out_.grid.base_cell > 0)) in_.fail("a cell without size, expected a side above 0");
    in_.end();
  }
  // NODE BRIGHTNESS IMPORTANCE ...
  void light() {
    const uint32_t i = patch_above("node of light");
    out_.light.resize(std::max<size_t>(out_.light.size(), i + 1));
    const auto number = [&] { return read_amount(in_, "light of a patch", "negative light"); };
    PatchLight& l = out_.light[i];
    l.brightness = number();
    l.importance.clear();
    for (size_t k = 0; k < out_.number_of_cameras(); ++k) l.importance.push_back(number());
    in_.end();
  }
  void patch(Patch& p) {
    p.level = static_cast<int>(in_.integer("level of the patch", 0, kDeepestLevel));
    for (int32_t& c : p.cell)
      c = static_cast<int32_t>(in_.integer("cell of the patch", INT32_MIN, INT32_MAX));
    p.samples = read_amount(in_, "samples of the patch", "a negative number of samples");
    p.centre = read_vec3(in_, "centre of the patch");
    p.normal = read_vec3(in_, "normal of the patch");
    if (!(std::abs(length(p.normal) - 1) < 1e-3))
      in_.fail("a normal of another length, expected length 1");
    p.normal = normalize(p.normal);
  }
  void bin(Patch& p) {
    p.sky = static_cast<int32_t>(in_.integer("bin of the sky", 0, kSkyBins - 1));
    p.samples = read_amount(in_, "samples of the bin", "a negative number of samples");
    if (std::exchange(bins_[static_cast<size_t>(p.sky)], true))
      in_.fail(fmt::format("bin {} of the sky again, expected each once", p.sky));
  }

  TextLines& in_;
  PatchFile& out_;
  std::unordered_map<uint32_t, uint32_t> index_;  // of patches, by node
  std::array<bool, kSkyBins> bins_{};             // that were there
  bool has_grid_ = false;
};

/// The first lines of a file. `format`: "max 1".
inline void write_head(std::string& out, const std::string& format, const PatchFile& file) {
  out += fmt::format("c tdpt {}\n", format);
  for (const std::string& line : file.provenance.lines) out += fmt::format("c {}\n", line);
  out += fmt::format("c scene {}\n", file.scene_hash);
  for (const std::string& camera : file.cameras) out += fmt::format("c camera {}\n", camera);
}

inline void write_grid(std::string& out, const PatchGrid& g) {
  fmt::format_to(std::back_inserter(out), "c grid {} {} {} {}\n", g.origin.x, g.origin.y,
                 g.origin.z, g.base_cell);
}

/// The line of a patch or a bin of the sky, after its node, and the lines of its faces, which begin
/// with `faces`.
inline void write_patch(std::string& out, const Patch& p, const char* faces) {
  const auto to = std::back_inserter(out);
  if (p.is_sky()) {
    fmt::format_to(to, "{} {}\n", p.sky, p.samples);
    return;
  }
  fmt::format_to(to, "{} {} {} {} {} {} {} {} {:.6f} {:.6f} {:.6f}\n", p.level, p.cell[0],
                 p.cell[1], p.cell[2], p.samples, p.centre.x, p.centre.y, p.centre.z, p.normal.x,
                 p.normal.y, p.normal.z);
  for (size_t i = 0; i < p.faces.size(); i += kFacesPerLine) {
    fmt::format_to(to, "{} {}", faces, p.node);
    for (size_t k = i; k < std::min(i + kFacesPerLine, p.faces.size()); ++k)
      fmt::format_to(to, " {}", p.faces[k]);
    out += '\n';
  }
}

inline void write_light(std::string& out, const PatchFile& file) {
  const auto lit = [](double n) { return n > 0; };
  for (size_t i = 0; i < file.light.size(); ++i) {
    const PatchLight& l = file.light[i];
    if (!lit(l.brightness) && std::none_of(l.importance.begin(), l.importance.end(), lit)) continue;
    fmt::format_to(std::back_inserter(out), "c light {} {:.4g}", file.patches[i].node,
                   l.brightness);
    for (const double v : l.importance) fmt::format_to(std::back_inserter(out), " {:.4g}", v);
    out += '\n';
  }
}

}  // namespace tdpt::patch_lines
