// The distance is the optimal string alignment variant of Damerau-Levenshtein (no letter is edited
// twice): D(i, j) is the distance between the first i letters of one word and the first j of the
// other.
#include "libcommon/cli/nearest.h"

#include <algorithm>
#include <cctype>

namespace tdpt::cli {
namespace {

std::string in_small_letters(std::string_view word) {
  std::string small(word);
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return small;
}

size_t distance(const std::string& a, const std::string& b) {
  std::vector<size_t> before_last, last, row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    before_last = std::move(last);
    last = row;
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t another = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, another});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::string only_one_that_begins_with(const std::string& start,
                                      const std::vector<std::string>& words) {
  std::string found;
  if (start.size() < 3) return found;
  for (const std::string& word : words) {
    if (!in_small_letters(word).starts_with(start)) continue;
    if (!found.empty()) return {};
    found = word;
  }
  return found;
}

// Options of other renderers and tools, and ours for the same; the first that a program has.
struct Synonym {
  const char* ours;
  const char* others;
};
constexpr Synonym kSynonyms[]{
    {"spp", " samples sample-count samples-per-pixel pixel-samples num-samples nsamples passes "},
    {"environment", " sky background envmap env env-map environment-map hdri hdr ibl world dome "},
    {"width", " resolution res size film-size image-size dimensions crop "},
    {"output", " out outfile output-file output-path render-output imgfile image "},
    {"threads", " jobs cpus cores num-threads nthreads thread-count parallel "},
    {"device", " gpu cuda optix vulkan backend "},
    {"time", " time-limit timeout max-time seconds "},
    {"target-error", " noise noise-threshold threshold error quality-target "},
    {"max-depth", " bounces max-bounces depth path-length max-path-length "},
    {"frames", " frame-range start end frame-start frame-end "},
    {"look-from", " eye origin camera-position position "},
    {"look-at", " target lookat "},
    {"denoise", " oidn denoising filter "},
    {"quiet", " silent "},
    {"explain", " verbose debug log log-level verbosity "},
    {"preview", " png jpg jpeg display show "},
    {"for", " renderer export "},
    {"force", " overwrite yes "},
};

std::string synonym(const std::string& given, const std::vector<std::string>& words) {
  for (const Synonym& s : kSynonyms)
    if (std::string_view(s.others).find(' ' + given + ' ') != std::string_view::npos &&
        std::find(words.begin(), words.end(), s.ours) != words.end())
      return s.ours;
  return {};
}

}  // namespace

std::string option_meant(std::string_view given, const std::vector<std::string>& options) {
  const std::string meant = synonym(in_small_letters(given), options);
  return meant.empty() ? nearest(given, options) : meant;
}

std::string nearest(std::string_view given, const std::vector<std::string>& words) {
  const std::string small = in_small_letters(given.substr(0, 64));
  size_t least = std::max<size_t>(1, small.size() / 3) + 1;
  std::string found;
  for (const std::string& word : words)
    if (const size_t d = distance(small, in_small_letters(word)); d < least && d < small.size()) {
      least = d;
      found = word;
    }
  return found.empty() ? only_one_that_begins_with(small, words) : found;
}

}  // namespace tdpt::cli
