// All lights of a scene: emitting triangles, punctual lights and the sky; and how one of them is
// selected: in proportion to power, faint ones more often. A cumulative table makes that
// independent of their number.
#pragma once
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "libcommon/math/discrete.h"
#include "libcommon/math/rng.h"
#include "libcommon/math/vec.h"
#include "libcommon/scene/scene.h"
#include "shaders/shared/path/lights_layout.h"

namespace tdpt {

using Lamp = shader::LampOf<double>;

/// How light leaves a point of a light, and with which density light walks sample it. Emitting
/// surfaces, points, spots, parallel light and the sky share this interface.
///
/// The emitted quantity is radiance [W/m2/sr] for a surface or the sky, radiant intensity [W/sr,
/// canonical area] for a point or spot, perpendicular irradiance [W/m2] for parallel light. Points
/// of parallel light and of the sky are infinitely far away: such a point is a direction, and the
/// density of what leaves it is over the lines along that direction, per canonical area across
/// them.
class LightSource {
 public:
  static LightSource surface(bool both_sides) { return LightSource(both_sides); }
  /// `extent`: solid angle of the emitted directions [sr]; for parallel light the area of the disc
  /// across the scene that it passes [canonical area].
  static LightSource punctual(const PunctualLight& light, double extent);
  /// `extent`: area of the disc across the scene [canonical area].
  static LightSource all_around(const Sky& sky, double extent);

  /// Whether a ray can hit it; otherwise only light sampling finds it.
  bool met() const { return is_surface_ || sky_; }
  bool at_infinity() const { return !is_surface_ && lamp_.parallel; }
  bool is_sky() const { return sky_ != nullptr; }
  bool is_surface() const { return is_surface_; }
  /// For a surface.
  bool both_sides() const { return both_sides_; }
  const Lamp& lamp() const { return lamp_; }
  /// Of a lamp; may be null.
  const LightProfile* profile() const { return profile_.get(); }
  /// The normal of the side that it shines to, given unit normal `front`; 0: all directions.
  Vec3d facing(const Vec3d& front) const { return is_surface_ && !both_sides_ ? front : Vec3d(); }

  /// Emission along unit w; `radiance`: of a surface there, textures included.
  Rgb emitted(const Vec3d& front, const Rgb& radiance, const Vec3d& w) const {
    if (sky_) return sky_->radiance(-w);
    if (!is_surface_) return lamp_radiance(w);
    return both_sides_ || dot(front, w) > 0 ? radiance : Rgb{};
  }
  /// Density of the direction in which a light walk leaves [1/sr]: |cos|/pi on the front of a
  /// surface, half of that on each side if both emit; uniform over the sphere, the spot's cone or a
  /// ring of a profile; at infinity the density of the line along w [1/canonical area].
  double pdf_w(const Vec3d& front, const Vec3d& w) const {
    if (!is_surface_) return lamp_pdf_w(w);
    const double cos = dot(front, w);
    if (both_sides_) return std::abs(cos) * (0.5 * std::numbers::inv_pi);
    return std::max(cos, 0.0) * std::numbers::inv_pi;
  }
  /// |cos| / pdf_w for an emitted direction w: the initial throughput of a light walk, relative to
  /// the emission. Independent of w except for a lamp with a profile.
  double cos_per_pdf_w(const Vec3d& w) const { return profile_ ? lamp_per_pdf_w(w) : lamp_.extent; }

 private:
  friend class Lights;
  explicit LightSource(bool both_sides) : is_surface_(true), both_sides_(both_sides) {
    lamp_.extent = (both_sides ? 2 : 1) * std::numbers::pi;
  }
  Rgb lamp_radiance(const Vec3d& w) const;
  double lamp_pdf_w(const Vec3d& w) const;
  double lamp_per_pdf_w(const Vec3d& w) const;

  bool is_surface_, both_sides_ = false;
  const Sky* sky_ = nullptr;
  Lamp lamp_;  // the sky is treated as parallel light; of a surface only `extent` is set
  std::shared_ptr<const LightProfile> profile_;
};

class Lights {
 public:
  explicit Lights(const Scene& scene);

  bool empty() const { return powers_.empty(); }
  /// Emitted power of the whole scene, luminance, in canonical area: sum of pi * Y(Le) * A over
  /// emitting sides, of Y(intensity) * extent over points and spots, and of the parallel light and
  /// sky light through the disc.
  double power() const { return power_; }

  /// Selection probability of all lights of a kind together.
  struct KindProbabilities {
    double surfaces = 0, lamps = 0, parallel = 0, sky = 0;  ///< sum 1; points and spots are lamps
    double& of(const LightSource& source) {
      if (source.is_sky()) return sky;
      if (source.is_surface()) return surfaces;
      return source.at_infinity() ? parallel : lamps;
    }
    friend bool operator==(const KindProbabilities&, const KindProbabilities&) = default;
  };
  /// Emitted power by kind; canonical area, luminance, as power().
  const KindProbabilities& powers() const { return emitted_; }

  /// Radiance and densities of a direction of the sky, from a single look-up.
  struct InSky {
    Rgb radiance{};      ///< radiance from it [W/m2/sr]
    double plain_w = 0;  ///< density of directions() [1/sr]
    /// Density of directions in which walks begin. -1: not set, since under a uniform sky nothing
    /// else needs the look-up.
    double start_w = -1;
  };

