// The files of a picture: checkpoints and previews on the way, the picture and whatever else was
// asked for at the end.
#pragma once
#include <array>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "libcommon/options/render_options.h"
#include "tools/tdpt-render/run/render.h"

namespace tdpt {

class Delivery {
 public:
  /// `facts`: of the film, with the attributes that are known before it is rendered.
  Delivery(const RenderArguments& a, const cli::Common& common, FilmFacts facts)
      : a_(a), common_(common), facts_(std::move(facts)) {}

  /// Where the checkpoint is kept; empty: nowhere.
  const std::string& checkpoint() const {
    return a_.checkpoint.empty() ? a_.resume : a_.checkpoint;
  }
  /// Writes it. A failure is only a warning, since the previous one stays whole; returns false
  /// then.
  bool save(const Plan& plan, Progress& progress, const Channels& channels = {}) const;
  /// Between passes: renews checkpoint and preview where they are due, each for at most a tenth of
  /// the time.
  void renew(const Plan& plan, Progress& progress);

  /// Writes everything at the end. `channels`: those that samples do not change. `stats`: of
  /// --stats; what became of the picture after its last sample is added. Returns what the filter
  /// did, in a sentence; empty without one. Throws Error for what cannot be written, and says where
  /// the picture is kept.
  std::string deliver(const RenderResult& result, const Channels& channels,
                      nlohmann::ordered_json& stats);

 private:
  void show(const Picture& picture) const;

  const RenderArguments& a_;
  const cli::Common& common_;
  FilmFacts facts_;
  std::array<double, 2> due_{};  // when checkpoint and preview are [s]; 0: not known
};

/// The --aov channels that are computed from the film's sums, and the filter: FilmFacts::derived.
std::vector<std::string> derived_of(const RenderArguments& a);
/// The --aov channels that samples do not change, and those that the filter needs.
Channels channels_of(const RenderArguments& a, const Vista& vista, uint64_t seed);

}  // namespace tdpt
