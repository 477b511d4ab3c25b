#include "libcommon/formats/light_tables.h"

#include <gtest/gtest.h>

#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/testing/files/refusal.h"
#include "libcommon/testing/files/small_light_grid.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::light_tables_test {

LightGrid small() {
  return testing::small_light_grid();
}

std::vector<TableText> tables_of(const LightGrid& g) {
  std::vector<TableText> tables;
  for (const std::string& name : light_table_names())
    tables.push_back({name + ".csv", light_table_text(g, name)});
  return tables;
}

TEST(light_tables, come_back_to_the_last_bit_in_any_order) {
  LightGrid g = small();
  g.cameras.push_back("0 0 0 0 0 -1 0 1 0 0.9 1.5 all yard");
  g.cuts.back().camera = 1;
  std::vector<TableText> tables = tables_of(g);
  for (int turn = 0; turn < 4; ++turn) {
    const LightGrid back = parse_light_tables(tables);
    testing::expect_same_but_lines(back, g);
    testing::expect_same_lines(back, g, 0);
    ASSERT_EQ(back.probes.size(), g.probes.size());
    for (size_t l = 0; l < g.probes.size(); ++l) {
      EXPECT_EQ(back.probes[l].line.light, g.probes[l].line.light);
      EXPECT_EQ(back.probes[l].line.camera, g.probes[l].line.camera);
      EXPECT_EQ(back.probes[l].joins, g.probes[l].joins);
    }
    std::rotate(tables.begin(), tables.begin() + 1, tables.end());
  }
  EXPECT_EQ(parse_light_tables({tables[0]}).provenance.lines, g.provenance.lines);
}

TEST(light_tables, of_a_scene_without_a_bottleneck_say_why) {
  LightGrid none;
  none.bottleneck = false;
  none.reason = "it is one room";
  const LightGrid back = parse_light_tables(tables_of(none));
  EXPECT_FALSE(back.bottleneck);
  EXPECT_EQ(back.reason, none.reason);
  EXPECT_TRUE(back.lines.empty());
}

// As written by people, numpy and spreadsheets.
constexpr const char* kByHand =
    "cut,light_x,light_y,light_z,camera_x,camera_y,camera_z\r\n"
    "# tdpt light grid 1\r\n# a remark\r\n"
    "0.000e+00, 0, 0.5, 0.5, 4, 0.5, 0.5\r\n\r\n0,0,.5,0.75,4,0.5,0.75";

TEST(light_tables, of_lines_alone_have_a_box_and_counts) {
  const LightGrid g = parse_light_tables({{"lines.csv", kByHand}});
  ASSERT_EQ(g.lines.size(), 2u);
  EXPECT_EQ(g.voxel, 4.0 / 128);
  EXPECT_EQ(g.dim, (std::array<int, 3>{129, 1, 9}));
  double sum = 0;
  for (const float n : g.count) sum += n;
  EXPECT_EQ(sum, 258);
  EXPECT_EQ(g.direction[g.index(5, 0, 0)], Vec3f(1, 0, 0));
  EXPECT_EQ(std::count(g.air.begin(), g.air.end(), 1), 129 * 9);
  EXPECT_TRUE(g.bottleneck);
  EXPECT_TRUE(g.cuts.empty());
}

TEST(light_tables, count_lines_in_the_air_that_is_given) {
  const TableText air{"air.csv", "i,j,k\n#tdpt light grid 1\n#grid 0 0 0 1 4 1 1\n1,0,0\n2,0,0\n"};
  const LightGrid g = parse_light_tables({air, {"lines.csv", kByHand}});
  EXPECT_EQ(g.count, (std::vector<float>{0, 2, 2, 0}));
}

// A change of a table, and what its refusal must name.
struct Changed {
  const char *table, *was, *is, *place, *word;
};
void expect_refused(const LightGrid& grid, const std::vector<Changed>& cases) {
  for (const auto& [table, was, is, place, word] : cases) {
    const std::string text = light_table_text(grid, table), changed = replaced(text, was, is);
    EXPECT_NE(text, changed) << was << " is not there";
    testing::expect_refused({{changed, place, word}}, [](const std::string& bad) {
      parse_light_tables({{"table", bad}});
    });
  }
}

