#include "tools/exrmerge/merging.h"

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::exrmerge_test {

class films : public ::testing::Test {
 protected:
  // A film of some of a picture's 8 samples, each of which adds 1 to its only pixel.
  std::string film(const SampleRange& range, const std::string& plan = "") {
    Film film(1, 1, 1);
    for (uint64_t s = 0; s < range.count; ++s) film.add(0, 0, {1, 1, 1}, 0, s);
    film.complete(range);
    FilmFacts facts;
    facts.spp = 8;
    facts.state = "{}";
    facts.plan = plan;
    facts.processor = "sse2";
    const std::string path = folder_.path / (std::to_string(range.first) + ".exr");
    write_output(path, film_bytes(film, facts));
    return path;
  }
  static FilmFile all_of(const std::vector<std::string>& paths) {
    return merged(read_file(paths.front()), paths);
  }
  testing::TempFolder folder_;
};

TEST_F(films, add_up) {
  const FilmFile all = all_of({film({4, 4}), film({0, 4})});
  EXPECT_NO_THROW(check_whole(all, "a"));
  EXPECT_EQ(all.film.picture().pixels[0].x, 1);
  EXPECT_EQ(summary_json({}, all, 2, {}),
            R"({"films":2,"spp":8,"samples":[[0,7]],"missing":[],"width":1,"height":1,)"
            R"("mean":[1.0,1.0,1.0],"nonzero":1.0,"processor":"sse2"})");
  EXPECT_EQ(all.facts.state, "");
}

TEST_F(films, of_another_plan_are_refused_with_what_settles_it) {
  const std::vector<std::string> paths{film({0, 4}, "{}"), film({4, 4}, R"({"label":"nee"})")};
  try {
    all_of(paths);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(static_cast<int>(e.code), 3);
    const std::string said = e.what();
    for (const char* word : {"another plan", "(--integrator NAME)", "--set isa=sse2"})
      EXPECT_NE(said.find(word), said.npos) << said;
  }
}

TEST_F(films, that_are_not_all_there_are_told) {
  const FilmFile all = all_of({film({4, 2})});
  try {
    check_whole(all, "a.exr");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(),
                 "a.exr: samples 0 to 3 and 6 to 7 of 8 are missing; --gaps makes a picture of "
                 "the others");
  }
  EXPECT_THROW(check_whole(all_of({film({0, 0})}), "a.exr"), InputError);
}

}  // namespace tdpt::exrmerge_test
