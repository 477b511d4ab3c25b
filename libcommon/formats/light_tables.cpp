// Tables of a light grid: names of columns, '#' lines with common values, rows. All headers are
// read before any rows, since any of them may give the common box.
#include "libcommon/formats/light_tables.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/formats/light_grid_header.h"
#include "libcommon/formats/text_lines.h"
#include "libcommon/math/reach.h"

namespace tdpt {
namespace {

#define ENDS "cut,light_x,light_y,light_z,camera_x,camera_y,camera_z"
enum Table : size_t { kLines, kProbes, kAir, kCount };
constexpr std::array<const char*, 4> kNames{"lines", "probes", "air", "count"};
constexpr std::array<std::string_view, 4> kColumns{
    ENDS ",share", ENDS ",joins", "i,j,k", "i,j,k,count,direction_x,direction_y,direction_z"};
// Lines of unknown share, as another program may draw them.
constexpr std::string_view kOwnLines = ENDS;
#undef ENDS
constexpr double kFarthest = LineLimits::kFarthest;
constexpr int kResolution = 128;  // of the box if no table gives one

// ---- Writing ----

void write_ends(std::string& out, const LightLine& l) {
  fmt::format_to(std::back_inserter(out), "{},{},{},{},{},{},{}", l.cut, l.light.x, l.light.y,
                 l.light.z, l.camera.x, l.camera.y, l.camera.z);
}

void write_voxels(std::string& out, const LightGrid& grid, bool counts) {
  const auto to = std::back_inserter(out);
  size_t at = 0;
  for (int k = 0; k < grid.dim[2]; ++k)
    for (int j = 0; j < grid.dim[1]; ++j)
      for (int i = 0; i < grid.dim[0]; ++i, ++at) {
        if (counts ? !(grid.count[at] > 0) : !grid.air[at]) continue;
        fmt::format_to(to, "{},{},{}", i, j, k);
        const Vec3f& d = grid.direction[at];
        if (counts) fmt::format_to(to, ",{},{},{},{}", grid.count[at], d.x, d.y, d.z);
        out += '\n';
      }
}

// ---- Reading ----

std::string_view columns_of(std::string_view text) {
  TextLines in(text, "");
  return in.next() ? in.rest() : std::string_view();
}

// Removes and returns the next element of `list`, trimmed.
std::string_view next_cell(std::string_view& list) {
  std::string_view cell = list.substr(0, list.find(','));
  list.remove_prefix(std::min(cell.size() + 1, list.size()));
  cell.remove_prefix(std::min(cell.find_first_not_of(" \t"), cell.size()));
  return cell.substr(0, cell.find_last_not_of(" \t") + 1);
}

class TableReader {
 public:
  // Reads the columns and the '#' lines; merges their values into `all`. Keeps a view of the text.
  TableReader(const TableText& file, LightGridHeader& all)
      : name(file.name), text_(file.text), in_(file.text, file.name) {
    in_.expect_text("a table of a light grid");
    in_.next();
    all_columns_ = in_.rest();
    const auto known = std::find(kColumns.begin(), kColumns.end(), all_columns_);
    has_shares_ = all_columns_ != kOwnLines;
    if (known == kColumns.end() && has_shares_)
      in_.fail(fmt::format("{} as columns, expected those of {}", TextLines::found(all_columns_),
                           fmt::join(kNames, ", ")));
    table = has_shares_ ? static_cast<Table>(known - kColumns.begin()) : kLines;
    header_ = read_header(in_, all);
  }

  std::string name;
  Table table;

  [[noreturn]] void fail(const std::string& message) const { in_.fail_file(message); }

  // Adds the rows to `grid`, which must have voxels if the table has any.
  void read_rows(LightGrid& grid, const LineLimits& limits) {
    if (table == kLines || table == kProbes) {
      const auto rows = static_cast<uint64_t>(std::count(text_.begin(), text_.end(), '\n')) + 1;
      expect_memory(name, "", fmt::format("{} lines", rows), rows * sizeof(Probe));
    }
    uint64_t rows = 0;
    for (bool more = header_.more; more; more = in_.next(), ++rows) {
      cells_ = in_.rest(), columns_ = all_columns_;
      if (cells_.front() == '#') in_.fail("a '#' line behind a row, expected it before");
      const auto cells = std::count(cells_.begin(), cells_.end(), ',') + 1;
      const auto expected = std::count(columns_.begin(), columns_.end(), ',') + 1;
      if (cells != expected)
        in_.fail(fmt::format("a row of {} cells, expected {}", cells, expected));
      read_row(grid, limits);
    }
    if (header_.rows && rows != *header_.rows)
      fail(fmt::format("{} rows, expected the {} of its '# rows' line", rows, *header_.rows));
  }

