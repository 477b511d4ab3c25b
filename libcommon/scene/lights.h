// All lights of a scene as one: emitting triangles, punctual lights and the sky, chosen in
// proportion to power, the faint more often, by a cumulative table: thousands cost as much as one.
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

/// How light leaves a place of a light, and the density with which walks follow it. Emitting
/// surfaces, points, spots, parallel light and the sky answer the same questions.
///
/// What leaves a place is radiance [W/m2/sr] from a surface or the sky, radiant intensity [W/sr,
/// canonical area] from a point or spot, irradiance across its way [W/m2] of parallel light. The
/// places of parallel light and of the sky are infinitely far away: a place is a direction, and the
/// density of what leaves it is of the lines along it, per canonical area across them.
class LightSource {
 public:
  static LightSource surface(bool both_sides) { return LightSource(both_sides); }
  /// `extent`: of the directions that light leaves in [sr]; parallel: of the disc across the scene
  /// that it passes [canonical area].
  static LightSource punctual(const PunctualLight& light, double extent);
  /// `extent`: of the disc across the scene [canonical area].
  static LightSource all_around(const Sky& sky, double extent);

  /// Whether a ray can meet it; if not, only those who sample lights find it.
  bool met() const { return is_surface_ || sky_; }
  bool at_infinity() const { return !is_surface_ && lamp_.parallel; }
  bool is_sky() const { return sky_ != nullptr; }
  bool is_surface() const { return is_surface_; }
  /// Of a surface.
  bool both_sides() const { return both_sides_; }
  const Lamp& lamp() const { return lamp_; }
  /// Of a lamp, or null.
  const LightProfile* profile() const { return profile_.get(); }
  /// The side that it shines to, from a place with unit normal `front`; 0: all.
  Vec3d facing(const Vec3d& front) const { return is_surface_ && !both_sides_ ? front : Vec3d(); }

  /// What leaves along unit w; `radiance`: of a surface there, textures included.
  Rgb emitted(const Vec3d& front, const Rgb& radiance, const Vec3d& w) const {
    if (sky_) return sky_->radiance(-w);
    if (!is_surface_) return lamp_radiance(w);
    return both_sides_ || dot(front, w) > 0 ? radiance : Rgb{};
  }
  /// Density of the direction in which a walk leaves [1/sr]: |cos|/pi on the front of a surface,
  /// half of that on each side when both emit; uniform over the sphere, the spot's cone or a ring
  /// of a profile; at infinity of the line along w [1/canonical area].
  double pdf_w(const Vec3d& front, const Vec3d& w) const {
    if (!is_surface_) return lamp_pdf_w(w);
    const double cos = dot(front, w);
    if (both_sides_) return std::abs(cos) * (0.5 * std::numbers::inv_pi);
    return std::max(cos, 0.0) * std::numbers::inv_pi;
  }
  /// |cos| / pdf_w of a direction w that light leaves in: a walk that leaves carries this times
  /// what is emitted. The same for all w but of a lamp with a profile.
  double cos_per_pdf_w(const Vec3d& w) const { return profile_ ? lamp_per_pdf_w(w) : lamp_.extent; }
  /// Probability that a point, spot, parallel light or the sky is chosen to begin a walk.
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
  Lamp lamp_;  // the sky is parallel light from everywhere; a surface has but an extent
  std::shared_ptr<const LightProfile> profile_;
  double pdf_1_ = 0;
};

class Lights {
 public:
  explicit Lights(const Scene& scene);

  bool empty() const { return table_.empty(); }
  /// Emitted power of the whole scene, luminance, in canonical area: sum of pi * Y(Le) * A over
  /// emitting sides, of Y(intensity) * extent of points and spots, and of what of parallel light
  /// and of the sky passes the disc.
  double power() const { return power_; }

  /// How often lights of a kind are chosen, together.
  struct KindProbabilities {
    double surfaces = 0, lamps = 0, parallel = 0, sky = 0;  ///< sum 1; points and spots are lamps
    double& of(const LightSource& source) {
      if (source.is_sky()) return sky;
      if (source.is_surface()) return surfaces;
      return source.at_infinity() ? parallel : lamps;
    }
    friend bool operator==(const KindProbabilities&, const KindProbabilities&) = default;
  };
  /// Of emitted power, by kind; canonical area, luminance, as power().
  const KindProbabilities& powers() const { return emitted_; }
  /// In proportion to power, but for the faint, unless choose_by() said otherwise.
  const KindProbabilities& shares() const { return shares_; }
  /// Those of a kind that there are have more than 0.
  void choose_by(const KindProbabilities& shares);

