// Which way the light that reaches the camera passes each portal, found before rendering: a portal
// that faces the wrong way costs time and brings nothing, and modelling programs do not tell.
//
// Every path that brings light in a small picture [exploration.h] adds its weighted luminance to
// each portal and way that one of its edges crosses (the camera's own edge never counts):
//   E(portal, way) = sum over paths of w * value * crossings,
// so what is compared is the light of the picture itself, of lamps with and without surface alike.
#pragma once
#include <array>
#include <vector>

#include "libcommon/formats/portal.h"
#include "tools/tdpt-render/path/sample/path.h"

namespace tdpt {

/// Which way a portal works in a rendering.
struct PortalWay {
  size_t portal = 0;
  enum Way {
    as_drawn,  ///< as its file says
    front,     ///< from its back to its front alone
    back,      ///< from its front to its back alone: turned round
    both,
    left_out  ///< no light passes it
  } way = as_drawn;
  friend bool operator==(const PortalWay&, const PortalWay&) = default;
};

/// The light that passed a portal one way.
struct PassedLight {
  uint64_t samples = 0;  ///< that brought any
  double energy = 0;     ///< sum of luminance
  double brightest = 0;  ///< the most that one sample brought
};

/// What the light says of one portal. `with`: along its normal. `total`: of the whole picture.
/// As drawn where fewer than 10 samples, or less than a thousandth of the light, passed either way.
/// Else it works the ways that a fifth of its light and more goes: some always turns back, at the
/// jambs of a thick wall or in the room behind, and segments that way are lost on it. Measured with
/// tdpt-guided: to keep a way that 7 to 9 % went (a hole of 0.10 m, a window of 1.6 m) took 1.6 to
/// 2 times the work for the same error. What has to be much is counted without its brightest
/// sample. `wide`: its conductance is above 0.066. Then it works one way, that drawn or else that
/// of the most light: across the middle of a room both ways took 3 times the work of one.
PortalWay::Way way_of(bool drawn_both_ways, const PassedLight& with, const PassedLight& against,
                      double total, bool wide);

/// What a small picture showed of the light that passes a portal.
struct PortalLight {
  uint64_t samples = 0, of = 0;  ///< samples whose light passed it, of all; 0 of 0: not measured
  double share = 0;              ///< of the picture's light
};

/// Adds up what paths carry through each of some portals.
class PassedPortals {
 public:
  /// A portal as if it worked one way, and both.
  struct Opening {
    PortalSet front, both;
  };
  static std::vector<Opening> openings(const std::vector<Portal>& portals, const Frame& frame);

  /// `openings` stay the caller's.
  explicit PassedPortals(const std::vector<Opening>& openings);
  /// A path of the sample and its weighted luminance; a light seen directly passes nothing.
  void see(const Path& path, double light);
  void end_sample();
  void merge(const PassedPortals& other);

 private:
  friend class WayFinder;
  /// With the normal and against it.
  using BothWays = std::array<PassedLight, 2>;

  const std::vector<Opening>& openings_;
  std::vector<BothWays> ways_;
  std::vector<PortalLight> either_;   // way, each path once; `share`: the sum of it
  double total_ = 0, brightest_ = 0;  // of all samples; the most that one brought
  uint64_t lit_ = 0;                  // samples
  std::vector<std::array<double, 2>> of_sample_;
  double sample_ = 0;  // what it brought
};

/// For each portal which way it should work; those beyond the first 16 as drawn. Where 100 samples
/// brought light, one is left out that less than a ten thousandth of it passed, or that fewer than
/// 10 samples passed in a picture without the others.
class WayFinder {
 public:
  explicit WayFinder(const std::vector<Portal>& portals);
  /// Whether another picture is to be made: one at first. Small portals beside large ones may get
  /// next to no segments: a second one is theirs alone.
  bool asks(uint64_t made) const { return made == 0 || (made == 1 && some_silent_); }
  /// Those to be looked at in it, each working both ways.
  std::vector<Portal> opened() const;
  /// What that picture showed of them, in a world that has them.
  void learn(const PassedPortals& passed, const World& world);
  void tell(std::vector<PortalWay>& ways, std::vector<PortalLight>& light) const;

 private:
  const std::vector<Portal>& portals_;
  std::vector<size_t> open_;
  std::vector<PortalWay> ways_;
  std::vector<PortalLight> light_;
  std::vector<bool> dark_;
  uint64_t lit_ = 0;
  bool some_silent_ = false;  // but not all
};

/// Makes the portals work that way; one that is left out keeps its area as a figure and no
/// triangle. Throws std::out_of_range for one that there is not.
void apply_ways(const std::vector<PortalWay>& ways, std::vector<Portal>& portals);

}  // namespace tdpt
