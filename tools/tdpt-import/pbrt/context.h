// What all parts of the reader of pbrt's scenes share: the scene with its pictures, transformations
// of coordinates, and the colours and spectra of parameters as linear Rec.709.
#pragma once
#include <map>
#include <optional>
#include <span>
#include <string>

#include "libcommon/math/vec.h"
#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/pbrt/parameters.h"

namespace tdpt::foreign::pbrt {

struct Context {
  Context(Source& scene_source, bool is_v4) : source(scene_source), v4(is_v4) {}

  Source& source;
  bool v4;  ///< pbrt-v4, else pbrt-v3
  Described scene{};
  std::optional<Sky> portals_sky{};  ///< of the first infinite light with a portal

  /// The picture of this file, read once.
  size_t image(const std::string& name, const Place& place);
  /// Whether it is anywhere transparent.
  bool has_alpha(size_t image);

 private:
  std::map<std::string, size_t> images_{};
  std::map<size_t, bool> has_alpha_{};
};

// pbrt's transformations of coordinates.

/// Throws InputError at `place` for a map that flattens space.
Affine inverse(const Affine& a, const Place& place);

Affine translated(const Vec3d& by);
Affine scaled_by(const Vec3d& by);
/// About `axis`; a zero axis turns nothing.
Affine rotated(double degrees, const Vec3d& axis);
/// From the world to a camera that looks along +z.
Affine looking(const Vec3d& from, const Vec3d& at, const Vec3d& up, const Place& place);
/// Of sixteen numbers, column by column.
Affine affine_of_matrix(std::span<const double> m, const Place& place);

// Colours and spectra of parameters, as linear Rec.709.

/// What a spectrum is for. Of a light, pbrt-v4 scales every spectrum but `rgb` to luminance 1.
enum class Use { reflectance, index, light };

/// Of any of pbrt's types for colours; none: there is no such parameter, or not of such a type.
std::optional<Rgb> colour_of(Context& context, const Parameters& list, const std::string& name,
                             Use use);
Rgb colour_of(Context& context, const Parameters& list, const std::string& name, Use use,
              const Rgb& absent);

/// Index of refraction: a number or a spectrum, whose green value is taken.
double index_of(Context& context, const Parameters& list, const std::string& name, double absent);

}  // namespace tdpt::foreign::pbrt