  /// What is told of a direction of the sky, by one look at the map.
  struct InSky {
    Rgb radiance{};      ///< seen along it [W/m2/sr]
    double plain_w = 0;  ///< density of directions() [1/sr]
    /// Of those in which walks begin. -1: not told, as under one colour nothing else has a use for
    /// the place.
    double start_w = -1;
  };
  /// There must be a sky. The direction: unit, and as it was drawn.
  InSky look(const Vec3d& towards) const {
    return look(scene_.sky->one_colour() ? Sky::Place{towards} : scene_.sky->place(towards));
  }
  InSky look(const Sky::Place& place) const;

  /// A place light leaves from.
  struct Point {
    const LightSource* source = nullptr;
    uint32_t triangle = ~0u;  ///< of a surface
    double b1 = 0, b2 = 0;    ///< barycentrics on the triangle
    Vec3d position{};         ///< canonical; at infinity unit, the way its light travels
    Vec3d normal{};           ///< unit, on the side to leave by: the front, or either (a fair coin)
    InSky in_sky{};           ///< of the sky
    double pdf = 0;           ///< pdf_A per canonical area; of the sky pdf_w; otherwise pdf_1
  };
  /// A place to begin a walk at. Four numbers in [0,1): which light, where on it (u, v), and which
  /// of its sides or which part of the sky.
  Point sample(double pick, double u, double v, double side) const;
  /// Draws them from `rng` in this order.
  Point sample(Rng& rng) const;
  /// Density of `sample`, at any point of `triangle` where that is a surface; `position` as in
  /// Point.
  double pdf(const LightSource& source, uint32_t triangle, const Vec3d& position,
             const InSky& in_sky) const {
    if (source.is_sky())
      return source.pdf_1() *
             (in_sky.start_w < 0 ? start_w({-position}, in_sky.plain_w) : in_sky.start_w);
    return source.met() ? pdf_A(triangle) : source.pdf_1();
  }
  /// Density of `sample` at any point of `triangle`; 0 when it does not emit.
  double pdf_A(uint32_t triangle) const { return pdf_A_[triangle]; }

  /// Walks that begin in the sky do so, but for a tenth of them, where luminance x `weight` is
  /// large (SkyDirections).
  void prefer(const std::function<double(const Vec3d& towards)>& weight);
  /// Whether this number chooses the sky.
  bool picks_sky(double pick) const {
    return has_sky_ && table_.sample(pick) == triangles_.size() + punctual_.size();
  }

  struct Ray {
    Vec3d origin, direction;
  };
  /// A ray of light from `point`: cos-distributed on a surface, uniform within a lamp's cone or by
  /// the rings of its profile, on a disc outside the scene from infinity. u, v uniform in [0,1).
  Ray leave(const Point& point, double u, double v) const;

  /// How surfaces shine that emit on their front or on both sides.
  const LightSource& surface(bool both_sides) const { return surfaces_[both_sides]; }
  /// What rays meet that leave the scene; null: nothing shines there.
  const LightSource* sky() const { return has_sky_ ? &sky_ : nullptr; }
  /// Directions of the sky, by luminance alone.
  const SkyDirections& directions() const { return directions_; }
  /// Those that prefer() made, from which kPreferred of the walks begin that do in the sky; empty:
  /// all begin by luminance.
  const SkyDirections& preferred() const { return preferred_; }
  static constexpr double kPreferred = 0.9;

  // For those who choose lights by tables of their own.
  /// Emitting triangles, then lamps, then the sky are the entries that are chosen from.
  const std::vector<uint32_t>& emitters() const { return triangles_; }
  const std::vector<LightSource>& lamps() const { return punctual_; }
  /// Probability of an entry.
  double pdf_1(uint32_t entry) const { return table_.pdf_1(entry); }
  /// Of a ball around the origin that holds all triangles; 0 where nothing asks for it.
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
  std::vector<float> pdf_A_;    // per scene triangle
  std::vector<double> powers_;  // of the entries; the faintest are taken for more [lights.cpp]
  KindProbabilities shares_, emitted_;
  double power_ = 0;
  double radius_ = 0;  // of a ball around the origin that holds all triangles
};

}  // namespace tdpt
