// One run of the program, from the command line to the film.
#pragma once
#include <string>
#include <vector>

#include "libcommon/cli/cli.h"
#include "tools/tdpt-render/run/arguments.h"
#include "tools/tdpt-render/run/checkpoint.h"
#include "tools/tdpt-render/run/choice.h"
#include "tools/tdpt-render/run/scenery.h"

namespace tdpt {

struct Job {
  const Arguments& a;
  const cli::Common& common;
  Loaded& in;
  Request request;
  RenderSettings settings;
  Checkpoint given;
  Shape shape, film_shape;
  std::string mark;  ///< of a complete frame of a shot [shot.h]
  std::string code;  ///< instruction set that renders [FilmFacts::processor]

  bool is_shard() const { return !a.shard.empty(); }
  bool only_plans() const { return tdpt::only_plans(a, common.output_given); }
  /// Whether a plan is written beside the picture.
  bool writes_plan() const { return !a.plan.empty() && given.plan_file.empty(); }
  /// Where to save the rendering's progress; empty: nowhere.
  std::string checkpoint() const { return a.checkpoint.empty() ? a.resume : a.checkpoint; }
};

}  // namespace tdpt
