// A picture with a target error: when it ends, whether it is rendered on, and what is told of it.
#pragma once
#include <map>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "tools/tdpt-render/plan/session.h"
#include "tools/tdpt-render/run/progress.h"

namespace tdpt {

struct TargetOutcome {
  /// `fixed`: the fixed number was rendered; `unlit`: the pilot met no light and fixed none.
  enum class Stop { fixed, spp, time, signal, unlit };

  double error = 0;    ///< the target
  uint64_t fixed = 0;  ///< samples per pixel that it takes; 0: not known
  Stop stop = Stop::fixed;
  bool dark = false;           ///< nothing in the scene emits light: there is no error
  std::optional<Noise> noise;  ///< of the picture, estimated; none if no light was met
  bool reached() const { return dark || (noise && noise->relmse <= error); }
};

/// The outcome as it stands, if there is a target. `noise`: of the picture, if it is known; else
/// what its blocks or the pilot show.
std::optional<TargetOutcome> judge(const Session& session, const Plan& plan,
                                   const Progress& progress, const std::optional<Noise>& noise);
/// Whether a second try is due: then raises the goal. The samples rendered so far are kept.
bool raise_goal(TargetOutcome& target, Progress& progress);

/// "target relMSE 0.01 reached: ..." or what stopped it.
std::string target_sentence(const TargetOutcome& target, const Progress& progress);
/// The object `target` of tdpt-render(1), STATISTICS.
nlohmann::ordered_json target_json(const TargetOutcome& target, const Plan& plan,
                                   const Progress& progress);
/// String attributes of the EXR header.
std::map<std::string, std::string> target_attributes(const TargetOutcome& target);

}  // namespace tdpt