// The header of a .vdb is the same [light_grid_header.h]: what is wrong with it is tested here
// alone.
TEST(light_tables, say_what_is_wrong_and_where_in_the_header) {
  LightGrid g = small();
  expect_refused(g, {{"lines", "light_x", "x", "line 1", "'cut,x,light_y,light_z,camera_x"},
                     {"air", "light grid 1", "light grid 2", "line 3", "version 2"},
                     {"air", "# tdpt", "# was", "", "no '# tdpt light grid 1' line"},
                     {"air", "fronts", "inside", "line 9", "as camera"},
                     {"air", "# grid", "# no grid", "", "no '# grid' line"},
                     {"air", " 0.3 5", " 0 5", "line 10", "voxels of no size"},
                     {"air", " 0.3 5", " 1e36 5", "line 10", "voxels of no size"},
                     {"air", " 5 4 3", " 5 4 2049", "line 10", "'2049'"},
                     {"air", " 5 4 3", " 2048 2048 2048", "line 10", "at most 134217728"},
                     {"air", " 5 4 3", " 5 4", "line 10", "nothing as voxels"},
                     {"air", "bottleneck yes", "bottleneck maybe", "line 11", "'maybe'"},
                     {"air", "cut 0", "cut 1", "line 12", "'1' as cut"},
                     {"air", "0.01 0.5", "0.01 1.5", "line 12", "1.5 as share"},
                     {"air", "0.01 0.5", "0.01 nan", "line 12", "'nan' as share"},
                     {"air", "0.01 0.5", "0.01 0.5 3", "line 12", "'3' as camera of the cut"},
                     {"lines", "# wall 0 1 0", "# wall 0 2 0", "line 14", "2 long"},
                     {"lines", "# pane 1 2 3 1 2 3.01", "# pane 1 2 3 1 2 3", "line 17",
                      "without thickness"}});
  g.cuts.assign(65, {});
  expect_refused(g, {{"lines", "abc", "abd", "line 76", "than 64"}});
  g = small();
  g.walls.assign(17, {1, 0, 0});
  expect_refused(g, {{"lines", "abc", "abd", "line 30", "one wall more than 16"}});
  g = small();
  g.panes.assign(65, {{1, 0, 0}, {1, 0, 1}});
  expect_refused(g, {{"lines", "abc", "abd", "line 80", "one pane more than 64"}});
}

// In a grid of 5 x 4 x 3 voxels of 0.3 m.
TEST(light_tables, say_what_is_wrong_and_where_in_the_rows) {
  LightGrid g = small();
  g.lines.clear(), g.probes.clear();
  g.air.assign(60, 0), g.count.assign(60, 0);
  g.provenance.lines.clear(), g.cameras.clear(), g.scene_hash.clear(), g.cuts.clear();
  g.walls.clear(), g.panes.clear();
  struct Row {
    const char *table, *rows, *place, *word;
  };
  for (const auto& [table, rows, place, word] : std::vector<Row>{
           {"lines", "0,0,1,0,0,1,0.5\n", "line 5", "7 cells"},
           {"lines", "0,0,1,0,0,1,0.5,0.1\n0,0,1,0,0,1,0.5,0.1,\n", "line 6", "9 cells"},
           {"lines", "0,0,1,0,0,1,0.5,-1\n", "line 5", "'-1' as share"},
           {"lines", "0,0,1,0,,1,0.5,0.1\n", "line 5", "nothing as camera_x"},
           {"lines", "0,0,1,0,nan,1,0.5,0.1\n", "line 5", "'nan' as camera_x"},
           {"lines", "0,0,1,0,0,1e999,0.5,0.1\n", "line 5", "'1e999' as camera_y"},
           {"lines", "0,0,1,0,0,1.7,0.5,0.1\n", "line 5", "from -0.2 to 1.6"},
           {"lines", "64,0,1,0,0,1,0.5,0.1\n", "line 5", "'64' as cut"},
           {"lines", "0.5,0,1,0,0,1,0.5,0.1\n", "line 5", "0.5 as cut, expected a whole number"},
           {"lines", "0,0,1,0,0,1,0,0.1\n", "line 5", "ends are one place"},
           {"probes", "0,0,1,0,0,1,0.5,2\n", "line 5", "'2' as joins"},
           {"air", "5,0,0\n", "line 5", "'5' as i"},
           {"count", "0,0,0,-1,0,0,0\n", "line 5", "'-1' as count"},
           {"count", "0,0,0,1,inf,0,0\n", "line 5", "'inf' as direction_x"},
           {"count", "0,0,0,1,0,0,0\n0,0,0,1,0,0,0\n", "line 6", "a voxel again"},
           {"air", "0,0,0\n# grid 0 0 0 1 1 1 1\n", "line 6", "a '#' line behind a row"}}) {
    const std::string head = replaced(light_table_text(g, table), "# rows 0\n", "");
    testing::expect_refused({{head + rows, place, word}}, [](const std::string& text) {
      parse_light_tables({{"table", text}});
    });
  }
}

