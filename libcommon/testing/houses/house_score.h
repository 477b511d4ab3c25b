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

/// An opening with its parts: a door ajar has the gap beside its leaf and the wedge above it.
struct HouseOpening {
  std::string name, kind, state;
  std::vector<std::string> rooms;  ///< two
  std::vector<OpeningPart> parts;
  /// Of a door ajar: the whole doorway, which parts the rooms as the parts together do.
  std::vector<OpeningPart> doorway;
};

/// Throws InputError.
std::vector<HouseOpening> read_openings(const std::string& file);

struct OpeningScore {
  double light = 0;      ///< share of the paths that pass it
  bool forward = true;   ///< most of them along its normal
  double coverage = 0;   ///< share of those that cross portals of openings on the same edge
  double tightness = 1;  ///< least of the portals that lie in it
  double angle = 0;      ///< largest [degrees], to its normal or, of a door ajar, to one between
                         ///< those of gap and doorway
  std::vector<size_t> portals;  ///< that lie in it
  bool right() const {
    return coverage >= 0.98 && tightness >= 0.90 && angle <= 3 && !portals.empty();
  }
};

struct PortalTruth {
  double light = 0;      ///< share of the paths that cross it along its normal
  double in_opening = 0;  ///< share of its lines, uniform by etendue between the surfaces on either
                         ///< side, that pass an opening
  int opening = -1;      ///< that most of them pass; -1: it lies in none
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
