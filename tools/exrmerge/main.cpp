// exrmerge: merges films, each with some of a picture's samples, into the picture, and shows any
// picture as a PNG.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/cli.h"
#include "libcommon/denoise/filter_picture.h"
#include "libcommon/film/film_file.h"
#include "libcommon/formats/tone.h"
#include "libcommon/options/picture_options.h"

namespace tdpt {
namespace {

using Json = nlohmann::ordered_json;

constexpr cli::Program kProgram{"exrmerge",
                                "Makes one picture of films that hold parts of its samples, or a "
                                "PNG of any picture.",
                                "Picture to write (OpenEXR, or .png); default standard output",
                                cli::Result::binary,
                                cli::kLibraries,
                                cli::kCommit,
                                cli::kQuiet};

struct Arguments : PictureArguments {
  std::vector<std::string> films;
  bool film = false, gaps = false;
};

void declare_options(cli::Options& options, Arguments& a) {
  options.arguments(
      "films", a.films,
      "Shards or checkpoints of tdpt-render, or, for a PNG, one picture (OpenEXR); - is "
      "standard input");
  options.flag("--film", a.film, "Write a film, which can be merged and added to, gaps or not");
  options.flag("--gaps", a.gaps, "Write a picture of what there is where samples are missing");
  declare_picture_options(options, a);
}

void check_arguments(const Arguments& a, bool is_png) {
  if (!is_png) {
    check_picture_arguments(a);
  } else if (a.film) {
    throw UsageError("--film is for OpenEXR, -o is a PNG");
  }
}

Json json_of(const std::vector<SampleRange>& ranges) {
  Json list = Json::array();
  for (const SampleRange& r : ranges) list.push_back({r.first, r.end() - 1});
  return list;
}

// Reads films one by one and adds them; the data for resuming a rendering is dropped. `first`: the
// bytes of the first.
FilmFile merged(std::string first, const std::vector<std::string>& paths) {
  FilmFile all = parse_film(first, display_name(paths.front()));
  std::string().swap(first);
  all.facts.state.clear();
  all.words.clear();
  for (size_t i = 1; i < paths.size(); ++i) all.merge(read_film(paths[i]), display_name(paths[i]));
  return all;
}

// Throws InputError that lists missing samples; `file` names what was merged.
void check_whole(const FilmFile& film, const std::string& file) {
  const std::vector<SampleRange> gaps = film.gaps();
  if (film.film.samples() == 0) throw InputError(file, "", "has no samples");
  if (gaps.empty()) return;
  throw InputError(file, "",
                   fmt::format("{} of {} are missing; --gaps makes a picture of the others",
                               words_of(gaps), film.facts.spp));
}

// One JSON object, the keys of tdpt-json(5). `film`: merged of so many; none if a picture is shown.
// `exposure`: of the preview, if there is one.
std::string summary_json(const Picture& picture, const std::optional<FilmFile>& film, size_t films,
                         std::optional<double> exposure) {
  Json j;
  if (film)
    j = {{"films", films},
         {"spp", film->film.samples()},
         {"samples", json_of(film->film.ranges())},
         {"missing", json_of(film->gaps())}};
  const Picture shown = film ? film->film.picture() : picture;
  const Vec3d mean = mean_of(shown);
  j["width"] = shown.width;
  j["height"] = shown.height;
  j["mean"] = {mean.x, mean.y, mean.z};
  j["nonzero"] = nonzero_of(shown);
  if (film) j["processor"] = film->facts.processor;
  if (exposure) j["exposure"] = *exposure;
  return j.dump();
}

// The picture of films, as far as they go, and what is said of them.
ExrFile merged_picture(const Arguments& a, const cli::Common& common, FilmFile& film,
                       std::optional<denoise::Filtered>& filtered) {
  const std::string names =
      a.films.size() == 1
          ? a.films.front()
          : fmt::format("{} and {}", a.films.front(), counted(a.films.size() - 1, "other film"));
  if (!a.film && !a.gaps) check_whole(film, names);
  if (common.no_provenance) film.facts.attributes.erase(provenance_attribute);
  if (film.facts.processor.find(", ") != std::string::npos)
    common.warn(mixed_code_sentence(film.facts.processor));
  if (const auto gaps = film.gaps(); !a.film && !gaps.empty())
    common.warn(fmt::format("{} of {} are missing", words_of(gaps), film.facts.spp));
  if (a.film) return {film.film.picture(), {}, {}, {}, {}};
  return denoise::filtered_picture(film.film, film.facts, film.channels, filtered);
}

int run(const Arguments& a, const cli::Common& common) {
  const std::string suffix = suffix_of(common.output);
  const bool is_png = suffix == ".png";
  if (suffix == ".jpg" || suffix == ".jpeg")
    throw UsageError("-o " + common.output + ": is no .exr and no .png, which are written");
  check_arguments(a, is_png);
  std::string first = read_file(a.films.front());
  const std::string name = display_name(a.films.front());
  ExrFile file;
  if (is_png && a.films.size() == 1) file = parse_exr(first, name);
  std::optional<FilmFile> film;  // none: a picture is shown
  std::optional<denoise::Filtered> filtered;
  if (file.picture.pixels.empty() || is_film(file)) {
    film = merged(std::move(first), a.films);
    file = merged_picture(a, common, *film, filtered);
  } else if (file.picture.alpha.empty()) {
    warn_of_missing_data(file, name, common);
  }
  const Picture& picture = file.picture;
  const std::string& png = is_png ? common.output : a.preview;
  const std::optional<double> exposure = exposure_of(picture, png, a.exposure);
  const auto bytes = [&] {
    return a.film ? film_bytes(film->film, film->facts, {}, film->channels) : exr_bytes(file);
  };
  cli::deliver({{is_png ? "" : common.output, bytes},
                {png, [&] { return preview_bytes(picture, *exposure); }}},
               common);
  if (common.json) common.summary(summary_json(picture, film, a.films.size(), exposure));
  if (film)
    common.note(fmt::format("{} per pixel of {} at {} x {} from {}",
                            counted(film->film.samples(), "sample"), film->facts.spp, picture.width,
                            picture.height, counted(a.films.size(), "film")));
  else
    common.note(fmt::format("{} x {} at exposure {}", picture.width, picture.height, *exposure));
  if (filtered) common.note(sentence_of(*filtered));
  return 0;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
