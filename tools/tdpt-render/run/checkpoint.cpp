#include "tools/tdpt-render/run/checkpoint.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "tools/tdpt-render/run/options.h"

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

// To the command that began the picture, in its provenance.
void add_option(const std::string& option, std::map<std::string, std::string>& attributes) {
  const auto provenance = attributes.find(provenance_attribute);
  if (provenance == attributes.end()) return;
  std::string& text = provenance->second;
  const size_t at = text.rfind("made by tdpt-render ");
  if (at != std::string::npos)
    text.insert(std::min(text.find('\n', at), text.size()), " " + option);
}

// Throws UsageError for limits given now that the first run did not have.
void check_limits(const RenderArguments& a, const Limits& then) {
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
void take_limits(const RenderArguments& a, Progress& progress,
                 std::map<std::string, std::string>& attributes) {
  Limits& limits = progress.limits;
  const auto spp = static_cast<uint64_t>(a.spp);
  if (limits.target_error > 0 || a.target_error > 0 || progress.whole > 0)
    return check_limits(a, limits);
  if (spp == 0 && a.seconds == 0) return;
  if (spp == limits.spp && a.seconds == limits.seconds) return;
  if (spp > 0 && spp < progress.film.samples())
    throw UsageError(fmt::format("--spp {}: {} has {} per pixel already", spp,
                                 display_name(a.resume),
                                 counted(progress.film.samples(), "sample")));
  limits = {.spp = spp, .seconds = a.seconds};
  progress.goal = spp;
  progress.added = 0;
  if (spp > 0) add_option(fmt::format("--spp {}", spp), attributes);
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
      throw UsageError(
          fmt::format("--resume {}: is a shard, of {} of {}; give --shard as it was begun", file,
                      words_of({{progress.first, progress.goal}}), progress.whole));
    return;
  }
  const SampleRange part = samples_of_shard(a.shard, progress.spp());
  if (part.first != progress.first || part.count != progress.goal)
    throw InputError(file, "",
                     fmt::format("is to hold {}, not those of shard {}",
                                 words_of({{progress.first, progress.goal}}), a.shard));
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
  Begun begun{plan_of(film.facts, name), nullptr, film.facts.attributes, film.facts.processor};
  // These say how a rendering ended, which is yet to come.
  for (const char* word : {"targetError", "estimatedError", "stoppedBy"})
    begun.attributes.erase(word);
  begun.progress = std::make_shared<Progress>(progress_of(std::move(film), name));
  Progress& progress = *begun.progress;
  check_film(progress, vista, name);
  check_part(a, progress, name);
  take_limits(a, progress, begun.attributes);
  if (a.add_samples > 0 && add_samples(static_cast<uint64_t>(a.add_samples), progress))
    add_option(fmt::format("--add-samples {}", a.add_samples), begun.attributes);
  return begun;
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
