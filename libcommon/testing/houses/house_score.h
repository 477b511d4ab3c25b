// Scores portals of a building by the light paths that pass its doors and windows
// (NAME.openings.json beside the houses of ../shared/scenes; its README says what the list holds).
#pragma once
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/testing/houses/light_paths.h"
#include "libcommon/trace/tracer.h"

namespace tdpt::testing {

/// A polygon that light passes; convex or not, planar, metres.
struct OpeningPart {
  std::vector<Vec3d> polygon;
  Vec3d normal;
};

/// A line of the list: of a door ajar the gap beside its leaf, or the wedge above it.
struct HouseOpening {
  std::string name, kind, state;
  std::string element;             ///< door or window that it belongs to, by name
  std::vector<std::string> rooms;  ///< two
  OpeningPart part;
  /// Faces of the wall, before and behind the polygon along its normal [m].
  double front = 0, rear = 0;
  /// Of a door ajar: the whole doorway, which parts the rooms as gap and wedge together do.
  std::vector<OpeningPart> doorway;
};

/// Throws InputError.
std::vector<HouseOpening> read_openings(const std::string& file);

struct OpeningScore {
  double light = 0;      ///< share of the paths that pass it
  bool forward = true;   ///< most of them along its normal
  double coverage = 0;   ///< share of those that pass the whole wall that cross, on the same edge,
                         ///< portals that lie in openings; of a door ajar, or before or after
                         ///< the leaf scatters them one that lies in it
  double tightness = 1;  ///< least of the portals that lie in it
  double angle = 0;      ///< largest of theirs
  std::vector<size_t> portals;  ///< that lie in it
  /// Without a portal of its own it is right where straight on all of its light passes others.
  bool right() const { return coverage >= 0.98 && tightness >= 0.90 && angle <= 3; }
};

struct PortalTruth {
  double light = 0;  ///< share of the paths that cross it along its normal
  /// Share of its lines, uniform by etendue between the surfaces on either side, that pass an
  /// opening; relative to that of the openings' hull where the portal lies in the wall.
  double tightness = 0;
  double angle = 180;  ///< to the normal of one of them or, of a door ajar, to one between those of
                       ///< gap and doorway [degrees]
  std::vector<size_t> openings;  ///< that it lies in, in one plane; empty: none
};

struct HouseScore {
  std::vector<OpeningScore> openings;
  std::vector<PortalTruth> portals;
};

/// `scene` without its glass.
HouseScore score_house(const Scene& scene, const Tracer& tracer,
                       const std::vector<HouseOpening>& openings, const LightPaths& paths,
                       const std::vector<Portal>& portals);

}  // namespace tdpt::testing
