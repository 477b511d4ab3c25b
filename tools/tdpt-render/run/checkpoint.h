// How --checkpoint, --resume, --plan and --shard affect a rendering: the plan it obeys, where it
// begins, and how its film file identifies its picture, so that films of different pictures are
// never added.
#pragma once
#include <string>

#include "tools/tdpt-render/run/arguments.h"
#include "tools/tdpt-render/run/render.h"

namespace tdpt {

/// One of `of` parts of a picture's samples.
struct Shard {
  uint64_t index = 0, of = 1;
  /// Its samples of those from `first` on; parts differ by at most one sample.
  SampleRange part(uint64_t first, uint64_t samples) const;
};
/// Reads "I/N". Throws UsageError.
Shard shard_of(const std::string& text);

/// Throws UsageError for contradictory options, and for a checkpoint that would be overwritten.
void check_schedule(const Arguments& a);

/// Identifies a camera of the scene by name, any other by its position and orientation.
std::string camera_words(const Arguments& a, const Frame& frame, const Camera& camera);

/// Everything that determines the picture, apart from its plan and its samples.
struct Shaping {
  const Scene& scene;
  TakenSky sky;
  std::string camera;                      ///< camera_words()
  std::vector<std::string> portal_hashes;  ///< in order
  int width, height;
  uint64_t seed;
};
/// What a plan is made for: the picture, or of a frame what all frames of its shot share.
Shape plan_shape_of(const Arguments& a, const Shaping& by);
/// The picture, with the sums that its film keeps.
Shape film_shape_of(const Arguments& a, const Shaping& by);

/// Samples per pixel of a picture by its plan, with those of frames before that it keeps.
uint64_t samples_of(const Plan& plan, const Arguments& a);

struct Checkpoint {
  RenderSchedule schedule;
  std::string plan_file;  ///< source of the schedule's plan; empty: it is yet to be decided
  /// Attributes of the picture, from the film that is resumed; empty: there is none.
  std::map<std::string, std::string> attributes;
  std::string command;    ///< that made the plan; empty: this one
  std::string processor;  ///< whose code rendered the film so far; empty: there is none
};
/// Reads the film to resume, or takes the plan to obey, and its limits into `settings`. Throws
/// UsageError or InputError if they do not belong together. `plan`: to obey; null: there is none.
Checkpoint read_checkpoint(const Arguments& a, const Shaping& by, const World& world,
                           const PlanFile* plan, RenderSettings& settings);

/// Explains why a film rendered by the code `before` changes when resumed by that of `now`.
std::string other_code_sentence(const std::string& file, const std::string& before,
                                const std::string& now);

/// Throws InputError if the film to resume keeps other sums than `options` ask for.
void check_film(const Checkpoint& given, const Film::Options& options);

/// The film file of a rendering. `derived`, `attributes`, `channels`: of the whole picture.
std::string film_bytes(RenderState& render_state, const Plan& plan, const Shape& shape,
                       const std::string& processor, const std::vector<std::string>& derived,
                       const std::map<std::string, std::string>& attributes,
                       const Channels& channels);

/// --shard all/N: the shell commands of the shards, one a line; with `output` PICTURE.exr they
/// write PICTURE.I-of-N.exr. `arguments`: the command line. Throws UsageError if that does not fix
/// the number of samples, or if shards would write the same files.
std::string shard_commands(const Arguments& a, const std::vector<std::string>& arguments,
                           const std::string& output);
/// The command that merges the shards; of a shot, those of its first frame.
std::string merge_command(const Arguments& a, const std::string& pattern);

}  // namespace tdpt
