// All lights of a scene: emitting triangles, punctual lights and the sky, selected in proportion to
// power, faint ones more often. A cumulative table makes that independent of their number.
#pragma once
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "libcommon/math/cumulative_table.h"
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
  /// Probability that a light walk starts at this point, spot, parallel light or sky.
  double pdf_1() const { return pdf_1_; }

 private:
  friend class Lights;
  friend struct LightsFaults;
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
  double pdf_1_ = 0;
};

class Lights {
 public:
  explicit Lights(const Scene& scene);

  bool empty() const { return table_.empty(); }
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
  /// In proportion to power, except for faint kinds, unless choose_by() was called.
  const KindProbabilities& shares() const { return shares_; }
  /// Each kind that is present must have more than 0.
  void choose_by(const KindProbabilities& shares);
  /// As if choose_by() had not been called.
  void choose_by_power();

  /// Radiance and densities of a direction of the sky, from a single look-up.
  struct InSky {
    Rgb radiance{};      ///< radiance from it [W/m2/sr]
    double plain_w = 0;  ///< density of directions() [1/sr]
    /// Density of directions in which walks begin. -1: not set, since under a uniform sky nothing
    /// else needs the look-up.
    double start_w = -1;
  };
  /// Requires a sky. Takes a unit direction, or a place as it was drawn.
  InSky look(const Vec3d& towards) const {
    return look(scene_.sky->one_colour() ? Sky::Place{towards} : scene_.sky->place(towards));
  }
  InSky look(const Sky::Place& place) const;

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
  /// Samples the start of a light walk. Four numbers in [0,1): which light (pick), where on it (u,
  /// v), and which of its sides or which sky distribution (side).
  Point sample(double pick, double u, double v, double side) const;
  /// Draws the four from `rng` in this order.
  Point sample(Rng& rng) const;
  /// Density of `sample`, at any point of `triangle` for a surface; `position` as in Point.
  double pdf(const LightSource& source, uint32_t triangle, const Vec3d& position,
             const InSky& in_sky) const {
    if (source.is_sky())
      return source.pdf_1() *
             (in_sky.start_w < 0 ? start_w({-position}, in_sky.plain_w) : in_sky.start_w);
    return source.met() ? pdf_A(triangle) : source.pdf_1();
  }
  /// Density of `sample` at any point of `triangle`; 0 if it does not emit.
  double pdf_A(uint32_t triangle) const { return pdf_A_[triangle]; }

  /// From now on a share kPreferred of the walks that start in the sky is sampled by luminance x
  /// `weight` (SkyDirections), the others by luminance.
  void prefer(const std::function<double(const Vec3d& towards)>& weight);
  /// Whether `pick` selects the sky.
  bool picks_sky(double pick) const {
    return has_sky_ && table_.sample(pick) == triangles_.size() + punctual_.size();
  }

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
  const LightSource* sky() const { return has_sky_ ? &sky_ : nullptr; }
  /// Samples directions of the sky by luminance alone.
  const SkyDirections& directions() const { return directions_; }
  /// The distribution made by prefer(), used for a share kPreferred of the walks that start in the
  /// sky; empty: all use luminance.
  const SkyDirections& preferred() const { return preferred_; }
  static constexpr double kPreferred = 0.9;

  // For callers that select lights by tables of their own.
  /// Entries of the table: emitting triangles, then lamps, then the sky.
  const std::vector<uint32_t>& emitters() const { return triangles_; }
  const std::vector<LightSource>& lamps() const { return punctual_; }
  /// Selection probability of an entry.
  double pdf_1(uint32_t entry) const { return table_.pdf_1(entry); }
  /// Radius of a ball around the origin that holds all triangles; 0 if no light needs it.
  double radius() const { return radius_; }

 private:
  friend struct LightsFaults;  // of tests [tools/tdpt-render/testing/faults.h]
  double start_w(const Sky::Place& place, double plain_w) const;
  const LightSource& source_of(size_t entry) const;
  void fill(const std::vector<double>& weights);

  const Scene& scene_;
  std::array<LightSource, 2> surfaces_{LightSource::surface(false), LightSource::surface(true)};
  LightSource sky_{false};
  bool has_sky_ = false;
  SkyDirections directions_, preferred_;
  // Entries of the table: emitting triangles, then the punctual lights, then the sky.
  std::vector<uint32_t> triangles_;
  std::vector<TriangleShape> shapes_;
  std::vector<LightSource> punctual_;
  CumulativeTable table_;
  std::vector<float> pdf_A_;    // per triangle of the scene
  std::vector<double> powers_;  // of the entries; the faintest are raised [lights.cpp]
  KindProbabilities shares_, emitted_;
  double power_ = 0;
  double radius_ = 0;  // of a ball around the origin that holds all triangles
};

}  // namespace tdpt
