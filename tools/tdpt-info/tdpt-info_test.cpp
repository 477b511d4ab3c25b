#include "tools/tdpt-info/knowledge.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/film/film_file.h"
#include "libcommon/formats/light_tables.h"
#include "libcommon/formats/portal.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::tdpt_info_test {

class files : public ::testing::Test {
 protected:
  std::string told(const std::string& name, const std::string& bytes) {
    try {
      return text_of(knowledge_of(folder_.write(name, bytes)));
    } catch (const InputError& e) {
      return e.what();
    }
  }
  static bool says(const std::string& text, const std::string& words) {
    return text.find(words) != std::string::npos;
  }
  testing::TempFolder folder_;
};

std::string film() {
  Film film(2, 1, 1);
  film.complete({4, 4});
  FilmFacts facts;
  facts.spp = 16;
  facts.shape = {{"scene", "77ab"}};
  facts.attributes[provenance_attribute] = "made by tdpt-render 1: tdpt-render";
  return film_bytes(film, facts);
}

TEST_F(files, are_known_by_their_content) {
  EXPECT_TRUE(says(told("a.png", film()), "a.png: film\n"));
  ExrFile exr;
  exr.picture = {1, 1, {Rgb(1)}};
  EXPECT_TRUE(says(told("a", exr_bytes(exr)), "a: picture\n"));
  EXPECT_TRUE(says(told("a.cut", "p max 2 1\nn 1 s\nn 2 t\na 1 2 5\n"), "a.cut: flow network\n"));
}

TEST_F(files, of_a_light_grid_are_tables_too) {
  LightGrid grid;
  grid.scene_hash = "77ab";
  grid.lines = {{{0, 0, 0}, {0, 0, 1}}};
  grid.dim = {1, 1, 1};
  grid.count = {3}, grid.air = {1}, grid.direction = {{}};
  for (const std::string& name : light_table_names()) {
    const std::string text = told("a", light_table_text(grid, name));
    EXPECT_TRUE(says(text, "a: table of a light grid\n")) << text;
    EXPECT_TRUE(says(text, "  of scene: 77ab\n")) << text;
  }
  EXPECT_TRUE(says(told("a", "i,j,k\n"), "a: no '# tdpt light grid 1' line"));
}

TEST_F(files, say_what_they_hold_and_how_they_were_made) {
  const std::string text = told("a.exr", film());
  EXPECT_TRUE(says(text, "  of scene: 77ab\n"));
  EXPECT_TRUE(says(text, "  samples: samples 4 to 7\n"));
  EXPECT_TRUE(says(text, "  missing: samples 0 to 3 and 8 to 15\n"));
  EXPECT_TRUE(says(text, "  made by tdpt-render 1: tdpt-render\n"));
}

TEST_F(files, of_films_tell_every_layer) {
  Film::Options options;
  options.layers = {"bi", ""};
  options.halves = true;
  Film film(1, 1, 1, options);
  film.complete({0, 1});
  FilmFacts facts;
  facts.spp = 1;
  facts.derived = {"variance", "halves"};
  const std::string text =
      told("a.exr", film_bytes(film, facts, {}, {{"depth.Z", std::vector<float>{2}}}));
  EXPECT_TRUE(says(text, "  layers: [\"bi\",\"depth\"]\n")) << text;
  EXPECT_TRUE(says(text, "  derived: [\"variance\",\"halves\"]\n")) << text;
}

// However many there are, each has a line of its own that ends; JSON has all figures.
TEST_F(files, of_portals_have_a_line_for_each) {
  PortalFile file;
  for (int i = 0; i < 20; ++i) {
    Portal p;
    p.vertices = {{2, 0, 0}, {2, 2, 0}, {2, 2, 0.5}, {2, 0, 0.5}};
    p.triangles = {{0, 1, 2}, {0, 2, 3}};
    p.figures = {{"flux_share", 0.25}, {"sky", i == 7 ? 0.5 : 0.0}, {"tightness", 0.9}};
    if (i == 3) p.cameras = {{"hall", 0.25}};
    file.portals.push_back(p);
  }
  const std::string bytes = portal_bytes(file), text = told("a.glb", bytes);
  for (int i = 0; i < 20; ++i) {
    const std::string line = fmt::format(
        "  portal.{}: area_m2 1, middle_m 2 1 0.25, light_to 1 0 0, triangles 2, figures ", i);
    EXPECT_TRUE(says(text, line)) << text;
  }
  EXPECT_TRUE(says(text, "sky 0.5, tightness 0.9\n")) << text;
  EXPECT_TRUE(says(text, "sky 0, tightness 0.9, cameras hall 0.25\n")) << text;
  EXPECT_FALSE(says(text, "...")) << text;
  const std::string json = json_of(knowledge_of(folder_.write("a.glb", bytes)));
  EXPECT_EQ(nlohmann::json::parse(json)["facts"]["portals"][19]["figures"]["tightness"], 0.9);
  EXPECT_TRUE(says(told("b.glb", portal_bytes({})), "  portals: none\n"));
}

TEST_F(files, that_are_damaged_or_none_of_ours_are_refused) {
  std::string bad = film();
  bad.replace(bad.find("77ab"), 4, "77ac");
  EXPECT_TRUE(says(told("a.exr", bad), "a.exr:film: is damaged"));
  EXPECT_TRUE(says(told("a.exr", film().substr(0, 700)), "is damaged"));
  EXPECT_TRUE(says(told("a", "hello"), "a: is none of the files of these programs"));
  EXPECT_TRUE(says(told("a", ""), "a: is none of the files of these programs"));
  EXPECT_TRUE(says(told("a.glb", "{}"), "a.glb:"));
  const std::string asset = R"({"asset": {"version": "2.0", "extras": {"tdpt_portal_format": 2}},)";
  EXPECT_TRUE(says(told("a", asset + R"("nodes": []})"), "this file has version 2"));
  // Neither a scene nor portals.
  const std::string flat = R"({"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3"}]})";
  EXPECT_TRUE(says(told("a", flat), "a: has no triangle")) << told("a", flat);
}

TEST_F(files, cannot_command_a_terminal) {
  ExrFile exr;
  exr.picture = {1, 1, {Rgb(1)}};
  exr.attributes["owner"] = "\033[2J";
  const std::string text = told("a", exr_bytes(exr));
  EXPECT_TRUE(says(text, "  owner: ")) << text;
  EXPECT_FALSE(says(text, "\033"));
}

}  // namespace tdpt::tdpt_info_test
