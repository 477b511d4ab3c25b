#include "tools/tdpt-render/run/progress.h"

#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "tools/tdpt-render/run/options.h"

namespace tdpt {
namespace {

using Json = nlohmann::ordered_json;

// ---- The state: numbers by name, none of them negative ----

constexpr uint64_t kMostCount = uint64_t{1} << 40;
constexpr double kMostNumber = 1e12;

template <class P>
void for_each_number(P& progress, const auto& visit) {
  visit("spp", progress.limits.spp);
  visit("time", progress.limits.seconds);
  visit("target_error", progress.limits.target_error);
  visit("first", progress.first);
  visit("goal", progress.goal);
  visit("added", progress.added);
  visit("whole", progress.whole);
  visit("seconds", progress.seconds);
  visit("cpu_seconds", progress.cpu_seconds);
  visit("began", progress.began);
  auto& pilot = progress.error_pilot;
  visit("needed", pilot.needed);
  visit("pilot_cpu", pilot.cpu_seconds);
  visit("pilot_samples", pilot.estimate.samples);
  visit("relmse", pilot.estimate.relmse);
  visit("spread", pilot.estimate.spread);
  visit("pixels", pilot.estimate.pixels);
}

constexpr const char* kBlockSamples = "block_samples";

std::string state_text(const Progress& progress) {
  Json state;
  for_each_number(progress, [&](const char* key, auto value) {
    state[key] = value;
    if constexpr (std::is_same_v<decltype(value), double>)
      state[key] = value < kMostNumber ? value : kMostNumber;  // JSON has no infinity
  });
  state[kBlockSamples] = progress.blocks.size();
  return state.dump();
}

// Fills in `progress`; returns the samples of a block.
uint64_t read_state(const std::string& text, const std::string& file, Progress& progress) {
  const Json state = nested_too_deep(text) ? Json() : Json::parse(text, nullptr, false);
  if (!state.is_object()) throw InputError(file, "film.state", "is no JSON object");
  const auto read = [&]<class Number>(const char* key, Number& value) {
    const Json number = state.value(key, Json());
    const bool sound = std::is_same_v<Number, double>
                           ? number.is_number() && number >= 0 && number <= kMostNumber
                           : number.is_number_unsigned() && number <= kMostCount;
    if (!sound) throw InputError(file, fmt::format("film.state.{}", key), "is out of range");
    value = number.get<Number>();
  };
  for_each_number(progress, read);
  if (progress.goal == 0 && progress.limits.seconds == 0)
    throw InputError(file, "film.state.goal", "is 0, and no time ends the rendering");
  uint64_t block = 0;
  read(kBlockSamples, block);
  return block;
}

// ---- The sums of the tally, which add over parts of a picture ----

constexpr const char* kTally = "tally";

void for_each_count(auto& tally, const auto& visit) {
  auto& rays = tally.rays;
  for (auto* const n :
       {&rays.closest, &rays.shadow, &rays.portal, &rays.connect, &tally.not_finite})
    visit(*n);
  for (auto& sum : tally.energy) visit(sum);
  for (auto& sum : tally.by_length) visit(sum);
  for (auto& portal : tally.portals) visit(portal.drawn), visit(portal.lit), visit(portal.energy);
}

Counts counts_of(const Tally& tally) {
  Counts counts;
  for_each_count(tally, [&]<class Count>(const Count& count) {
    if constexpr (std::is_same_v<Count, UnitSum>)
      counts[kTally].push_back(count.units());
    else
      counts[kTally].push_back(count);
  });
  return counts;
}

void add_counts(Counts counts, Tally& tally) {
  constexpr size_t kOwn = 5 + kTechniques + Tally::kOctaves, kOfPortal = 3;
  std::vector<Units>& values = counts[kTally];
  tally.begin_portals((std::max(values.size(), kOwn) - kOwn) / kOfPortal);
  values.resize(kOwn + kOfPortal * tally.portals.size());
  auto at = values.begin();
  for_each_count(tally, [&]<class Count>(Count& count) {
    if constexpr (std::is_same_v<Count, UnitSum>)
      count.merge(*at++);
    else
      count += static_cast<uint64_t>(*at++);
  });
}

// ---- The blocks as words: the means block after block, then the sums at the end of the last ----

static_assert(sizeof(Rgb) == 12 && sizeof(Vec3d) == 24 &&
              std::endian::native == std::endian::little);

StateWords state_words(const PictureBlocks& blocks) {
  StateWords words;
  const auto append = [&](const auto& values) {
    const size_t at = words.size(), bytes = values.size() * sizeof values[0];
    words.resize(at + bytes / 4);
    if (bytes > 0) std::memcpy(words.data() + at, values.data(), bytes);
  };
  for (const std::vector<Rgb>& part : blocks.blocks()) append(part);
  append(blocks.before());
  return words;
}

PictureBlocks blocks_of(const StateWords& words, uint64_t size, const Film& film,
                        const std::string& file) {
  const size_t step = watched_step(film);
  const size_t all = static_cast<size_t>(film.width()) * static_cast<size_t>(film.height());
  const size_t pixels = (all + step - 1) / step;
  if (words.empty() && size > 0) return PictureBlocks(size, {}, {});
  const size_t of_block = 3 * pixels, of_sums = 6 * pixels;
  if (size == 0 || words.size() < of_sums || (words.size() - of_sums) % of_block != 0 ||
      words.size() > of_sums + 7 * of_block)
    throw InputError(file, "film.state.block_samples", "has blocks of another size");
  PictureParts parts((words.size() - of_sums) / of_block, std::vector<Rgb>(pixels));
  const uint32_t* from = words.data();
  for (std::vector<Rgb>& part : parts) {
    std::memcpy(static_cast<void*>(part.data()), from, 4 * of_block);
    from += of_block;
  }
  std::vector<Vec3d> before(pixels);
  std::memcpy(static_cast<void*>(before.data()), from, 4 * of_sums);
  return {size, std::move(parts), std::move(before)};
}

}  // namespace

std::string plan_words(const Plan& plan) {
  const Mixture& m = plan.integrator.mixture;
  const std::array mixture{m.first_direct,       m.later_direct,      m.segments,
                           m.light_walks,        m.connected,         m.connected_to_segments,
                           m.segments_connected, m.guiding.chance[0], m.guiding.chance[1],
                           m.through_windows};
  std::vector<int> ways;
  for (const PortalWay way : plan.explored.ways) ways.push_back(static_cast<int>(way));
  const Lights::KindProbabilities& lights = plan.explored.lights;
  return fmt::format(
      "{}; explored {}; mixture {:.6g}; portals {}; lights {:.6g} {:.6g} {:.6g} {:.6g}", plan.label,
      plan.explored.samples, fmt::join(mixture, " "), fmt::join(ways, " "), lights.surfaces,
      lights.lamps, lights.parallel, lights.sky);
}

std::string label_in(const std::string& plan_words) {
  return plan_words.substr(0, plan_words.find(';'));
}

double explored_in(const std::string& plan_words) {
  constexpr std::string_view kBefore = "; explored ";
  const size_t at = plan_words.find(kBefore);
  double samples = 0;
  if (at != std::string::npos)
    std::from_chars(plan_words.data() + at + kBefore.size(), plan_words.data() + plan_words.size(),
                    samples);
  return samples;
}

std::string film_bytes(Progress& progress, const Plan& plan, FilmFacts facts,
                       const Channels& channels) {
  facts.plan = plan_words(plan);
  facts.state = state_text(progress);
  facts.spp = progress.spp();
  facts.counts = counts_of(progress.tally);
  return film_bytes(progress.film, facts, state_words(progress.blocks), channels);
}

Progress progress_of(FilmFile file, const std::string& name) {
  Progress progress(std::move(file.film), {});
  add_counts(file.facts.counts, progress.tally);
  if (file.facts.state.empty()) {
    progress.goal = progress.limits.spp = file.facts.spp;
  } else {
    const uint64_t block = read_state(file.facts.state, name, progress);
    progress.blocks = blocks_of(file.words, block, progress.film, name);
  }
  const std::vector<SampleRange>& ranges = progress.film.ranges();
  if (ranges.size() > 1 || (!ranges.empty() && ranges[0].first != progress.first))
    throw InputError(name, "film",
                     "holds " + words_of(ranges) + ", which is no beginning to go on from");
  return progress;
}

// ---- How --resume and --shard affect a rendering ----

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

// To the command that began the picture, in its provenance.
void add_option(const std::string& option, std::map<std::string, std::string>& attributes) {
  const auto provenance = attributes.find(provenance_attribute);
  if (provenance == attributes.end()) return;
  std::string& text = provenance->second;
  const size_t at = text.rfind("made by tdpt-render ");
  if (at != std::string::npos)
    text.insert(std::min(text.find('\n', at), text.size()), " " + option);
}

// More samples than the first run was to have, or more time. A target error was aimed at before the
// first sample, and a shard is of a fixed size.
void take_limits(const RenderArguments& a, Progress& progress,
                 std::map<std::string, std::string>& attributes) {
  Limits& limits = progress.limits;
  const Limits given{static_cast<uint64_t>(a.spp), a.seconds, a.target_error};
  if (given == Limits() || given == limits) return;
  if (limits.target_error > 0 || given.target_error > 0 || progress.whole > 0)
    throw UsageError(fmt::format("--spp, --time, --target-error: those that {} was begun with hold",
                                 display_name(a.resume)));
  if (given.spp > 0 && given.spp < progress.film.samples())
    throw UsageError(fmt::format("--spp {}: {} has {} per pixel already", given.spp,
                                 display_name(a.resume),
                                 counted(progress.film.samples(), "sample")));
  limits = given;
  progress.goal = given.spp;
  progress.added = 0;
  if (given.spp > 0) add_option(fmt::format("--spp {}", given.spp), attributes);
}

// Raises the picture's goal. If the last --add-samples asked for as many and was cut short, this is
// the same command run again: it adds nothing and returns false.
bool add_samples(uint64_t n, Progress& progress) {
  if (progress.added == n && progress.film.samples() < progress.goal) return false;
  if (std::max(progress.goal, progress.film.samples()) + n > kMostSamples)
    throw UsageError(fmt::format("--add-samples {}: a picture has {} samples per pixel at the most",
                                 n, kMostSamples));
  progress.goal = (progress.goal > 0 ? progress.goal : progress.film.samples()) + n;
  progress.added = n;
  return true;
}

// Refuses a film that cannot hold this world's samples, whatever its file claims.
void check_film(const Progress& progress, const Vista& vista, const std::string& file) {
  const Film& film = progress.film;
  if (film.width() != vista.view.film.width() || film.height() != vista.view.film.height() ||
      film.unit() != Film(1, 1, vista.world->lights.power()).unit() ||
      (!progress.tally.portals.empty() &&
       progress.tally.portals.size() != vista.openings.portals.portals()))
    throw InputError(file, "film", "keeps other sums than this picture");
}

void check_part(const RenderArguments& a, const Progress& progress, const std::string& file) {
  const bool is_part = progress.first > 0 || progress.whole > 0;
  if (a.shard.empty()) {
    if (is_part)
      throw UsageError(fmt::format(
          "--resume {}: is a shard, of {} of {}; give --shard as it was begun", file,
          words_of(std::vector<SampleRange>{{progress.first, progress.goal}}), progress.whole));
    return;
  }
  const SampleRange part = samples_of_shard(a.shard, progress.spp());
  if (part.first != progress.first || part.count != progress.goal)
    throw InputError(
        file, "",
        fmt::format("is to hold {}, not those of shard {}",
                    words_of(std::vector<SampleRange>{{progress.first, progress.goal}}), a.shard));
  if (a.add_samples > 0)
    throw UsageError("--add-samples: " + file + " is a shard, which is of a fixed size");
}

}  // namespace

