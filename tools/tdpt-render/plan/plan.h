// All that a run decides by measuring, before it renders. Given scene, portals, settings and plan,
// each range of samples has the same bytes, on however many threads, in however many parts.
#pragma once
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
  std::string label;                 ///< of the candidate that it is
  uint64_t spp = 0;                  ///< samples of each pixel; 0: as many as the time allows
  std::vector<PortalWay> ways;       ///< which way portals work; empty: as drawn
  Lights::KindProbabilities lights;  ///< how often each kind is chosen
  std::optional<Truncation> beyond;  ///< what the limit of depth leaves out, where there is one

  /// Whether they make the same picture.
  friend bool operator==(const Plan& a, const Plan& b);
};

/// As JSON: an object on one line.
std::string plan_text(const Plan& plan);
/// Reads it back. `file`: names it in messages. Throws InputError.
Plan read_plan(const std::string& text, const std::string& file);

/// A plan on disk, with what it was made for.
struct PlanFile {
  Plan plan;
  Shape shape;          ///< of the picture
  std::string command;  ///< that made it, for provenance
};
/// As JSON, for people to read as well.
std::string plan_file_text(const PlanFile& file);
/// Reads one. Throws InputError.
PlanFile read_plan_file(const std::string& path);

}  // namespace tdpt
