// exrmerge: merges films, each with some of a picture's samples, into the picture.
#include <fmt/format.h>

#include "libcommon/base/counted.h"
#include "libcommon/base/error.h"
#include "libcommon/base/shown.h"
#include "libcommon/cli/built_with.h"
#include "libcommon/cli/cli.h"
#include "libcommon/cli/ending.h"
#include "libcommon/formats/picture_options.h"
#include "libcommon/formats/tone.h"
#include "tools/exrmerge/merging.h"

namespace tdpt {
namespace {

constexpr cli::Program kProgram{"exrmerge",
                                "Makes one picture of films that hold parts of its samples.",
                                "Picture to write (OpenEXR); default standard output",
                                cli::Result::binary,
                                cli::kLibraries,
                                cli::kCommit,
                                cli::kQuiet};

struct Arguments : PictureArguments {
  std::vector<std::string> films;
  bool film = false, gaps = false;
};

void declare_options(cli::Options& options, Arguments& a) {
  options.arguments("films", a.films,
                    "Shards or checkpoints of tdpt-render (OpenEXR); - is standard input");
  options.flag("--film", a.film, "Write a film, which can be merged and added to, gaps or not");
  options.flag("--gaps", a.gaps, "Write a picture of what there is where samples are missing");
  declare_picture_options(options, a);
}

std::string picture_bytes(const Arguments& a, FilmFile& film, const ExrFile& picture) {
  return a.film ? film_bytes(film.film, film.facts, {}, film.channels)
                : exr_bytes(picture, a.storage());
}

int run(const Arguments& a, const cli::Common& common) {
  check_picture_arguments(a);
  if (a.film) check_stores_film(a, "--film");
  FilmFile film = merged(a.films);
  const std::string names = a.films.size() == 1
                                ? a.films.front()
                                : fmt::format("{} and {}", a.films.front(),
                                              cli::plural(a.films.size() - 1, "other film"));
  if (!a.film && !a.gaps) check_whole(film, names);
  if (common.no_provenance) film.facts.attributes.erase(provenance_attribute);
  if (film.facts.processor.find(", ") != std::string::npos)
    common.warn(mixed_code_sentence(film.facts.processor));
  if (const auto gaps = film.gaps(); !a.film && !gaps.empty())
    common.warn(fmt::format("{} of {} are missing", words_of(gaps), film.facts.spp));
  ExrFile file = a.film ? ExrFile{film.film.picture(), {}, {}, {}, {}}
                        : finished_picture(film.film, film.facts, film.channels);
  const auto filtered =
      a.film ? std::nullopt : filter_as_asked(file, film.film.has_both_halves(), film.facts);
  const Picture& picture = file.picture;
  const std::optional<double> exposure = exposure_of(picture, a.preview, a.exposure);
  warn_of_range(file, a.storage(), common);
  cli::deliver({{common.output, [&] { return picture_bytes(a, film, file); }},
                {a.preview, [&] { return preview_bytes(picture, *exposure); }}},
               common);
  if (common.json) common.summary(summary_json(film, a.films.size(), exposure));
  common.note(fmt::format("{} per pixel of {} at {} x {} from {}",
                          counted(film.film.samples(), "sample"), film.facts.spp, picture.width,
                          picture.height, cli::plural(a.films.size(), "film")));
  if (filtered) common.note(sentence_of(*filtered));
  common.explain_by([&] {
    return with_exposure(decisions_of(film, a.films.size(), a.film), a.exposure, exposure);
  });
  return 0;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
