// Parses arbitrary bytes as a film; a film that was read must round-trip.
#include "libcommon/film/film_file.h"
#include "libcommon/testing/files/fuzz.h"

using namespace tdpt;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using testing::require;
  testing::reads([&] {
    FilmFile file = parse_film(testing::text_of(data, size), "input");
    const FilmFile again =
        parse_film(film_bytes(file.film, file.facts, file.words, file.channels), "output");
    require(again.facts == file.facts, "facts come back");
    require(again.words == file.words, "the state comes back");
    require(again.channels.size() == file.channels.size(), "channels come back");
    require(again.film.sums() == file.film.sums(), "sums come back");
    require(again.film.ranges() == file.film.ranges(), "ranges come back");
  });
  return 0;
}
