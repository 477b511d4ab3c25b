// The options of a rendering, shared by tdpt-render, which obeys them, and tdpt, which passes them
// on. Their meaning: tdpt-render(1).
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/options/camera_options.h"
#include "libcommon/options/picture_options.h"
#include "libcommon/options/shot_options.h"
#include "libcommon/options/sky_options.h"

namespace tdpt {

/// Values of --integrator besides "auto", in the order of tdpt-render's table.
inline constexpr std::array kIntegratorNames{"pt",       "nee",  "bdpt",
                                             "tdpt-org", "tdpt", "tdpt-guided"};
/// Values of --denoiser; the first is the default. The last needs no halves.
inline constexpr std::array kDenoisers{"auto", "regression", "oidn"};
inline constexpr int kMostEdges = 1024;                   ///< per path
inline constexpr double kSmallestWalkShare = 1.0 / 16.0;  ///< share of samples with a light walk

struct RenderArguments : PictureArguments {
  std::string scene, device = "cpu";
  std::vector<std::string> portals;
  SkyArguments sky;
  CameraArguments camera;
  Pose pose;
  ShotArguments shot;
  LensArguments lens;
  int64_t width = 0, height = 0;  ///< pixels; 0: not given

  std::string integrator = "auto", mis = "balance";
  double guide_light = -1, guide_camera = -1, segments = -1,
         light_walks = -1;  ///< negative: not given
  int64_t spp = 0;
  int64_t max_depth = 0;    ///< edges; 0: no limit
  double seconds = 0;       ///< 0: no limit
  double target_error = 0;  ///< relMSE; 0: none

  std::string checkpoint, resume;  ///< paths; empty: not given
  double checkpoint_every = -1;    ///< seconds; negative: not given
  int64_t add_samples = 0;
  std::string isa = "native";
  std::string shard;  ///< "I/N"; empty: not given. Of tdpt-render alone, as is
  bool check = false;

  std::string stats, nonzero;  ///< paths; empty: not asked for
  bool layers = false, alpha = false;
  std::string aov;  ///< names, separated by commas
  bool denoise = false;
  std::string denoiser;  ///< of kDenoisers; empty: not given
  /// Whether the picture is to be filtered.
  bool filters() const { return denoise || !denoiser.empty(); }
};

/// All of them except the scene, --device, and the options that split a picture among machines.
void declare_render_options(cli::Options& options, RenderArguments& a);

/// Throws UsageError for invalid combinations of options.
void check_render_arguments(const RenderArguments& a);

}  // namespace tdpt