void check_checkpoint(const RenderArguments& a) {
  if (!a.checkpoint.empty() && !is_same(a.checkpoint, a.resume) && is_there(a.checkpoint))
    throw UsageError("--checkpoint " + a.checkpoint +
                     ": is there already; go on from it with --resume, or remove it");
}

void take_part(const RenderArguments& a, Progress& progress) {
  if (a.shard.empty()) return;
  progress.whole = progress.goal;
  const SampleRange part = samples_of_shard(a.shard, progress.whole);
  if (part.count == 0)
    throw UsageError(fmt::format("--shard {}: there {} only {}", a.shard,
                                 progress.whole == 1 ? "is" : "are",
                                 counted(progress.whole, "sample")));
  progress.first = part.first;
  progress.goal = part.count;
}

std::optional<Begun> read_begun(const RenderArguments& a, const Fingerprint& is_of,
                                const Vista& vista) {
  // A file named for both is created if it does not exist yet.
  if (a.resume.empty() || (is_same(a.checkpoint, a.resume) && !is_there(a.resume))) return {};
  const std::string name = display_name(a.resume);
  FilmFile film = read_film(a.resume);
  if (const std::string other = difference(film.facts.shape, is_of); !other.empty())
    throw InputError(name, "", "is of " + other);
  if (film.facts.spp == 0) throw InputError(name, "film", "has no samples");
  FilmFacts facts = film.facts;
  // These say how a rendering ended, which is yet to come.
  for (const char* word : {"targetError", "estimatedError", "stoppedBy"})
    facts.attributes.erase(word);
  const auto begun = std::make_shared<Progress>(progress_of(std::move(film), name));
  Progress& progress = *begun;
  check_film(progress, vista, name);
  check_part(a, progress, name);
  take_limits(a, progress, facts.attributes);
  if (a.add_samples > 0 && add_samples(static_cast<uint64_t>(a.add_samples), progress))
    add_option(fmt::format("--add-samples {}", a.add_samples), facts.attributes);
  return Begun{begun, std::move(facts)};
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

}  // namespace tdpt
