// Film files: they round-trip, damage is refused, and only parts of the same picture can be merged.
#include "libcommon/film/film_file.h"

#include <functional>

#include <gtest/gtest.h>

#include "libcommon/base/file.h"
#include "libcommon/math/rng.h"
#include "libcommon/testing/files/refusal.h"

namespace tdpt::film_file_test {

constexpr int kWidth = 3, kHeight = 2;

Film::Options all_options() {
  Film::Options options;
  options.layers = {"camera", "", "light"};
  options.alpha = options.halves = true;
  return options;
}

// Samples `range` of a picture; each contributes a unique value to each pixel.
Film film_with(const SampleRange& range, const Film::Options& options = all_options()) {
  Film film(kWidth, kHeight, 3.0, options);
  for (uint64_t s = range.first; s < range.end(); ++s)
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        Rng rng(7, static_cast<uint64_t>(x + 8 * y), s);
        const Vec3d light(rng.uniform(), 1e9 * rng.uniform(), 1e-9 * rng.uniform());
        film.add(x, y, light, mix64(s), s);
        if (!options.layers.empty()) film.add_to_layer(2, x, y, light * 0.5, mix64(s));
        if (options.alpha && x == 1) film.meet(x, y);
      }
  film.complete(range);
  return film;
}

FilmFacts facts(uint64_t spp = 8) {
  FilmFacts f;
  f.shape = {{"scene", "77ab"}, {"size", "3 x 2"}};
  f.plan = R"({"integrator":"bdpt"})";
  f.state = "{}";
  f.processor = "avx2+fma";
  f.spp = spp;
  f.counts["rays"] = {3, ~Units{0} >> 1};
  f.attributes = {{"seed", "1"}, {provenance_attribute, "made by x 1: x\nfrom a 12"}};
  return f;
}

FilmFile part(const SampleRange& range, uint64_t spp = 8) {
  return {film_with(range), facts(spp), {}};
}

std::string bytes_of(const SampleRange& range) {
  Film film = film_with(range);
  return film_bytes(film, facts());
}

std::string complaint(const std::function<void()>& work) {
  return testing::refusal<InputError>(work);
}

void expect_same(const Film& a, const Film& b) {
  EXPECT_EQ(a.sums(), b.sums());
  EXPECT_EQ(a.ranges(), b.ranges());
  EXPECT_EQ(a.alpha(), b.alpha());
  for (const uint64_t half : {0, 1}) EXPECT_EQ(a.half(half).pixels, b.half(half).pixels);
  EXPECT_EQ(a.options(), b.options());
  for (size_t layer = 0; layer < Film::kMostLayers; ++layer)
    EXPECT_EQ(a.layer_sums(layer), b.layer_sums(layer));
}

TEST(film_file, comes_back_as_it_was_kept) {
  for (const Film::Options& options : {all_options(), Film::Options()}) {
    Film film = film_with({4, 4}, options);
    const FilmFile back = parse_film(film_bytes(film, facts()), "a.exr");
    expect_same(back.film, film);
    EXPECT_EQ(back.facts, facts());
    EXPECT_EQ(back.film.unit(), film.unit());
  }
}

// More than the picture has pixels, and fewer.
TEST(film_file, keeps_the_state_of_a_rendering) {
  for (const size_t count : {1, 5, 6, 13}) {
    Film film = film_with({0, 3});
    StateWords words;
    for (size_t i = 0; i < count; ++i) words.push_back(0xffffffffu - static_cast<uint32_t>(i));
    const FilmFile back = parse_film(film_bytes(film, facts(), words), "a.exr");
    expect_same(back.film, film);
    EXPECT_EQ(back.words, words);
  }
}

TEST(film_file, is_a_picture_of_its_samples_that_any_reader_shows) {
  const Film film = film_with({2, 3});
  const ExrFile exr = parse_exr(bytes_of({2, 3}), "a.exr");
  EXPECT_EQ(exr.picture.pixels, film.picture().pixels);
  EXPECT_EQ(exr.attributes.at("spp"), "3");
  EXPECT_EQ(provenance_of(exr).lines.size(), 2u);
  EXPECT_TRUE(is_film(exr));
  EXPECT_FALSE(is_film(finished_picture(film, facts())));
}

