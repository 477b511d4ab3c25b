#include "tools/exrdiff/explain.h"

#include <fmt/format.h>

#include "libcommon/base/number_words.h"
#include "libcommon/base/suffix.h"
#include "libcommon/base/threads.h"

namespace tdpt {

cli::Decisions decisions_of(const Comparison& c, const Picture& reference, int64_t without_data,
                            const std::string& output) {
  const size_t pixels = reference.pixels.size();
  return {
      {"pixels without data", without_data > 0 ? "counted as black" : "none",
       fmt::format("{} of {} lie outside the data window", without_data, 2 * pixels), ""},
      {"relative measures", fmt::format("offset by {}", number_words(relative_offset(reference))),
       "dark components must not divide by zero: a hundredth of the reference's mean magnitude",
       ""},
      {"99.9 % best", fmt::format("{} of {} pixels forgiven", pixels / 1000, pixels),
       "few fireflies can hold most of relMSE",
       fmt::format("{} of relMSE {}", number_words(c.picture.relmse - c.picture.relmse_trimmed),
                   number_words(c.picture.relmse))},
      {"verdict", c.picture.relmse < c.black.relmse ? "better than black" : "no better than black",
       fmt::format("relMSE is {}, that of a black picture {}", number_words(c.picture.relmse),
                   number_words(c.black.relmse)),
       ""},
      {"difference picture",
       output.empty()                ? "left out"
       : suffix_of(output) == ".png" ? "made in false colour"
                                     : "made with sign",
       output.empty() ? "-o is not given" : "the name in -o says so",
       cli::price_of(cpu_seconds()) + " in all"}};
}

}  // namespace tdpt
