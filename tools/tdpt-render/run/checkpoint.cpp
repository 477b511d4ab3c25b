#include "tools/tdpt-render/run/checkpoint.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include <fmt/format.h>

#include "libcommon/base/counted.h"
#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/shell_quoted.h"
#include "libcommon/base/shown.h"
#include "libcommon/formats/viewpoint.h"
#include "tdpt_version.h"
#include "tools/tdpt-render/run/report.h"

namespace tdpt {
namespace {

// An empty file does not count: it may be a placeholder for one to come.
bool is_there(const std::string& path) {
  std::error_code failed;
  const auto size = std::filesystem::file_size(path, failed);
  return !failed && size > 0;
}

bool is_same(const std::string& a, const std::string& b) {
  return !b.empty() &&
         std::filesystem::path(a).lexically_normal() == std::filesystem::path(b).lexically_normal();
}

// "guided 0.7 0.4 0.25 0.5", from the options given.
std::string integrator_words(const Arguments& a) {
  std::string words = a.integrator;
  for (const auto& [name, value] :
       {std::pair("guide-light", a.guide_light), std::pair("guide-camera", a.guide_camera),
        std::pair("segments", a.segments), std::pair("light-walks", a.light_walks)})
    if (value >= 0) words += fmt::format(" {} {}", name, value);
  return words;
}

std::string sky_words(const Arguments& a, const Shaping& by) {
  if (by.sky.environment.empty()) return "";
  return fmt::format("{} x {}, sun {}", by.scene.sky_hash, by.sky.scale, a.sky.sun_angle);
}

// "1.5 s of Walk Door"; empty for a scene that stands still.
std::string pose_words(const Arguments& a, const Scene& scene) {
  if (!scene.moves) return "";
  const std::string of = fmt::format("{}", fmt::join(a.pose.animations, " "));
  return fmt::format("{} s{}", a.pose.seconds.value_or(0), of.empty() ? "" : " of " + of);
}

// Those in use, whether asked for or guessed.
std::string units_of_lamps(const Scene& scene) {
  if (!scene.has_lamps()) return "";
  return names_of_lamp_units().at(static_cast<size_t>(scene.lamp_units.kind));
}

// To the command that began the picture, in its provenance.
void add_option(const std::string& option, std::map<std::string, std::string>& attributes) {
  const auto provenance = attributes.find(provenance_attribute);
  if (provenance != attributes.end())
    provenance->second = with_option(provenance->second, "tdpt-render", option);
}

// Throws UsageError for limits given now that the first run did not have.
void check_limits(const Arguments& a, const Limits& then) {
  const auto check = [&](const char* option, double now, double before) {
    if (now == 0 || now == before) return;
    throw UsageError(fmt::format("{} {}: {} was begun with {}; leave it out", option, now,
                                 display_name(a.resume),
                                 before > 0 ? fmt::format("{}", before) : "another limit"));
  };
  check("--spp", static_cast<double>(a.spp), static_cast<double>(then.spp));
  check("--time", a.seconds, then.seconds);
  check("--target-error", a.target_error, then.target_error);
}

// More samples than the first run was to have, or more time. A target error was aimed at before the
// first sample, and a shard is of a fixed size.
void take_limits(const Arguments& a, RenderState& render_state,
                 std::map<std::string, std::string>& attributes) {
  Limits& limits = render_state.limits;
  const auto spp = static_cast<uint64_t>(a.spp);
  if (limits.target_error > 0 || a.target_error > 0 || render_state.whole > 0)
    return check_limits(a, limits);
  if (spp == 0 && a.seconds == 0) return;
  if (spp == limits.spp && a.seconds == limits.seconds) return;
  if (spp > 0 && spp < render_state.film.samples())
    throw UsageError(fmt::format("--spp {}: {} has {} per pixel already", spp,
                                 display_name(a.resume),
                                 counted(render_state.film.samples(), "sample")));
  limits = {.spp = spp, .seconds = a.seconds};
  render_state.goal = spp;
  render_state.added = 0;
  if (spp > 0) add_option(fmt::format("--spp {}", spp), attributes);
}

// Raises the picture's goal. If the last --add-samples asked for as many and was cut short, this is
// the same command run again: it adds nothing and returns false.
bool add_samples(uint64_t n, RenderState& render_state) {
  if (render_state.added == n && render_state.film.samples() < render_state.goal) return false;
  if (std::max(render_state.goal, render_state.film.samples()) + n > kMostSamples)
    throw UsageError(fmt::format("--add-samples {}: a picture has {} samples per pixel at the most",
                                 n, kMostSamples));
  render_state.goal = (render_state.goal > 0 ? render_state.goal : render_state.film.samples()) + n;
  render_state.added = n;
  render_state.target.reset();
  return true;
}

// Makes the number of samples the only limit.
void limit_to(uint64_t spp, RenderSettings& settings) {
  static_cast<Limits&>(settings) = {.spp = spp};
}

// Of a frame: its plan says how many samples it has. One that a time or an error made is another
// each time unless a file keeps it: then that of the film stands.
void check_limits_of_frame(const Arguments& a, const Plan& planned, const Limits& then) {
  const uint64_t spp = samples_of(planned, a);
  const bool measured = a.plan.empty() && (a.seconds > 0 || a.target_error > 0);
  if (!measured && spp != then.spp)
    throw InputError(display_name(a.resume), "",
                     fmt::format("is of {}, this frame has {}", counted(then.spp, "sample"), spp));
}

// Refuses a film that cannot hold this world's samples, whatever its file claims.
void check_film(const RenderState& render_state, const World& world, const std::string& file) {
  const Film& film = render_state.film;
  if (film.width() != world.film.width() || film.height() != world.film.height() ||
      film.unit() != Film(1, 1, world.lights.power()).unit() ||
      (!render_state.tally.portals.empty() &&
       render_state.tally.portals.size() != world.portals.portals()))
    throw InputError(file, "film", "keeps other sums than this picture");
}

Checkpoint planned(const Arguments& a, const Shaping& by, const PlanFile& file) {
  const std::string name = a.plan.empty() ? "the plan of the shot" : display_name(a.plan);
  if (a.frame.has_value() == file.frames.empty())
    throw InputError(name, "",
                     a.frame ? "is the plan of a picture, expected one of a shot"
                             : "is the plan of a shot, expected one of a picture");
  if (const std::string other = difference(file.shape, plan_shape_of(a, by)); !other.empty())
    throw InputError(name, "", "is of " + other);
  const Plan& plan = a.frame ? file.of_frame(a.since) : file.plan;
  if (plan.spp == 0) throw InputError(name, "spp", "is 0, expected a number of samples");
  const auto spp = static_cast<uint64_t>(a.spp);
  // A picture may have fewer samples than its plan; shards are parts of all.
  if (a.spp > 0 && (a.shard.empty() ? spp > plan.spp : spp != plan.spp))
    throw UsageError(
        fmt::format("--spp {}: {} is of {}", a.spp, name, counted(plan.spp, "sample")));
  Checkpoint given;
  given.plan_file = name;
  given.schedule.plan = plan;
  if (a.spp > 0) given.schedule.plan->spp = spp;
  given.command = a.frame ? command_of_frames(file.command, {a.since, *a.frame}) : file.command;
  return given;
}

Checkpoint resumed(const Arguments& a, const Shaping& by, const World& world, const PlanFile* plan,
                   RenderSettings& settings) {
  const std::string name = display_name(a.resume);
  FilmFile film = read_film(a.resume);
  if (const std::string other = difference(film.facts.shape, film_shape_of(a, by)); !other.empty())
    throw InputError(name, "", "is of " + other);
  Checkpoint given;
  given.plan_file = name;
  given.schedule.plan = read_plan(film.facts.plan, name);
  given.processor = film.facts.processor;
  given.attributes = film.facts.attributes;
  // These say how a rendering ended, which is yet to come.
  for (const char* word : {"targetError", "estimatedError", "stoppedBy"})
    given.attributes.erase(word);
  if (film.facts.spp == 0) throw InputError(name, "film", "has no samples");
  RenderState render_state = render_state_of(std::move(film), name);
  check_film(render_state, world, name);
  if (a.shard.empty() && (render_state.first > 0 || render_state.whole > 0))
    throw UsageError(
        fmt::format("--resume {}: is a shard, of {} of {}; give --shard as it was begun", name,
                    words_of({{render_state.first, render_state.goal}}), render_state.whole));
  if (!a.shard.empty()) {
    // With portals of its own, a frame obeys a plan only as far as they allow.
    if (plan && !a.portals_by_frame &&
        !(planned(a, by, *plan).schedule.plan == given.schedule.plan))
      throw InputError(name, "", "was rendered by another plan than " + display_name(a.plan));
    const SampleRange part = shard_of(a.shard).part(0, render_state.spp());
    if (part.first != render_state.first || part.count != render_state.goal)
      throw InputError(name, "",
                       fmt::format("is to hold {}, not those of shard {}",
                                   words_of({{render_state.first, render_state.goal}}), a.shard));
  }
  if (a.frame && plan)
    check_limits_of_frame(a, *planned(a, by, *plan).schedule.plan, render_state.limits);
  else
    take_limits(a, render_state, given.attributes);
  static_cast<Limits&>(settings) = render_state.limits;
  if (a.add_samples > 0) {
    if (render_state.first > 0 || render_state.whole > 0)
      throw UsageError("--add-samples: " + name + " is a shard, which is of a fixed size");
    if (add_samples(static_cast<uint64_t>(a.add_samples), render_state))
      add_option(fmt::format("--add-samples {}", a.add_samples), given.attributes);
  }
  if (render_state.added > 0) limit_to(render_state.goal, settings);
  given.schedule.render_state.emplace(std::move(render_state));
  return given;
}

// The options that all shards share.
std::vector<std::string> words_of_shards(const std::vector<std::string>& arguments) {
  std::vector<std::string> words;
  for (size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    const std::string option = word.substr(0, word.find('='));
    const bool own = option == "-o" || option == "--output" || option == "--shard" ||
                     option == "--checkpoint" || option == "--resume";
    if (own && option == word) ++i;
    if (!own && (!word.starts_with("-o") || word == "-o")) words.push_back(shell_quoted(word));
  }
  return words;
}

// N of --shard all/N.
uint64_t shards_of(const Arguments& a) {
  return shard_of("0" + a.shard.substr(a.shard.find('/'))).of;
}

// "out/a" of "out/a.exr".
std::string stem_of(const std::string& output) {
  const std::filesystem::path path(output);
  return (path.parent_path() / path.stem()).string();
}

}  // namespace

SampleRange Shard::part(uint64_t first, uint64_t samples) const {
  const auto at = [&](uint64_t i) {
    return static_cast<uint64_t>(static_cast<unsigned __int128>(samples) * i / of);
  };
  return {first + at(index), at(index + 1) - at(index)};
}

Shard shard_of(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto index = std::from_chars(text.data(), end, shard.index);
  const bool is_pair = index.ec == std::errc() && index.ptr != end && *index.ptr == '/';
  const auto of = is_pair ? std::from_chars(index.ptr + 1, end, shard.of) : index;
  if (!is_pair || of.ec != std::errc() || of.ptr != end || shard.index >= shard.of ||
      shard.of > 1 << 20)
    throw UsageError("--shard " + text +
                     ": expected I/N with I from 0 to N - 1, N up to 1048576, or all/N");
  return shard;
}

void check_schedule(const Arguments& a) {
  if (a.checkpoint_every >= 0 && a.checkpoint.empty() && a.resume.empty())
    throw UsageError("--set checkpoint-every: needs --checkpoint or --resume");
  if (a.retry > 0 && a.target_error == 0 && a.resume.empty())
    throw UsageError("--set retry: needs --target-error");
  if (a.add_samples > 0 && a.resume.empty())
    throw UsageError("--add-samples: needs --resume with the film of the picture");
  if (!a.shard.empty()) {
    shard_of(a.shard);
    if (a.plan.empty() && (a.seconds > 0 || a.target_error > 0))
      throw UsageError(
          "--shard: needs a number of samples; --plan makes one of --time or "
          "--target-error");
    if (a.spp == 0 && a.plan.empty() && a.resume.empty())
      throw UsageError("--shard: needs --spp, or --plan with the number of samples");
  }
  if (!a.plan.empty() && a.shard.empty() && !a.resume.empty() && !a.shot.is_given())
    throw UsageError("--plan: nothing is decided with --resume, which obeys its own plan");
  if (!a.checkpoint.empty() && !is_same(a.checkpoint, a.resume) && is_there(a.checkpoint))
    throw UsageError("--checkpoint " + a.checkpoint +
                     ": is there already; go on from it with --resume, or remove it");
}

std::string camera_words(const Arguments& a, const Frame& frame, const Camera& camera) {
  const bool of_the_scene = a.camera.look_from.empty() && !a.camera.frame;
  std::string words = of_the_scene ? camera.name : viewpoint_text(frame, camera);
  return of_the_scene && camera.culls ? words + " --cull" : words;
}

namespace {

Shape shape_of(const Arguments& a, const Shaping& by, const std::string& pose, uint64_t seed) {
  return {{"program version", TDPT_VERSION},
          {"scene", by.scene.hash},
          {"environment", sky_words(a, by)},
          {"unit of lamps", units_of_lamps(by.scene)},
          {"portal", fmt::format("{}", fmt::join(by.portal_hashes, " "))},
          {"camera", by.camera},
          {"lens", lens_words(a.lens)},
          {"shutter", shutter_words(a.lens, a.shot)},
          {"pose", pose},
          {"size", fmt::format("{} x {}", by.width, by.height)},
          {"depth", a.max_depth > 0 ? std::to_string(a.max_depth) : "any"},
          {"integrator", integrator_words(a)},
          {"heuristic", a.mis},
          {"seed", std::to_string(seed)}};
}

}  // namespace

Shape plan_shape_of(const Arguments& a, const Shaping& by) {
  if (!a.frame) return shape_of(a, by, pose_words(a, by.scene), by.seed);
  const std::string of = fmt::format("{}", fmt::join(a.pose.animations, " "));
  Shaping shared = by;
  if (a.portals_by_frame) shared.portal_hashes = {"of each frame"};
  return shape_of(a, shared,
                  fmt::format("{} frames per second{}{}", a.shot.fps, of.empty() ? "" : " of " + of,
                              a.accumulate ? ", accumulated" : ""),
                  by.seed - static_cast<uint64_t>(a.since));
}

Shape film_shape_of(const Arguments& a, const Shaping& by) {
  Shape shape = shape_of(a, by, pose_words(a, by.scene), by.seed);
  shape.emplace_back("film", a.alpha ? "transparent" : "opaque");
  const bool halves = keeps_halves(a);
  shape.emplace_back("set of layers",
                     fmt::format("{}{}{}", a.layers ? "techniques" : "",
                                 a.layers && halves ? " " : "", halves ? "halves" : ""));
  return shape;
}

uint64_t samples_of(const Plan& plan, const Arguments& a) {
  return std::min(plan.spp * a.frames_held(), kMostSamples);
}

Checkpoint read_checkpoint(const Arguments& a, const Shaping& by, const World& world,
                           const PlanFile* plan, RenderSettings& settings) {
  // A file named for both is created if it does not exist yet.
  const bool begins = is_same(a.checkpoint, a.resume) && !is_there(a.resume);
  if (!a.resume.empty() && !begins) return resumed(a, by, world, plan, settings);
  Checkpoint given = plan ? planned(a, by, *plan) : Checkpoint();
  if (plan) limit_to(given.schedule.plan->spp, settings);
  if (a.shard.empty()) return given;
  const uint64_t spp = settings.spp;
  given.schedule.part = shard_of(a.shard).part(0, spp);
  given.schedule.whole = spp;
  if (given.schedule.part.count == 0)
    throw UsageError(fmt::format("--shard {}: there {} only {}", a.shard, spp == 1 ? "is" : "are",
                                 counted(spp, "sample")));
  return given;
}

std::string other_code_sentence(const std::string& file, const std::string& before,
                                const std::string& now) {
  const bool both = merged_words(before, now).find(kGpuCode) != std::string::npos;
  return fmt::format(
      "{} was rendered by code for {}, this is code for {}: {}", file, shown(before), now,
      both ? "CPU and GPU agree in the mean, but not in the last digits of each sample"
           : "the last digits may differ from those of one machine; --set isa=sse2 is "
             "alike on all");
}

void check_film(const Checkpoint& given, const Film::Options& options) {
  if (given.schedule.render_state && given.schedule.render_state->film.options() != options)
    throw InputError(given.plan_file, "film", "keeps other sums than this picture");
}

std::string film_bytes(RenderState& render_state, const Plan& plan, const Shape& shape,
                       const std::string& processor, const std::vector<std::string>& derived,
                       const std::map<std::string, std::string>& attributes,
                       const Channels& channels) {
  FilmFacts facts;
  facts.derived = derived;
  facts.shape = shape;
  facts.plan = plan_text(plan);
  facts.state = render_state_text(render_state);
  facts.processor = processor;
  facts.spp = render_state.spp();
  facts.counts = counts_of(render_state.tally);
  facts.attributes = attributes;
  return film_bytes(render_state.film, facts, blocks_of(render_state), channels);
}

std::string shard_commands(const Arguments& a, const std::vector<std::string>& arguments,
                           const std::string& output) {
  if (a.plan.empty() && a.spp == 0)
    throw UsageError("--shard all: needs --spp, or --plan with the number of samples");
  if (output == "-") throw UsageError("--shard all: needs -o, the picture to merge into");
  for (const auto& [option, path] :
       {std::pair("--stats", a.stats), std::pair("--set nonzero", a.nonzero),
        std::pair("--preview", a.preview)})
    if (!path.empty())
      throw UsageError(std::string("--shard all: every shard would write to ") + option);
  const auto name = [&](const std::string& part) {
    return shell_quoted(stem_of(output) + "." + part + ".exr");
  };
  const uint64_t n = shards_of(a);
  if (a.spp > 0 && n > static_cast<uint64_t>(a.spp))
    throw UsageError(fmt::format("--shard {}: there are only {} samples", a.shard, a.spp));
  for (const std::string& word : arguments)
    if (word.starts_with("-MF") || word.starts_with("dependencies") ||
        word.starts_with("--set=dependencies"))
      throw UsageError("--shard all: every shard would write to " + word);
  const std::string command = fmt::format("{}", fmt::join(words_of_shards(arguments), " "));
  std::string text;
  for (uint64_t i = 0; i < n; ++i) {
    const std::string part = fmt::format("{}-of-{}", i, n);
    text += fmt::format("{} --shard {}/{} -o {}", command, i, n, name(part));
    if (!a.checkpoint.empty())
      text += fmt::format(" --checkpoint {0} --resume {0}", name(part + ".checkpoint"));
    text += '\n';
  }
  return text;
}

std::string merge_command(const Arguments& a, const std::string& pattern) {
  const std::string output =
      a.shot.is_given() ? name_of_frame("-o", pattern, frame_range(a.shot).first) : pattern;
  // The shell must expand the star: it stays outside the quotes.
  return fmt::format("exrmerge {}.*-of-{}.exr -o {}", shell_quoted(stem_of(output)), shards_of(a),
                     shell_quoted(output));
}

}  // namespace tdpt