 private:
  // -- Rows --

  // The next cell: a number within [lowest, highest].
  template <class T>
  T number(double lowest, double highest) {
    const std::string_view column = next_cell(columns_), cell = next_cell(cells_);
    T value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (cell.empty() || error != std::errc() || end != cell.data() + cell.size() ||
        !(value >= lowest && value <= highest))
      in_.fail(fmt::format("{} as {}, expected a number from {:.6g} to {:.6g}",
                           TextLines::found(cell), column, lowest, highest));
    return value;
  }

  // An integer below `end`; "3.0" is accepted.
  size_t whole(size_t end) {
    const std::string_view column = columns_.substr(0, columns_.find(','));
    const auto value = number<double>(0, static_cast<double>(end) - 1);
    if (value != std::floor(value))
      in_.fail(fmt::format("{} as {}, expected a whole number", value, column));
    return static_cast<size_t>(value);
  }

  Vec3d place(const LineLimits& limits) {
    Vec3d p;
    for (int c = 0; c < 3; ++c) p[c] = number<double>(limits.low[c], limits.high[c]);
    return p;
  }

  LightLine line(const LineLimits& limits) {
    LightLine l;
    l.cut = static_cast<uint32_t>(whole(limits.cuts));
    l.light = place(limits);
    l.camera = place(limits);
    if (!(length(l.camera - l.light) > 0)) in_.fail("a line whose ends are one place");
    return l;
  }

  size_t voxel(const LightGrid& grid) {
    std::array<int, 3> at;
    for (size_t c = 0; c < 3; ++c)
      at[c] = static_cast<int>(whole(static_cast<size_t>(grid.dim[c])));
    return grid.index(at[0], at[1], at[2]);
  }

  void read_row(LightGrid& grid, const LineLimits& limits) {
    if (table == kLines) {
      grid.lines.push_back(line(limits));
      if (has_shares_) grid.lines.back().share = double{number<float>(0, kMostShare)};
    } else if (table == kProbes) {
      const LightLine l = line(limits);
      grid.probes.push_back({l, whole(2) == 1});
    } else if (const size_t at = voxel(grid); table == kAir) {
      grid.air[at] = 1;
    } else {
      if (grid.count[at] > 0) in_.fail("a voxel again, expected each once");
      grid.count[at] = number<float>(0, kFarthest);
      for (int c = 0; c < 3; ++c) grid.direction[at][c] = number<float>(-kFarthest, kFarthest);
    }
  }