TEST(film_file, finishes_a_picture_with_what_derives_from_its_sums) {
  FilmFacts asked = facts();
  asked.derived = {"variance", "halves", "samples", "a word of others"};
  const Film film = film_with({1, 4});
  const ExrFile exr = finished_picture(film, asked);
  EXPECT_EQ(exr.channels.size(), 2u);
  EXPECT_EQ(exr.channels.at("samples.Y"), std::vector<float>(6, 4));
  EXPECT_EQ(exr.layers.at("halfA").pixels, film.half(0).pixels);
  EXPECT_EQ(exr.layers.at("halfB").pixels, film.half(1).pixels);
  EXPECT_EQ(exr.channels.at("variance.Y")[4], static_cast<float>(film.variance()[4]));
  EXPECT_GT(exr.channels.at("variance.Y")[4], 0);
  // A variance beyond the largest float.
  Film bright(1, 1, 1e30, {.halves = true});
  bright.add(0, 0, {1e30, 1e30, 1e30}, 0, 0);
  bright.complete({0, 2});
  EXPECT_EQ(finished_picture(bright, asked).channels.at("variance.Y"),
            std::vector<float>(1, std::numeric_limits<float>::max()));
}

TEST(film_file, without_samples_is_black_and_comes_back) {
  const FilmFile back = parse_film(bytes_of({0, 0}), "a.exr");
  EXPECT_EQ(back.film.samples(), 0u);
  EXPECT_EQ(back.film.picture().pixels, std::vector<Rgb>(6));
}

// For every changed byte: the file is refused, or its contents are unchanged (the library checks
// what it compresses; some header bytes are meaningless here).
TEST(film_file, a_byte_that_changed_is_never_added_up) {
  const std::string good = bytes_of({0, 4});
  const Film film = film_with({0, 4});
  size_t refused = 0;
  for (size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ (1 << (i % 8)));
    try {
      const FilmFile back = parse_film(bad, "a.exr");
      expect_same(back.film, film);
      EXPECT_EQ(back.facts, facts()) << "byte " << i;
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, good.size() * 3 / 4);
  for (size_t n = 0; n < good.size(); n += 7)
    EXPECT_NE(complaint([&] { parse_film(good.substr(0, n), "a.exr"); }), "") << n << ", cut short";
}

TEST(film_file, that_says_what_cannot_be_is_refused_with_its_place) {
  const auto message = [](const std::string& from, const std::string& to) {
    std::string bytes = bytes_of({0, 4});
    const size_t at = bytes.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    bytes.replace(at, from.size(), to);
    return complaint([&] { parse_film(bytes, "a.exr"); });
  };
  struct Change {
    const char *from, *to, *place, *word;
  };
  for (const auto& [from, to, place, word] : std::vector<Change>{
           {"[[0,4]]", "[[4,0]]", "film", "is damaged"},
           {"[[0,4]]", "[[  4]]", "film", "is damaged"},
           {"\\\"unit\\\":-62", "\\\"unit\\\":-2e", "film", "is damaged"},
           {"\\\"width\\\":3", "\\\"width\\\":4", "film", "is damaged"},
           {"\\\"spp\\\":8", "\\\"spq\\\":8", "film", "is damaged"},
           {"\\\"spp\\\":8", "\\\"spp\\\":9", "film", "is damaged"},
           {"\\\"alpha\\\":true", "\\\"alpha\\\":1234", "film", "is damaged"},
           {"77ab", "77ac", "film", "is damaged"},
           {"\\\"format\\\":4", "\\\"format\\\":1", "film.format", "version 1"},
           {"\\\"words\\\":0", "\\\"words\\\":1", "channel state.0", "is missing"},
           {"camera.sum.R.0", "camera.sum.Q.0", "channel camera.sum.R.0", "is missing"},
           {"met.1", "mot.1", "channel met.1", "is missing"}})
    EXPECT_TRUE(testing::names(message(from, to), place, word));
  const std::string picture = exr_bytes(finished_picture(film_with({0, 1}), facts()));
  testing::expect_refused({{picture, "", "without the sums of a film"}},
                          [](const std::string& bytes) { parse_film(bytes, "a.exr"); });
}

