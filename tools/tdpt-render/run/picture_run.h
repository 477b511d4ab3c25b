// The making of one picture: from what the command line says to the files.
#pragma once
#include <memory>
#include <optional>
#include <string>

#include "libcommon/gpu/device.h"
#include "tools/tdpt-render/integrators/sample_renderer.h"
#include "tools/tdpt-render/plan/shot_plan.h"
#include "tools/tdpt-render/run/delivery.h"
#include "tools/tdpt-render/run/job.h"
#include "tools/tdpt-render/run/scenery.h"

namespace tdpt {

/// The last frame of a shot as it was rendered: those in which nothing moves go on from it.
struct StillFrame {
  int64_t since = 0;  ///< as in Arguments
  Plan plan;
  std::shared_ptr<RenderState> render_state;
};

/// What the pictures of one command share.
struct Workshop {
  std::optional<gpu::Device> device;  ///< that renders; none: the CPU
  Scenery scenery{};
  std::optional<StillFrame> still{};  ///< with --accumulate
  bool told = false;                  ///< what the device is
  std::string code() const;           ///< Job::code
};

Shaping shaping_of(const Loaded& in, const Arguments& a, const cli::Common& common);

struct Made {
  int code = 0;         ///< exit code
  std::string words{};  ///< how many samples, how long, how noisy
};
/// Makes the picture, or with --plan alone its plan. `plan`: to obey; null: it is decided. `mark`:
/// Job::mark.
Made render_picture(const Arguments& a, const cli::Common& common, Workshop& shop,
                    const PlanFile* plan, const std::string& mark = "");

/// The same of a frame that is to be filtered with those beside it: its picture is not written yet.
struct MadeNoisy : Made {
  Unfiltered picture{};  ///< if `code` is 0
};
MadeNoisy render_noisy(const Arguments& a, const cli::Common& common, Workshop& shop,
                       const PlanFile* plan, const std::string& mark);

/// What may be decided before a frame is rendered.
struct DecidedFrame {
  KeyFrame key;
  Shape shape;  ///< plan_shape_of()
};
DecidedFrame decide_frame(const Arguments& a, const cli::Common& common, Workshop& shop);

}  // namespace tdpt