  /// A point that light leaves from.
  struct Point {
    const LightSource* source = nullptr;
    uint32_t triangle = ~0u;  ///< if on a surface
    double b1 = 0, b2 = 0;    ///< barycentrics in the triangle
    Vec3d position{};         ///< canonical; at infinity the unit direction in which light travels
    Vec3d normal{};  ///< unit, on the side that the walk leaves by: the front, or either with
                     ///< probability 1/2
    InSky in_sky{};  ///< if in the sky
    double pdf = 0;  ///< pdf_A per canonical area; pdf_w for the sky; otherwise pdf_1
  };

  struct Ray {
    Vec3d origin, direction;
  };
  /// The first ray of a light walk from `point`: cosine-distributed on a surface, uniform in a
  /// lamp's cone or by the rings of its profile, on a disc outside the scene for light from
  /// infinity. u, v uniform in [0,1).
  Ray leave(const Point& point, double u, double v) const;

  /// Emission of surfaces on one side or on both.
  const LightSource& surface(bool both_sides) const { return surfaces_[both_sides]; }
  /// The light hit by rays that leave the scene; null: none.
  const LightSource* sky() const { return sky_ ? &*sky_ : nullptr; }
  /// Samples directions of the sky by luminance alone.
  const SkyDirections& directions() const { return directions_; }

  /// Entries of a selection's table: emitting triangles, then lamps, then the sky.
  const std::vector<uint32_t>& emitters() const { return triangles_; }
  const std::vector<LightSource>& lamps() const { return punctual_; }
  /// Radius of a ball around the origin that holds all triangles; 0 if no light needs it.
  double radius() const { return radius_; }

 private:
  friend class LightSelection;
  const LightSource& source_of(size_t entry) const;

  const Scene& scene_;
  std::array<LightSource, 2> surfaces_{LightSource::surface(false), LightSource::surface(true)};
  std::optional<LightSource> sky_;
  SkyDirections directions_;
  std::vector<uint32_t> triangles_;
  std::vector<TriangleShape> shapes_;
  std::vector<LightSource> punctual_;
  std::vector<double> powers_;  // of the entries; the faintest are raised [lights.cpp]
  KindProbabilities emitted_;
  double power_ = 0;
  double radius_ = 0;  // of a ball around the origin that holds all triangles
};

/// How light walks and next events select one of the lights, and a point on it.
class LightSelection {
 public:
  /// `lights` must outlive it. `shares`: of the kinds, each that is present more than 0; none: in
  /// proportion to power, except for faint ones. A share kPreferred of the walks that start in the
  /// sky is sampled by `preferred`, the others by luminance.
  explicit LightSelection(const Lights& lights,
                          const std::optional<Lights::KindProbabilities>& shares = {},
                          SkyDirections preferred = {});

  const Lights& lights() const { return *lights_; }
  const Lights::KindProbabilities& shares() const { return shares_; }
  /// Selection probability of an entry, and of the sky: 0 if there is none.
  double pdf_1(size_t entry) const { return table_.pdf_1(static_cast<uint32_t>(entry)); }
  double sky_pdf_1() const { return sky_pdf_1_; }
  /// Whether `pick` selects the sky.
  bool picks_sky(double pick) const {
    return lights_->sky_ && table_.sample(pick) + 1 == lights_->powers_.size();
  }

  /// Requires a sky. Takes a unit direction, or a place as it was drawn.
  Lights::InSky look(const Vec3d& towards) const {
    const Sky& sky = *lights_->scene_.sky;
    return look(sky.one_colour() ? Sky::Place{towards} : sky.place(towards));
  }
  Lights::InSky look(const Sky::Place& place) const;

  /// Samples the start of a light walk. Four numbers in [0,1): which light (pick), where on it (u,
  /// v), and which of its sides or which sky distribution (side).
  Lights::Point sample(double pick, double u, double v, double side) const;
  /// Draws the four from `rng` in this order.
  Lights::Point sample(Rng& rng) const;
  /// Density of `sample`, at any point of `triangle` for a surface; `position` as in Lights::Point.
  double pdf(const LightSource& source, uint32_t triangle, const Vec3d& position,
             const Lights::InSky& in_sky) const {
    if (source.is_sky())
      return sky_pdf_1_ *
             (in_sky.start_w < 0 ? start_w({-position}, in_sky.plain_w) : in_sky.start_w);
    if (source.met()) return pdf_A(triangle);
    return pdf_1(lights_->triangles_.size() +
                 static_cast<size_t>(&source - lights_->punctual_.data()));
  }
  /// Density of `sample` at any point of `triangle`; 0 if it does not emit.
  double pdf_A(uint32_t triangle) const { return pdf_A_[triangle]; }

  /// Empty: all walks use luminance.
  const SkyDirections& preferred() const { return preferred_; }
  static constexpr double kPreferred = 0.9;

 private:
  friend struct LightsFaults;  // of tests [tools/tdpt-render/testing/faults.h]
  double start_w(const Sky::Place& place, double plain_w) const;

  const Lights* lights_;
  Lights::KindProbabilities shares_;
  SkyDirections preferred_;
  CumulativeTable table_;
  std::vector<float> pdf_A_;  // per triangle of the scene
  double sky_pdf_1_ = 0;
};

}  // namespace tdpt
