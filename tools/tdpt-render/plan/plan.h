// Everything a run decides by measuring before it renders. Given scene, portals, settings and plan,
// each range of samples yields the same bytes, whatever the number of threads or of parts.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/film/film_file.h"
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/plan/portal_ways.h"
#include "tools/tdpt-render/plan/truncation.h"

namespace tdpt {

struct Plan {
  Integrator integrator = bdpt;      ///< renders the picture's own samples
  std::string label;                 ///< of the chosen candidate
  uint64_t spp = 0;                  ///< samples per pixel; 0: as many as the time allows
  std::vector<PortalWay> ways;       ///< which way portals work; empty: as drawn
  Lights::KindProbabilities lights;  ///< selection probability of each kind
  std::optional<Truncation> beyond;  ///< light lost by the limit of depth, if there is one

  /// Whether both yield the same picture.
  friend bool operator==(const Plan& a, const Plan& b);
};

/// As JSON: an object on one line.
std::string plan_text(const Plan& plan);
/// Reads it back. `file`: its name in messages. Throws InputError.
Plan read_plan(const std::string& text, const std::string& file);

/// A plan on disk, with what it was made for.
struct PlanFile {
  Plan plan;                         ///< of a picture; unused for a shot
  Shape shape;                       ///< of the picture, or of what the frames of the shot share
  std::string command;               ///< that made the plan, for provenance
  std::map<int64_t, Plan> frames{};  ///< of a shot: what was decided at its key frames

  /// Of the key frame that is nearest.
  const Plan& of_frame(int64_t frame) const;
};
/// As indented JSON, for people too.
std::string plan_file_text(const PlanFile& file);
/// Reads one. Throws InputError.
PlanFile read_plan_file(const std::string& path);

}  // namespace tdpt
