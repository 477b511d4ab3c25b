#include "libcommon/formats/light_tables.h"

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/math/rng.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::light_tables_test {

LightGrid small() {
  LightGrid g;
  g.origin = {-1, 0.1, 1e-7};
  g.voxel = 0.3;
  g.dim = {5, 4, 3};
  g.count.assign(60, 0);
  g.air.assign(60, 1);
  g.direction.assign(60, {});
  g.air[g.index(1, 1, 1)] = 0;
  for (uint64_t n = 0; n < 40; ++n) {
    Rng rng(1, 2, n);
    g.count[n] = static_cast<float>(1 + rng.below(1 << 24));
    for (int c = 0; c < 3; ++c) g.direction[n][c] = 2 * rng.uniform_float() - 1;
    LightLine line{g.origin, g.origin, rng.below(2)};
    for (int c = 0; c < 3; ++c) line.light[c] += rng.uniform();
    for (int c = 0; c < 3; ++c) line.camera[c] += rng.uniform() * 0.9;
    g.lines.push_back(line);
    g.probes.push_back({line, n % 3 == 0});
  }
  g.scene_hash = "abc";
  g.cameras = {"1.5 -2 0 0 0 -1 0 1 0 0.9 1.5 fronts the eye"};
  g.cuts = {{0.01, 0.5}, {1.0 / 3, 1}};
  g.walls = {{0, 1, 0}, {0.6, 0, -0.8}};
  g.panes = {{{0, 1.0 / 3, 0}, {0, 0.3, 0}}, {{1, 2, 3}, {1, 2, 3.01}}};
  g.provenance.lines = {"made by lightgrid 1: lightgrid", "from a b", "made by x 1: x", "from a b"};
  return g;
}

std::vector<TableText> tables_of(const LightGrid& g) {
  std::vector<TableText> tables;
  for (const std::string& name : light_table_names())
    tables.push_back({name + ".csv", light_table_text(g, name)});
  return tables;
}

void expect_same_lines(const LightGrid& a, const LightGrid& b) {
  const auto same = [](const LightLine& x, const LightLine& y) {
    return x.light == y.light && x.camera == y.camera && x.cut == y.cut;
  };
  ASSERT_EQ(a.lines.size(), b.lines.size());
  for (size_t l = 0; l < a.lines.size(); ++l) EXPECT_TRUE(same(a.lines[l], b.lines[l])) << l;
  ASSERT_EQ(a.probes.size(), b.probes.size());
  for (size_t l = 0; l < a.probes.size(); ++l) {
    EXPECT_TRUE(same(a.probes[l].line, b.probes[l].line)) << l;
    EXPECT_EQ(a.probes[l].joins, b.probes[l].joins);
  }
}

TEST(light_tables, come_back_to_the_last_bit_in_any_order) {
  const LightGrid g = small();
  std::vector<TableText> tables = tables_of(g);
  for (int turn = 0; turn < 4; ++turn) {
    const LightGrid back = parse_light_tables(tables);
    expect_same_lines(back, g);
    EXPECT_EQ(back.origin, g.origin);
    EXPECT_EQ(back.voxel, g.voxel);
    EXPECT_EQ(back.dim, g.dim);
    EXPECT_EQ(back.count, g.count);
    EXPECT_EQ(back.direction, g.direction);
    EXPECT_EQ(back.air, g.air);
    EXPECT_EQ(back.scene_hash, g.scene_hash);
    EXPECT_EQ(back.cameras, g.cameras);
    EXPECT_EQ(back.cuts, g.cuts);
    EXPECT_EQ(back.walls, g.walls);
    EXPECT_EQ(back.panes, g.panes);
    EXPECT_EQ(back.bottleneck, g.bottleneck);
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

TEST(light_tables, tell_the_camera_of_each_cut) {
  LightGrid g = small();
  g.cameras.push_back("0 0 0 0 0 -1 0 1 0 0.9 1.5 all yard");
  g.cuts.back().camera = 1;
  const std::string text = light_table_text(g, "lines");
  const LightGrid back = parse_light_tables({{"lines", text}});
  EXPECT_EQ(back.cameras, g.cameras);
  EXPECT_EQ(back.cuts, g.cuts);
  LightGrid one = g;
  one.cuts.back().camera = 2;
  try {
    parse_light_tables({{"lines", light_table_text(one, "lines")}});
    ADD_FAILURE() << "accepted";
  } catch (const InputError& e) {
    EXPECT_NE(
        std::string(e.what()).find("'3' as camera of the cut, expected a whole number from 1 to 2"),
        std::string::npos)
        << e.what();
  }
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

std::string complaint(const std::vector<TableText>& tables) {
  try {
    parse_light_tables(tables);
  } catch (const InputError& e) {
    return e.what();
  }
  return "(accepted)";
}

// The error for table `name` of small() with `was` replaced by `is`.
std::string complaint(const std::string& name, const std::string& was, const std::string& is) {
  const std::string text = light_table_text(small(), name), changed = replaced(text, was, is);
  EXPECT_NE(text, changed) << was << " is not there";
  return complaint({{name, changed}});
}

// The error for rows of table `name`, in a grid of 5 x 4 x 3 voxels of 0.3 m, with `was` replaced
// by `is`.
std::string of_rows(const std::string& name, const std::string& rows, const std::string& was = "#",
                    const std::string& is = "#") {
  LightGrid g = small();
  g.lines.clear(), g.probes.clear();
  g.air.assign(60, 0), g.count.assign(60, 0);
  g.provenance.lines.clear(), g.cameras.clear(), g.scene_hash.clear(), g.cuts.clear();
  g.walls.clear(), g.panes.clear();
  const std::string head = replaced(light_table_text(g, name), "# rows 0\n", "");
  return complaint({{name, replaced(head, was, is) + rows}});
}

// Wherever a table of ours ends early, even in the middle of a number.
TEST(light_tables, are_refused_when_cut_short) {
  for (const auto& [name, text] : tables_of(small())) {
    EXPECT_EQ(complaint({{name, text}}), "(accepted)");
    for (size_t n = 0; n < text.size(); n += std::min<size_t>(7, text.find('\n', n) - n + 1))
      ASSERT_NE(complaint({{name, text.substr(0, n)}}), "(accepted)") << text.substr(0, n);
  }
  const std::string text = light_table_text(small(), "lines");
  EXPECT_EQ(complaint({{"lines.csv", text.substr(0, text.rfind('\n', text.size() - 2) + 1)}}),
            "lines.csv: 39 rows, expected the 40 of its '# rows' line");
}

TEST(light_tables, say_what_is_wrong_and_where_in_the_header) {
  EXPECT_EQ(complaint("lines", "# wall 0 1 0", "# wall 0 2 0"),
            "lines:line 14: a wall that is 2 long, expected a unit vector");
  EXPECT_EQ(complaint("lines", "# pane 1 2 3 1 2 3.01", "# pane 1 2 3 1 2 3"),
            "lines:line 17: a pane without thickness, expected two places apart from each other");
  EXPECT_EQ(
      complaint("lines", "light_x", "x"),
      "lines:line 1: 'cut,x,light_y,light_z,camera_x,camera_y,...' as columns, expected those "
      "of lines, probes, air, count");
  EXPECT_EQ(complaint("air", "light grid 1", "light grid 2"),
            "air:line 3: this file has version 2 of the format; this program reads version 1");
  EXPECT_EQ(complaint("air", "# tdpt", "# was"),
            "air: no '# tdpt light grid 1' line before the first row");
  EXPECT_EQ(complaint("air", "# grid", "# no grid"),
            "air: no '# grid' line in any table, expected the box of the voxels");
  EXPECT_EQ(complaint("air", " 0.3 5", " 0 5"),
            "air:line 10: voxels of no size that single precision holds, expected a side above 0");
  EXPECT_EQ(complaint("air", " 0.3 5", " 1e36 5"),
            "air:line 10: voxels of no size that single precision holds, expected a side above 0");
  EXPECT_EQ(complaint("air", " 5 4 3", " 5 4 2049"),
            "air:line 10: '2049' as voxels along a side, expected a whole number from 0 to 2048");
  EXPECT_EQ(complaint("air", " 5 4 3", " 2048 2048 2048"),
            "air:line 10: 8589934592 voxels, expected at most 134217728");
  EXPECT_EQ(complaint("air", " 5 4 3", " 5 4"),
            "air:line 10: nothing as voxels along a side, expected a whole number from 0 to 2048");
  EXPECT_EQ(complaint("air", "bottleneck yes", "bottleneck maybe"),
            "air:line 11: 'maybe' as bottleneck, expected yes or no");
  EXPECT_EQ(complaint("air", "cut 0", "cut 1"),
            "air:line 12: '1' as cut, expected a whole number from 0 to 0");
  EXPECT_EQ(complaint("air", "0.01 0.5", "0.01 1.5"), "air:line 12: 1.5 as share, expected 0 to 1");
  EXPECT_TRUE(complaint("air", "fronts", "inside").starts_with("air:line 9: "));
  EXPECT_EQ(complaint({{"air", std::string("i,j,k\n\0", 7)}}),
            "air: is a binary file, expected a table of a light grid");
}

TEST(light_tables, say_what_is_wrong_and_where_in_the_rows) {
  EXPECT_EQ(of_rows("lines", "0,0,1,0,0,1,0.5\n"), "lines:line 5: a row of 7 cells, expected 8");
  EXPECT_EQ(of_rows("lines", "0,0,1,0,0,1,0.5,0.1\n0,0,1,0,0,1,0.5,0.1,\n"),
            "lines:line 6: a row of 9 cells, expected 8");
  EXPECT_EQ(of_rows("lines", "0,0,1,0,0,1,0.5,-1\n"),
            "lines:line 5: '-1' as share, expected a number from 0 to 1e+06");
  EXPECT_EQ(of_rows("lines", "0,0,1,0,,1,0.5,0.1\n"),
            "lines:line 5: nothing as camera_x, expected a number from -1.3 to 0.8");
  EXPECT_EQ(of_rows("lines", "0,0,1,0,nan,1,0.5,0.1\n"),
            "lines:line 5: 'nan' as camera_x, expected a number from -1.3 to 0.8");
  EXPECT_EQ(of_rows("lines", "0,0,1,0,0,1e999,0.5,0.1\n"),
            "lines:line 5: '1e999' as camera_y, expected a number from -0.2 to 1.6");
  EXPECT_EQ(of_rows("lines", "64,0,1,0,0,1,0.5,0.1\n"),
            "lines:line 5: '64' as cut, expected a number from 0 to 63");
  EXPECT_EQ(of_rows("lines", "0.5,0,1,0,0,1,0.5,0.1\n"),
            "lines:line 5: 0.5 as cut, expected a whole number");
  EXPECT_EQ(of_rows("lines", "0,0,1,0,0,1,0,0.1\n"),
            "lines:line 5: a line whose ends are one place");
  EXPECT_EQ(of_rows("probes", "0,0,1,0,0,1,0.5,2\n"),
            "probes:line 5: '2' as joins, expected a number from 0 to 1");
  EXPECT_EQ(of_rows("air", "5,0,0\n"), "air:line 5: '5' as i, expected a number from 0 to 4");
  EXPECT_EQ(of_rows("count", "0,0,0,-1,0,0,0\n"),
            "count:line 5: '-1' as count, expected a number from 0 to 1e+30");
  EXPECT_EQ(of_rows("count", "0,0,0,1,inf,0,0\n"),
            "count:line 5: 'inf' as direction_x, expected a number from -1e+30 to 1e+30");
  EXPECT_EQ(of_rows("count", "0,0,0,1,0,0,0\n0,0,0,1,0,0,0\n"),
            "count:line 6: a voxel again, expected each once");
  EXPECT_EQ(of_rows("air", "0,0,0\n# grid 0 0 0 1 1 1 1\n"),
            "air:line 6: a '#' line behind a row, expected it before");
}

TEST(light_tables, of_different_grids_are_refused) {
  const std::string air = light_table_text(small(), "air");
  const auto with = [&](const std::string& was, const std::string& is) {
    const std::string lines = light_table_text(small(), "lines");
    EXPECT_NE(lines, replaced(lines, was, is));
    return complaint({{"air", air}, {"lines", replaced(lines, was, is)}});
  };
  const std::string as_well = " than above or in another table, expected the same";
  EXPECT_EQ(with("scene abc", "scene abd"), "lines:line 8: another scene" + as_well);
  EXPECT_EQ(with("fronts", "all"), "lines:line 9: another camera" + as_well);
  EXPECT_EQ(with(" 5 4 3", " 5 4 4"), "lines:line 10: another grid" + as_well);
  EXPECT_EQ(with("bottleneck yes", "bottleneck no light"),
            "lines:line 11: another bottleneck" + as_well);
  EXPECT_EQ(with("cut 0 0.01", "cut 0 0.02"), "lines:line 12: another cut" + as_well);
  EXPECT_EQ(complaint({{"a", air}, {"b", air}}), "b: is a second table of air, beside a");
}

TEST(light_tables, ask_before_they_take_memory) {
  const uint64_t limit = memory_limit();
  limit_memory(1000000);
  EXPECT_EQ(of_rows("air", "", " 5 4 3", " 128 128 128"),
            "air: 2097152 voxels, expected at most 1129472 of so few rows");
  EXPECT_TRUE(of_rows("air", "", " 5 4 3", " 100 100 100").starts_with("air: 1000000 voxels take"));
  std::string lines = kByHand;
  for (int i = 0; i < 20000; ++i) lines += "\n0,0,1,0,0,1,1";
  EXPECT_TRUE(complaint({{"lines", lines}}).starts_with("lines: 20006 lines take"));
  limit_memory(limit);
}

class files : public ::testing::Test {
 protected:
  testing::TempFolder folder_;
};

std::string message(const std::function<void()>& read) {
  try {
    read();
  } catch (const InputError& e) {
    return std::string(e.what()).substr(std::string(e.what()).rfind('/') + 1);
  }
  return "(accepted)";
}

TEST_F(files, are_a_grid_or_tables_of_one) {
  const LightGrid g = small();
  std::vector<std::string> tables;
  for (const TableText& table : tables_of(g))
    tables.push_back(folder_.write(table.name, table.text));
  std::vector<cli::Common::Input> read;
  expect_same_lines(read_light(tables, read), g);
  ASSERT_EQ(read.size(), 4u);
  EXPECT_EQ(read[2].path, tables[2]);
  EXPECT_NE(read[2].hash, read[1].hash);
  read.clear();
  const std::string vdb = folder_.write("a.vdb", light_grid_bytes(g));
  EXPECT_EQ(read_light({vdb}, read).lines.size(), g.lines.size());
  EXPECT_EQ(message([&] { read_light({tables[2]}, read); }),
            "air.csv: is given without a table of lines, expected one");
  EXPECT_EQ(message([&] {
              read_light({tables[0], vdb}, read);
            }),
            "a.vdb: is a binary file, expected a table of a light grid");
}

TEST_F(files, of_lines_for_another_grid_keep_to_its_limits) {
  const std::string lines = folder_.write("lines.csv", kByHand);
  EXPECT_EQ(read_light_lines(lines, {}).lines.size(), 2u);
  LineLimits limits;
  limits.high = {3, 3, 3};
  EXPECT_EQ(message([&] { read_light_lines(lines, limits); }),
            "lines.csv:line 4: '4' as camera_x, expected a number from -1e+30 to 3");
  const std::string air = folder_.write("air.csv", light_table_text(small(), "air"));
  EXPECT_EQ(message([&] { read_light_lines(air, {}); }),
            "air.csv: is a table of air, expected one of lines");
  const std::string none = folder_.write("none.csv", light_table_text(LightGrid(), "lines"));
  EXPECT_EQ(message([&] { read_light_lines(none, {}); }),
            "none.csv: holds no line, expected one at least");
}

}  // namespace tdpt::light_tables_test
