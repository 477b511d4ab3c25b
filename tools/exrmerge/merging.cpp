#include "tools/exrmerge/merging.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/options/picture_options.h"

namespace tdpt {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const std::vector<SampleRange>& ranges) {
  Json list = Json::array();
  for (const SampleRange& r : ranges) list.push_back({r.first, r.end() - 1});
  return list;
}

}  // namespace

FilmFile merged(std::string first, const std::vector<std::string>& paths) {
  FilmFile all = parse_film(first, display_name(paths.front()));
  std::string().swap(first);
  all.facts.state.clear();
  all.words.clear();
  for (size_t i = 1; i < paths.size(); ++i) all.merge(read_film(paths[i]), display_name(paths[i]));
  return all;
}

void check_whole(const FilmFile& film, const std::string& file) {
  const std::vector<SampleRange> gaps = film.gaps();
  if (film.film.samples() == 0) throw InputError(file, "", "has no samples");
  if (gaps.empty()) return;
  throw InputError(file, "",
                   fmt::format("{} of {} are missing; --gaps makes a picture of the others",
                               words_of(gaps), film.facts.spp));
}

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

cli::Decisions decisions_of(const FilmFile& film) {
  const bool mixed = film.facts.processor.find(", ") != std::string::npos;
  return {{"samples", words_of(film.film.ranges()),
           film.gaps().empty() ? "none is missing" : words_of(film.gaps()) + " are not there", ""},
          {"code", film.facts.processor,
           mixed ? "the films were rendered by several kinds of processors"
                 : "all films were rendered by the same",
           ""}};
}

}  // namespace tdpt
