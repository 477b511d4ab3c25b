// Which way the light that reaches the camera passes each portal, found before rendering: a portal
// that faces the wrong way costs time and finds no light, and modelling programs do not show the
// way it faces.
//
// Every path that carries light in a small picture [exploration.h] adds its weighted luminance to
// each portal and way that one of its edges crosses (the camera's own edge never counts):
//   E(portal, way) = sum over paths of w * value * crossings.
// So the picture's own light decides, from lamps with and without surface alike.
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
    front,     ///< only from its back to its front
    back,      ///< only from its front to its back: turned round
    both,
    left_out  ///< no light passes it
  } way = as_drawn;
  friend bool operator==(const PortalWay&, const PortalWay&) = default;
};

/// The light that passed a portal one way.
struct PassedLight {
  uint64_t samples = 0;  ///< that carried any
  double energy = 0;     ///< sum of luminance
  double brightest = 0;  ///< the most that one sample carried
};

/// The way in which a portal should work. `with`, `against`: light along its normal and against it;
/// `total`: of the whole picture; `wide`: its conductance is above 0.066. As drawn if fewer than 10
/// samples, or less than a thousandth of the light, passed either way. Otherwise in each way that
/// carries at least a fifth of its light: some light always turns back, at the jambs of a thick
/// wall or in the room behind, and segments that way are wasted. Measured with tdpt-guided: keeping
/// a way that carried 7 to 9 % (a hole of 0.10 m, a window of 1.6 m) took 1.6 to 2 times the work
/// for the same error. The brightest sample is left out where a minimum must be passed. A wide
/// portal works one way, as drawn or else the way of the most light: across the middle of a room
/// both ways took 3 times the work of one.
PortalWay::Way way_of(bool drawn_both_ways, const PassedLight& with, const PassedLight& against,
                      double total, bool wide);

/// Sums the light of paths through each of several portals.
class PassedPortals {
 public:
  /// A portal as working one way, and both.
  struct Opening {
    PortalSet front, both;
  };
  static std::vector<Opening> openings(const std::vector<Portal>& portals, const Frame& frame);

  /// `openings` must outlive it.
  explicit PassedPortals(const std::vector<Opening>& openings);
  /// A path of the current sample and its weighted luminance; directly seen lights are ignored.
  void see(const Path& path, double light);
  void end_sample();
  void merge(const PassedPortals& other);

 private:
  friend class WayFinder;
  /// Along the normal and against it.
  using BothWays = std::array<PassedLight, 2>;

  const std::vector<Opening>& openings_;
  std::vector<BothWays> ways_;
  std::vector<double> either_;        // either way, each path once
  double total_ = 0, brightest_ = 0;  // of all samples; of the brightest
  uint64_t lit_ = 0;                  // samples that carried light
  std::vector<std::array<double, 2>> of_sample_;
  double sample_ = 0;  // luminance of the current sample
};

/// Decides for each portal which way it should work; portals beyond the first 16 stay as drawn. If
/// 100 samples carried light, it leaves out a portal that less than a ten-thousandth of the light
/// passed, or that fewer than 10 samples passed in a picture without the others.
class WayFinder {
 public:
  explicit WayFinder(const std::vector<Portal>& portals);
  /// Whether another picture is needed after `made`: always a first one; a second one for portals
  /// that got next to no segments beside larger ones, with those alone.
  bool asks(uint64_t made) const { return made == 0 || (made == 1 && some_silent_); }
  /// The portals of that picture, each working both ways.
  std::vector<Portal> opened() const;
  /// Takes in what passed them, of a picture of `vista`.
  void learn(const PassedPortals& passed, const Vista& vista);
  std::vector<PortalWay> told() const;

 private:
  const std::vector<Portal>& portals_;
  std::vector<size_t> open_;
  std::vector<PortalWay> ways_;
  std::vector<bool> dark_;
  uint64_t lit_ = 0;
  bool some_silent_ = false;  // some, but not all
};

/// Makes the portals work that way; one that is left out keeps the figure of its area but no
/// triangles. Throws std::out_of_range for a portal that does not exist.
void apply_ways(const std::vector<PortalWay>& ways, std::vector<Portal>& portals);

}  // namespace tdpt