TEST(film_file, that_takes_more_than_the_limit_of_memory_is_refused) {
  Film film(40, 200, 1, all_options());
  const std::string bytes = film_bytes(film, facts());
  const uint64_t machine = memory_limit();
  limit_memory(1 << 20);
  EXPECT_TRUE(testing::names(complaint([&] { parse_film(bytes, "a.exr"); }), "film",
                             "212 bytes take 1.62 MiB"));
  limit_memory(machine);
  EXPECT_EQ(complaint([&] { parse_film(bytes, "a.exr"); }), "");
}

// ---- Merging ----

TEST(merging, gives_the_same_in_any_order_and_as_a_tree) {
  Film whole_film = film_with({0, 8});
  FilmFacts expected = facts();
  expected.state.clear();
  for (Units& n : expected.counts["rays"]) n *= 4;
  const std::string whole = film_bytes(whole_film, expected);
  std::vector<size_t> order{0, 1, 2, 3};
  do {
    FilmFile all = part({2 * order[0], 2});
    for (size_t i = 1; i < 4; ++i) all.merge(part({2 * order[i], 2}), "b.exr");
    EXPECT_EQ(film_bytes(all.film, all.facts), whole);
  } while (std::next_permutation(order.begin(), order.end()));
  FilmFile left = part({0, 2}), right = part({6, 2});
  left.merge(part({4, 2}), "b.exr");
  right.merge(part({2, 2}), "b.exr");
  right.merge(parse_film(film_bytes(left.film, left.facts), "c.exr"), "c.exr");
  EXPECT_EQ(film_bytes(right.film, right.facts), whole);
}

TEST(merging, knows_what_is_missing) {
  FilmFile all = part({2, 2});
  all.merge(part({6, 1}), "b.exr");
  EXPECT_EQ(all.gaps(), (std::vector<SampleRange>{{0, 2}, {4, 2}, {7, 1}}));
  EXPECT_EQ(words_of(all.gaps()), "samples 0 to 1, 4 to 5 and 7");
  EXPECT_EQ(part({0, 8}).gaps(), std::vector<SampleRange>());
  EXPECT_EQ(words_of({}), "no samples");
  EXPECT_EQ(words_of({{3, 1}}), "samples 3");
}

TEST(merging, takes_the_larger_picture_for_the_whole) {
  FilmFile all = part({0, 8}), other = part({8, 4}, 12);
  other.facts.processor = "sse2";
  all.merge(other, "b.exr");
  EXPECT_EQ(all.facts.spp, 12u);
  EXPECT_EQ(all.facts.processor, "avx2+fma, sse2");
  EXPECT_TRUE(all.gaps().empty());
}

TEST(merging, refuses_strangers_and_says_why) {
  const auto refusal = [](const std::function<void(FilmFile&)>& change) {
    FilmFile all = part({0, 4}), other = part({4, 4});
    change(other);
    const std::string why = complaint([&] { all.merge(other, "b.exr"); });
    EXPECT_EQ(all.film.samples(), why.empty() ? 8u : 4u);
    return why;
  };
  using testing::names;
  EXPECT_TRUE(names(refusal([](FilmFile& f) { f.facts.shape[0].second = "1f3a"; }), "",
                    "another scene (1f3a, expected 77ab)"));
  EXPECT_TRUE(names(refusal([](FilmFile& f) { f.facts.shape.pop_back(); }), "",
                    "another size (none, expected 3 x 2)"));
  EXPECT_TRUE(names(refusal([](FilmFile& f) { f.facts.shape.emplace_back("portal", "9"); }), "",
                    "another portal (9, expected none)"));
  EXPECT_TRUE(names(refusal([](FilmFile& f) {
                      f.film = film_with({4, 4}, {});
                    }),
                    "", "keeps other sums"));
  EXPECT_TRUE(names(refusal([](FilmFile& f) {
                      f.film = film_with({3, 2});
                    }),
                    "", "samples 3 to 4"));
  EXPECT_TRUE(names(refusal([](FilmFile& f) { f.facts.plan = "nee"; }), "", "another plan"));
  EXPECT_EQ(refusal([](FilmFile&) {}), "");  // twin: none of them
}

}  // namespace tdpt::film_file_test