std::string complaint(const std::vector<TableText>& tables) {
  return testing::refusal<InputError>([&] { parse_light_tables(tables); });
}

TEST(light_tables, of_different_grids_are_refused) {
  const std::string air = light_table_text(small(), "air");
  const std::string lines = light_table_text(small(), "lines");
  EXPECT_EQ(complaint({{"air", air}, {"lines", lines}}), "");
  for (const auto& [was, is, what] :
       {std::array{"scene abc", "scene abd", "line 8: another scene"},
        {"fronts", "all", "line 9: another camera"},
        {" 5 4 3", " 5 4 4", "line 10: another grid"},
        {"bottleneck yes", "bottleneck no light", "line 11: another bottleneck"},
        {"cut 0 0.01", "cut 0 0.02", "line 12: another cut"}}) {
    const std::string said = complaint({{"air", air}, {"lines", replaced(lines, was, is)}});
    EXPECT_EQ(said.find(std::string("lines:") + what), 0u) << said;
  }
  EXPECT_EQ(complaint({{"a", air}, {"b", air}}), "b: is a second table of air, beside a");
}

TEST(light_tables, ask_before_they_take_memory) {
  const uint64_t limit = memory_limit();
  limit_memory(1000000);
  LightGrid g = small();
  g.air.assign(60, 0);
  expect_refused(g, {{"air", " 5 4 3", " 128 128 128", "", "2097152 voxels, expected at most"},
                     {"air", " 5 4 3", " 100 100 100", "", "1000000 voxels take"}});
  std::string lines = kByHand;
  for (int i = 0; i < 20000; ++i) lines += "\n0,0,1,0,0,1,1";
  EXPECT_TRUE(complaint({{"lines", lines}}).starts_with("lines: 20006 lines take"));
  limit_memory(limit);
}

TEST(light_table_files, are_a_grid_or_tables_of_one) {
  const testing::TempFolder folder;
  const LightGrid g = small();
  std::vector<std::string> tables;
  for (const TableText& table : tables_of(g))
    tables.push_back(folder.write(table.name, table.text));
  std::vector<cli::Common::Input> read;
  testing::expect_same_lines(read_light(tables, read), g, 0);
  ASSERT_EQ(read.size(), 4u);
  EXPECT_EQ(read[2].path, tables[2]);
  EXPECT_NE(read[2].hash, read[1].hash);
  read.clear();
  const std::string vdb = folder.write("a.vdb", light_grid_bytes(g));
  EXPECT_EQ(read_light({vdb}, read).lines.size(), g.lines.size());
  const auto said = [&](const std::vector<std::string>& paths) {
    return testing::refusal<InputError>([&] { read_light(paths, read); });
  };
  EXPECT_NE(said({tables[2]}).find("without a table of lines"), std::string::npos);
  EXPECT_NE(said({tables[0], vdb}).find("is a binary file"), std::string::npos);
}

TEST(light_table_files, of_lines_for_another_grid_keep_to_its_limits) {
  const testing::TempFolder folder;
  const auto said = [&](const std::string& text, const LineLimits& limits) {
    const std::string path = folder.write("a.csv", text);
    return testing::refusal<InputError>([&] { read_light_lines(path, limits); });
  };
  LineLimits limits;
  EXPECT_EQ(said(kByHand, limits), "");
  limits.high = {3, 3, 3};
  EXPECT_NE(said(kByHand, limits).find(":line 4: '4' as camera_x"), std::string::npos);
  EXPECT_NE(said(light_table_text(small(), "air"), {}).find("is a table of air"),
            std::string::npos);
  EXPECT_NE(said(light_table_text(LightGrid(), "lines"), {}).find("no line"), std::string::npos);
}

}  // namespace tdpt::light_tables_test
