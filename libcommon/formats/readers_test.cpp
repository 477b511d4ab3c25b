// What all readers of files do with files that are cut short or damaged.
#include <functional>

#include <gtest/gtest.h>

#include "libcommon/formats/cut.h"
#include "libcommon/formats/dimacs.h"
#include "libcommon/formats/environment.h"
#include "libcommon/formats/light_tables.h"
#include "libcommon/formats/picture.h"
#include "libcommon/formats/portal.h"
#include "libcommon/testing/files/refusal.h"
#include "libcommon/testing/files/small_light_grid.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::readers_test {

PatchFile patches() {
  PatchFile f;
  f.scene_hash = "0123456789abcdef";
  f.grid = {{-1.25, 0.1, 3e-7}, 0.1443};
  f.patches = {{3, 0, {1, -2, 7}, 120, {0.1, 0.2, 0.3}, {0, 1, 0}, {0, 2}},
               {4, 1, {4, 5, 6}, 3, {1, 2, 3}, {0.6, 0, -0.8}, {5}}};
  return f;
}
std::string cut(bool bottleneck) {
  CutFile f;
  static_cast<PatchFile&>(f) = patches();
  f.sides = {0, 1};
  f.cuts = {{2.75, 0.015}};
  if (bottleneck) f.arcs = {{0, 1, 2.5}};
  f.bottleneck = bottleneck;
  return cut_text(f);
}
std::string dimacs() {
  DimacsFile f;
  static_cast<PatchFile&>(f) = patches();
  f.has_patches = true;
  f.scale = 1000;
  f.walks = {{0, 210, {12}}, {90, 40, {160}}};
  f.network = {4, 0, 1, {{0, 2, 500}, {2, 3, 250}, {3, 2, 250}, {3, 1, 700}}};
  return dimacs_text(f);
}
std::string picture() {
  ExrFile file;
  file.picture = {16, 8, {}};
  Rng rng(1, 0, 0);
  for (int i = 0; i < 16 * 8; ++i)
    file.picture.pixels.push_back(Rgb(static_cast<float>(rng.uniform())));
  file.layers["a"] = file.picture;
  return exr_bytes(file);
}
std::string radiance() {
  std::string row{2, 2, 0, 10, char(138), char(128), char(138), 9, char(131), 7, 7};
  row += std::string{1, 2, 3, 4, 5, 6, 0, char(138), char(129)};
  return "#?RADIANCE\n\n-Y 5 +X 10\n" + row + row + row + row + row;
}
std::string portal() {
  Portal p;
  p.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  p.triangles = {{0, 1, 2}};
  return portal_bytes({{p}, {}, {}, {}});
}

using Read = std::function<void(const std::string& bytes)>;
// A reader of files, which must be named.
template <class Result>
Read of_file(Result (*read)(const std::string&)) {
  return [read](const std::string& bytes) {
    static const testing::TempFolder folder;
    read(folder.write("file", bytes));
  };
}

struct Reader {
  std::string name, bytes;
  Read read;
  size_t step = 1;  ///< from one place where the file ends early to the next
};
std::vector<Reader> readers() {
  std::vector<Reader> all{
      {"cut", cut(true), of_file(read_cut)},
      {"cut without a bottleneck", cut(false), of_file(read_cut)},
      {"dimacs", dimacs(), of_file(read_dimacs)},
      {"portals", portal(), of_file(read_portals), 7},
      {"picture", picture(), [](const std::string& b) { parse_exr(b, "a"); }},
      {"environment", picture(), [](const std::string& b) { parse_environment(b, "a"); }, 17},
      {"radiance", radiance(), [](const std::string& b) { parse_environment(b, "a"); }},
  };
  const LightGrid grid = testing::small_light_grid(3);
  for (const std::string& table : light_table_names())
    all.push_back({"table of " + table, light_table_text(grid, table), [](const std::string& b) {
                     parse_light_tables({{"a", b}});
                   }});
  // Read in a process of its own. What another program has saved has no hash that tells damage.
  const Read grids = [](const std::string& b) { read_light_grid(b, "a"); };
  const std::string ours = light_grid_bytes(grid);
  all.push_back({"light grid", ours, grids, 5003});
  all.push_back(
      {"light grid saved again", std::string(ours).replace(21 + 14, 1, "4"), grids, 1009});
  return all;
}

TEST(readers, refuse_in_one_line_what_is_cut_short) {
  for (const Reader& reader : readers()) {
    EXPECT_NO_THROW(reader.read(reader.bytes)) << reader.name;
    for (size_t n = 0; n < reader.bytes.size(); n += reader.step) {
      const std::string said =
          testing::refusal<InputError>([&] { reader.read(reader.bytes.substr(0, n)); });
      ASSERT_NE(said, "") << reader.name << ", accepted:\n" << reader.bytes.substr(0, n);
      ASSERT_EQ(said.find('\n'), said.npos) << said;
    }
  }
}

// However a file is damaged, it is read or refused with a message; run under sanitizers, too. More
// of it is in testdata/fuzz.
TEST(readers, read_or_refuse_what_is_damaged) {
  for (const Reader& reader : readers()) {
    Rng rng(5, 0, 0);
    int refused = 0;
    const int times = static_cast<int>(300 / std::min<size_t>(reader.step, 30));
    for (int k = 0; k < times; ++k) {
      std::string bytes = reader.bytes;
      for (uint32_t n = 1 + rng.below(4); n > 0; --n) {
        const uint32_t at = rng.below(static_cast<uint32_t>(bytes.size()));
        const uint32_t how = rng.below(3);
        if (how == 0) bytes[at] = static_cast<char>(rng.below(256));
        if (how == 1) bytes.erase(at, 1 + rng.below(9));
        if (how == 2) bytes.insert(at, std::to_string(rng.bits()));
      }
      refused += !testing::refusal<InputError>([&] { reader.read(bytes); }).empty();
    }
    EXPECT_GT(refused, times / 2) << reader.name;
  }
}

}  // namespace tdpt::readers_test
