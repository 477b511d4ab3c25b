#include "tools/tdpt-render/run/delivery.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <new>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/cli/ending.h"
#include "libcommon/options/picture_options.h"
#include "libcommon/formats/tone.h"
#include "libcommon/formats/viewpoint.h"
#include "tools/tdpt-render/run/features.h"
#include "tools/tdpt-render/run/report.h"
#include "tools/tdpt-render/run/target_report.h"

namespace tdpt {
namespace {

// Attributes of the picture. A resumed rendering keeps those of its first run. `target`: its
// outcome, once known. `mark`: of a complete frame.
std::map<std::string, std::string> attributes_of(const Job& job, const Choice& choice,
                                                 const Plan& plan, const std::string& mark,
                                                 const std::optional<TargetOutcome>& target) {
  std::map<std::string, std::string> attributes = job.given.attributes;
  if (attributes.empty()) {
    cli::Common common = job.common;
    if (!job.given.command.empty()) common.command = job.given.command;
    attributes = exr_attributes(choice.integrator, choice.candidates.size() > 1 ? plan.label : "",
                                job.settings, common.provenance(job.in.files));
    attributes["camera"] = viewpoint_text(job.in.scene.frame, job.in.camera);
    if (job.a.lens.f_stop)
      attributes["lens"] =
          fmt::format("f/{} at {}", *job.a.lens.f_stop,
                      std::isinf(job.in.focus) ? "infinity" : fmt::format("{} m", job.in.focus));
    if (job.a.lens.shutter > 0) attributes["shutter"] = shutter_words(job.a.lens, job.a.shot);
  }
  if (job.common.no_provenance) attributes.erase(provenance_attribute);
  if (!mark.empty()) attributes[kFrameAttribute] = mark;
  if (target) attributes.merge(target_attributes(*target));
  return attributes;
}

// The --aov channels that are computed from the film's sums.
std::vector<std::string> derived_of(const Arguments& a) {
  std::vector<std::string> derived;
  for (const std::string& name : aovs_of(a))
    if (std::find(kDerived.begin(), kDerived.end(), name) != kDerived.end())
      derived.push_back(name);
  if (a.filters()) derived.push_back(kDenoised[static_cast<size_t>(denoise::kind_of(a.denoiser))]);
  return derived;
}

std::string film_of(const Outcome& r) {
  return film_bytes(r.render_state, r.plan, r.job.film_shape,
                    merged_words(r.job.given.processor, r.job.code), derived_of(r.job.a),
                    attributes_of(r.job, r.choice, r.plan, r.mark, r.target), r.channels);
}

Unfiltered unfiltered(const Outcome& r, const RenderResult& result) {
  if (r.job.is_shard()) return {{result.picture, {}, {}, {}, {}}, {}};
  FilmFacts facts;
  facts.derived = derived_of(r.job.a);
  facts.attributes = attributes_of(r.job, r.choice, r.plan, r.mark, r.target);
  const Film& film = r.render_state.film;
  return {finished_picture(film, facts, r.channels), facts, film.has_both_halves()};
}

// Filters it if it is to be filtered, and tells what the filter did.
void filter(Unfiltered& picture, std::span<const denoise::NamedPicture> frames, Delivered& told) {
  const auto start = std::chrono::steady_clock::now();
  const auto filtered = filter_as_asked(picture.file, picture.both_halves, picture.facts, frames);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  told.filtered = filtered ? fmt::format("{}; {:.1f} s", sentence_of(*filtered), took.count())
                           : "not filtered: there is one sample per pixel";
  if (filtered) told.left = filtered->left;
}

// The bytes of the result; of a shard those of a film.
std::string bytes_of(const Outcome& r, const ExrFile& picture) {
  return r.job.is_shard() ? film_of(r) : exr_bytes(picture, r.job.a.storage());
}

std::string stats_of(const Outcome& r, const RenderResult& result) {
  return stats_json(r.choice.integrator, r.job.settings, result, r.job.in.portals, r.mark);
}

void write_all(const Outcome& r, const RenderResult& result, const ExrFile& done,
               const Delivered& told) {
  const Job& job = r.job;
  const Arguments& a = job.a;
  const Picture& picture = done.picture;
  cli::deliver({{job.common.output, [&] { return bytes_of(r, done); }},
                {a.preview, [&] { return preview_bytes(picture, *told.exposure); }},
                {a.nonzero, [&] { return png_bytes(nonzero_picture(result.picture)); }},
                {job.writes_plan() && !result.cut_short ? a.plan : "",
                 [&] {
                   return plan_file_text({result.plan, job.shape, job.common.command});
                 }},
                {a.stats, [&] { return finished_json(stats_of(r, result), told) + '\n'; }}},
               job.common);
}

// Where a picture is kept after a failed write.
std::string kept_sentence(const std::string& output, const std::string& bytes) {
  const std::string path = keep_elsewhere(output == "-" ? "picture.exr" : output, bytes);
  return path.empty() ? "the picture is lost" : "the picture is kept in " + path;
}

}  // namespace

std::string finished_json(const std::string& told, const Delivered& delivered) {
  auto j = nlohmann::ordered_json::parse(told);
  if (delivered.exposure) j["exposure"] = *delivered.exposure;
  if (const auto& left = delivered.left)
    j["filtered"] = {{"relmse", left->relmse}, {"interval", {left->low, left->high}}};
  return j.dump();
}

Channels channels_of(const Job& job, const World& world) {
  if (job.is_shard() && shard_of(job.a.shard).index > 0) return {};
  std::vector<std::string> names = aovs_of(job.a);
  if (job.a.filters()) names.insert(names.end(), {"albedo", "normal", "depth"});
  return features(world, names, job.common.seed);
}

bool save(const Outcome& r) {
  const std::string path = r.job.checkpoint();
  std::string why;
  try {
    write_output(path, film_of(r));
    return true;
  } catch (const OutputError& e) {
    why = e.what();
  } catch (const std::bad_alloc&) {
    why = path + ": there is no memory for it";
  }
  std::error_code ignored;
  r.job.common.warn(why + (std::filesystem::exists(path, ignored)
                               ? "; the checkpoint before it is kept"
                               : "; there is no checkpoint yet"));
  return false;
}

void show(const Job& job, const Picture& picture) {
  try {
    const PictureArguments& a = job.a;
    const std::optional<double> exposure = exposure_of(picture, a.preview, a.exposure);
    write_output(a.preview, preview_bytes(picture, *exposure));
  } catch (const OutputError&) {
  }
}

Delivered deliver(const Outcome& r, const RenderResult& result) {
  const bool saved = !r.job.checkpoint().empty() && !result.cut_short && save(r);
  const PictureArguments& a = r.job.a;
  Unfiltered all = unfiltered(r, result);
  Delivered delivered;
  if (r.job.a.filters() && !r.job.is_shard()) filter(all, {}, delivered);
  const Picture& picture = all.file.picture;
  delivered.exposure = exposure_of(picture, a.preview, a.exposure);
  warn_of_range(all.file, a.storage(), r.job.common);
  try {
    write_all(r, result, all.file, delivered);
  } catch (const OutputError& e) {
    throw Error(
        e.code,
        fmt::format("{}; {}", e.what(),
                    saved ? fmt::format("all samples are in {}: --resume writes the picture",
                                        display_name(r.job.checkpoint()))
                          : kept_sentence(r.job.common.output, bytes_of(r, all.file))));
  }
  return delivered;
}

Unfiltered hand_over(const Outcome& r, const RenderResult& result) {
  const Job& job = r.job;
  if (!job.checkpoint().empty()) save(r);
  cli::deliver({{job.a.nonzero, [&] { return png_bytes(nonzero_picture(result.picture)); }}},
               job.common);
  Unfiltered all = unfiltered(r, result);
  all.stats = stats_of(r, result);
  return all;
}

Delivered deliver_frame(const Arguments& a, const cli::Common& common, Unfiltered picture,
                        std::span<const denoise::NamedPicture> frames) {
  Delivered delivered;
  filter(picture, frames, delivered);
  std::vector<std::string> names;
  for (const denoise::NamedPicture& frame : frames) names.push_back(frame.name);
  if (!names.empty())
    picture.file.attributes[kFramesAttribute] = fmt::format("{}", fmt::join(names, ", "));
  delivered.exposure = exposure_of(picture.file.picture, a.preview, a.exposure);
  warn_of_range(picture.file, a.storage(), common);
  const auto bytes = [&] { return exr_bytes(picture.file, a.storage()); };
  try {
    cli::deliver(
        {{common.output, bytes},
         {a.preview, [&] { return preview_bytes(picture.file.picture, *delivered.exposure); }},
         {a.stats, [&] { return finished_json(picture.stats, delivered) + '\n'; }}},
        common);
  } catch (const OutputError& e) {
    throw Error(e.code, fmt::format("{}; {}", e.what(), kept_sentence(common.output, bytes())));
  }
  return delivered;
}

}  // namespace tdpt