  std::string_view text_;
  TextLines in_;
  std::string_view all_columns_;
  bool has_shares_ = false;           // of lines
  HeaderEnd header_{};                // in_ is at the first row, if there is any
  std::string_view cells_, columns_;  // the rest of the row
};

// Sets the box around lines and probes if no table gives one, enlarged by half a voxel: a point on
// its upper face would be in no voxel.
void place_around_lines(LightGrid& grid) {
  Extent box;
  for (const LightLine& l : grid.lines) box.add(l.light), box.add(l.camera);
  for (const Probe& p : grid.probes) box.add(p.line.light), box.add(p.line.camera);
  if (box.empty()) return;
  const Vec3d size = box.size(), middle = box.low + size * 0.5;
  grid.voxel = max_component(size) / kResolution;
  for (int c = 0; c < 3; ++c) {
    const int side = static_cast<int>(std::ceil(size[c] / grid.voxel - 1e-6)) + 1;
    grid.dim[static_cast<size_t>(c)] = side;
    grid.origin[c] = middle[c] - 0.5 * side * grid.voxel;
  }
}

// Number of voxels to allocate: a few bytes must not allocate much memory.
size_t voxels_for(const LightGrid& grid, const std::vector<TableText>& texts) {
  constexpr size_t kForNothing = size_t{1} << 20, kForEachByte = 1024;
  size_t voxels = 1, most = kForNothing;
  for (const int side : grid.dim) voxels *= static_cast<size_t>(side);
  for (const TableText& text : texts) most += kForEachByte * text.text.size();
  const std::string& name = texts.front().name;
  if (voxels > most)
    throw InputError(name, "",
                     fmt::format("{} voxels, expected at most {} of so few rows", voxels, most));
  expect_memory(name, "", fmt::format("{} voxels", voxels),
                voxels * (sizeof(float) + sizeof(uint8_t) + sizeof(Vec3f)));
  return voxels;
}

// Sums counts and directions of the lines over voxels of air.
void count_lines(LightGrid& grid) {
  for (const LightLine& l : grid.lines) {
    const Vec3f d(normalize(l.camera - l.light));
    walk_grid(grid, l.light, l.camera, [&](size_t voxel, double) {
      if (grid.air[voxel]) grid.count[voxel] += 1, grid.direction[voxel] += d;
    });
  }
  for (size_t i = 0; i < grid.count.size(); ++i)
    if (grid.count[i] > 0) grid.direction[i] = grid.direction[i] / grid.count[i];
}

// Both ends within the box or one voxel around it, as in a .vdb.
LineLimits limits_of(const LightGrid& grid) {
  const Vec3d size = Vec3d(grid.dim[0], grid.dim[1], grid.dim[2]) * grid.voxel;
  return {grid.origin - Vec3d(grid.voxel), grid.origin + size + Vec3d(grid.voxel), kMostCuts};
}

}  // namespace

std::vector<std::string> light_table_names() {
  return {kNames.begin(), kNames.end()};
}

std::string light_table_text(const LightGrid& grid, const std::string& table) {
  const auto which = std::find(kNames.begin(), kNames.end(), table) - kNames.begin();
  std::string out;
  if (which == kLines)
    for (const LightLine& line : grid.lines) {
      write_ends(out, line);
      out += fmt::format(",{}\n", static_cast<float>(line.share));
    }
  else if (which == kProbes)
    for (const Probe& p : grid.probes) write_ends(out, p.line), out += p.joins ? ",1\n" : ",0\n";
  else
    write_voxels(out, grid, which == kCount);
  std::string head(kColumns[static_cast<size_t>(which)]);
  // Above the line that makes it a table: what is cut short between them is none.
  head += fmt::format("\n# rows {}\n", std::count(out.begin(), out.end(), '\n'));
  return head + header_of(grid) + out;
}

LightGrid parse_light_tables(const std::vector<TableText>& texts) {
  LightGridHeader all;
  std::vector<TableReader> tables;
  for (const TableText& text : texts) {
    TableReader next(text, all);
    for (const TableReader& other : tables)
      if (other.table == next.table)
        next.fail(
            fmt::format("is a second table of {}, beside {}", kNames[next.table], other.name));
    tables.push_back(std::move(next));
  }
  LightGrid& grid = all.grid;
  const auto read_rows = [&](Table table, const LineLimits& limits = {}) {
    for (TableReader& each : tables)
      if (each.table == table) return each.read_rows(grid, limits), true;
    return false;
  };
  const LineLimits limits = all.has_box ? limits_of(grid) : LineLimits();
  read_rows(kLines, limits);
  read_rows(kProbes, limits);
  for (const TableReader& each : tables)
    if (!all.has_box && (each.table == kAir || each.table == kCount))
      each.fail("no '# grid' line in any table, expected the box of the voxels");
  if (!all.has_box) place_around_lines(grid);
  const size_t voxels = voxels_for(grid, texts);
  grid.count.assign(voxels, 0);
  grid.direction.assign(voxels, {});
  grid.air.assign(voxels, 0);
  if (!read_rows(kAir)) grid.air.assign(voxels, 1);
  if (!read_rows(kCount)) count_lines(grid);
  return std::move(grid);
}

LightGrid read_light(const std::vector<std::string>& paths,
                     std::vector<cli::Common::Input>& files) {
  std::vector<TableText> texts;
  bool lines = false;
  for (const std::string& path : paths) {
    texts.push_back({display_name(path), read_file(path)});
    const std::string_view columns = columns_of(texts.back().text);
    lines = lines || columns == kOwnLines || columns == kColumns[kLines];
  }
  const bool tables =
      texts.size() > 1 || (columns_of(texts[0].text).find(',') != std::string_view::npos &&
                           texts[0].text.find('\0') == std::string::npos);
  LightGrid grid =
      tables ? parse_light_tables(texts) : read_light_grid(texts[0].text, texts[0].name);
  if (tables && !lines)
    throw InputError(texts[0].name, "", "is given without a table of lines, expected one");
  for (size_t t = 0; t < texts.size(); ++t)
    files.push_back({paths[t], content_hash(texts[t].text), grid.provenance});
  return grid;
}

LightGrid read_light_lines(const std::string& path, const LineLimits& limits) {
  const TableText text{display_name(path), read_file(path)};
  LightGridHeader all;
  TableReader table(text, all);
  if (table.table != kLines)
    table.fail(fmt::format("is a table of {}, expected one of lines", kNames[table.table]));
  LightGrid& grid = all.grid;
  table.read_rows(grid, limits);
  if (grid.lines.empty()) table.fail("holds no line, expected one at least");
  grid.hash = content_hash(text.text);
  return std::move(grid);
}

}  // namespace tdpt
