#include "tools/tdpt-render/device/tables.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace tdpt {
namespace {

using std::numbers::pi;

constexpr float kBlack = 1e-30f;  // in units of radiance: kernels treat less as 0
// Suns are sampled and found by float directions, accurate to 1e-7.
constexpr double kLeastHalfAngle = 5e-5, kSunMargin = 4e-7;
// As in SkyDirections [sky.cpp]: a coarse map is subdivided if its parts get weights; the cells of
// a fine one are grouped into blocks.
constexpr int kColumns = 128, kRows = 64, kFewCells = 40000, kBlock = 4;

Rgb in_units(const Rgb& radiance, double unit) {
  Rgb c(Vec3d(radiance) / unit);
  for (int i = 0; i < 3; ++i)
    if (!(c[i] > kBlack)) c[i] = 0;
  return c;
}

double versine(double angle) {
  const double s = std::sin(0.5 * angle);
  return 2 * s * s;
}

// The entries into which a sky is cut, and the light of each.
class SkyEntries {
 public:
  SkyEntries(const Sky& sky, const std::vector<shader::SkyTexel>& texels, bool split)
      : sky_(sky),
        texels_(texels),
        width_(std::max(sky.map().width, 1)),
        height_(std::max(sky.map().height, 1)) {
    if (split) {
      split_x_ = (kColumns + width_ - 1) / width_;
      split_y_ = (kRows + height_) / (height_ + 1);
    }
    if (split_x_ * split_y_ == 1 && int64_t{width_} * (height_ + 1) > kFewCells) block_ = kBlock;
  }
  int fine_columns() const { return width_ * split_x_; }
  int fine_rows() const { return (height_ + 1) * split_y_; }
  int columns() const { return (fine_columns() + block_ - 1) / block_; }
  int rows() const { return (fine_rows() + block_ - 1) / block_; }
  int block() const { return block_; }

  // Luminance x solid angle of a fine cell.
  double light(int column, int row) const {
    const std::array<size_t, 4> at = sky_.corners({column / split_x_, row / split_y_});
    std::array<double, 4> c;
    for (size_t i = 0; i < 4; ++i)
      c[i] = luminance({texels_[at[i]].r, texels_[at[i]].g, texels_[at[i]].b});
    const double x = (column % split_x_ + 0.5) / split_x_, y = (row % split_y_ + 0.5) / split_y_;
    const double mean = (1 - y) * ((1 - x) * c[0] + x * c[1]) + y * ((1 - x) * c[2] + x * c[3]);
    return mean > kBlack ? mean * sky_.solid_angle(row / split_y_) / (split_x_ * split_y_) : 0;
  }
  // Light of each cell of block (i, j), row by row; 0 beyond the map.
  std::vector<double> lights(int i, int j) const {
    std::vector<double> all;
    for (int row = j * block_; row < (j + 1) * block_; ++row)
      for (int column = i * block_; column < (i + 1) * block_; ++column)
        all.push_back(row < fine_rows() && column < fine_columns() ? light(column, row) : 0);
    return all;
  }
  std::vector<double> of_blocks() const {
    std::vector<double> sums;
    for (int j = 0; j < rows(); ++j)
      for (int i = 0; i < columns(); ++i) {
        double sum = 0;
        for (const double light : lights(i, j)) sum += light;
        sums.push_back(sum);
      }
    return sums;
  }
  // Centre of block (i, j).
  Sky::Cell middle(int i, int j) const {
    const auto twice = [&](int k, int end) { return k * block_ + std::min((k + 1) * block_, end); };
    const int x = twice(i, fine_columns()), y = twice(j, fine_rows());
    const int columns = 2 * split_x_, rows = 2 * split_y_;
    return {x / columns, y / rows, static_cast<double>(x % columns) / columns,
            static_cast<double>(y % rows) / rows};
  }
  void describe(const WordTable& words, size_t suns, shader::SkyTable& table) const {
    table.begin = words.begin;
    table.guide = words.guide;
    table.entries = words.entries;
    table.blocks = words.entries - static_cast<uint32_t>(suns);
    table.columns = static_cast<uint32_t>(columns());
    table.block = static_cast<uint32_t>(block_);
    table.split_x = static_cast<uint32_t>(split_x_);
    table.split_y = static_cast<uint32_t>(split_y_);
  }

 private:
  const Sky& sky_;
  const std::vector<shader::SkyTexel>& texels_;
  int width_, height_, split_x_ = 1, split_y_ = 1, block_ = 1;
};

void add_texels(const Sky& sky, double unit, LightTables& tables) {
  tables.texels.clear();
  for (const Rgb& texel : sky.map().texels) {
    const Rgb c = in_units(texel, unit);
    tables.texels.push_back({c.x, c.y, c.z, 0});
  }
}

void add_rows(int height, LightTables& tables) {
  tables.settings.first_row = static_cast<uint32_t>(tables.words.size());
  const auto edge = [&](int row) { return std::clamp(pi * (row - 0.5) / height, 0.0, pi); };
  const auto add = [&](double x) {
    tables.words.push_back(std::bit_cast<uint32_t>(static_cast<float>(x)));
  };
  for (int row = 0; row <= height; ++row) {
    const double top = edge(row), bottom = edge(row + 1);
    const double difference = 2 * std::sin(0.5 * (top + bottom)) * std::sin(0.5 * (bottom - top));
    add(versine(top));
    add(versine(pi - top));
    add(difference);
    add(1 / difference);
  }
}

// Shares of the cells in each block, row by row.
void add_cells(const SkyEntries& entries, LightTables& tables) {
  tables.settings.first_cell = static_cast<uint32_t>(tables.words.size());
  for (int j = 0; j < entries.rows(); ++j)
    for (int i = 0; i < entries.columns(); ++i) {
      const std::vector<double> lights = entries.lights(i, j);
      const bool dark = std::all_of(lights.begin(), lights.end(), [](double y) { return y <= 0; });
      const std::vector<uint64_t> places =
          dark ? std::vector<uint64_t>(lights.size() + 1) : whole_shares(lights, 65535);
      for (size_t cell = 0; cell < lights.size(); cell += 2)
        tables.words.push_back(static_cast<uint32_t>((places[cell + 1] - places[cell]) |
                                                     (places[cell + 2] - places[cell + 1]) << 16));
    }
}

struct SunLights {
  std::vector<double> versines, lights;  // of the suns that are sampled
};

SunLights add_suns(const Sky& sky, double unit, LightTables& tables) {
  SunLights all;
  for (const Sky::Sun& sun : sky.suns()) {
    const double half = std::max(sun.half_angle, kLeastHalfAngle);
    const double wider = versine(sun.half_angle) / versine(half);
    shader::SkySun s{};
    s.towards = Vec3f(sun.towards);
    s.versine = static_cast<float>(versine(half));
    const double chord = std::sqrt(2 * versine(half)) - kSunMargin;
    s.drawn = static_cast<float>(0.5 * chord * chord);
    s.radiance = in_units(Rgb(Vec3d(sun.radiance) * wider), unit);
    all.versines.push_back(versine(half));
    all.lights.push_back(luminance(s.radiance) * 2 * pi * versine(half));
    tables.suns.push_back(s);
  }
  return all;
}

std::vector<double> with_suns(std::vector<double> lights, const SunLights& suns) {
  lights.insert(lights.end(), suns.lights.begin(), suns.lights.end());
  return lights;
}

// A tenth of the walks by luminance, the others by luminance x weight, as in LightSelection.
std::vector<double> preferred(const SkyDirections& by_weight, const SkyEntries& entries,
                              bool has_blocks, const std::vector<double>& lights) {
  std::vector<double> weighted = lights;
  size_t k = 0;
  if (has_blocks)
    for (int j = 0; j < entries.rows(); ++j)
      for (int i = 0; i < entries.columns(); ++i, ++k)
        weighted[k] *= by_weight.weight_at(entries.middle(i, j));
  for (size_t i = 0; k < weighted.size(); ++i, ++k) weighted[k] *= by_weight.weight_of_sun(i);
  double all = 0, all_weighted = 0;
  for (const double w : lights) all += w;
  for (const double w : weighted) all_weighted += w;
  if (!(all_weighted > 0)) return lights;
  for (size_t i = 0; i < weighted.size(); ++i)
    weighted[i] = (1 - LightSelection::kPreferred) * lights[i] / all +
                  LightSelection::kPreferred * weighted[i] / all_weighted;
  return weighted;
}

float share_of(const shader::SkyTable& table, uint32_t entry, const LightTables& tables) {
  const uint32_t words = tables.words[table.begin + entry + 1] - tables.words[table.begin + entry];
  return static_cast<float>(words) * 0x1p-32f;
}

}  // namespace

void add_sky(const Vista& vista, double radiance_unit, LightTables& tables) {
  const Sky& sky = *vista.world->scene.sky;
  shader::LightSettings& settings = tables.settings;
  add_texels(sky, radiance_unit, tables);
  const bool black = std::all_of(tables.texels.begin(), tables.texels.end(), [](const auto& t) {
    return !(luminance({t.r, t.g, t.b}) > kBlack);
  });
  tables.has_sky_map = !black && !sky.one_colour();
  settings.sky_cos = static_cast<float>(sky.turn_cos());
  settings.sky_sin = static_cast<float>(sky.turn_sin());
  settings.sky_width = static_cast<uint32_t>(black ? 1 : sky.map().width);
  settings.sky_height = static_cast<uint32_t>(black ? 1 : sky.map().height);
  add_rows(static_cast<int>(settings.sky_height), tables);
  const SunLights suns = add_suns(sky, radiance_unit, tables);
  settings.suns = static_cast<uint32_t>(suns.lights.size());
  if (!black && sky.one_colour())
    settings.sky_colour = {tables.texels[0].r, tables.texels[0].g, tables.texels[0].b};

  // To sample by luminance alone, a sky of one colour needs only one entry.
  const SkyEntries plain(sky, tables.texels, false);
  std::vector<double> lights;
  if (!black && sky.one_colour()) lights = {luminance(settings.sky_colour) * 4 * pi};
  if (tables.has_sky_map) lights = plain.of_blocks();
  lights = with_suns(std::move(lights), suns);
  plain.describe(add_word_table(lights, tables.words), suns.lights.size(), settings.plain);
  settings.colour_w =
      !black && sky.one_colour()
          ? share_of(settings.plain, 0, tables) * static_cast<float>(0.25 * std::numbers::inv_pi)
          : 0;
  if (tables.has_sky_map && plain.block() > 1) add_cells(plain, tables);

  settings.start = settings.plain;
  const SkyDirections& by_weight = vista.openings.selection.preferred();
  tables.prefers = !by_weight.empty();
  if (tables.prefers) {
    const SkyEntries parts(sky, tables.texels, true);
    if (!black) lights = with_suns(parts.of_blocks(), suns);
    parts.describe(add_word_table(preferred(by_weight, parts, !black, lights), tables.words),
                   suns.lights.size(), settings.start);
  }
  for (uint32_t i = 0; i < settings.suns; ++i) {
    const auto density = [&](const shader::SkyTable& table) {
      return static_cast<float>(share_of(table, table.blocks + i, tables) /
                                (2 * pi * suns.versines[i]));
    };
    tables.suns[i].plain_w = density(settings.plain);
    tables.suns[i].start_w = density(settings.start);
  }
}

namespace {

void add_frame(const WindowFrame& f, double radiance_unit, LightTables& tables) {
  shader::WindowFrame frame{};
  frame.x = Vec3f(f.x);
  frame.y = Vec3f(f.y);
  frame.z = Vec3f(f.z);
  frame.cells = f.cells;
  frame.sums = static_cast<uint32_t>(tables.words.size());
  frame.unit = static_cast<float>(f.unit / radiance_unit);
  tables.frames.push_back(frame);
  tables.words.insert(tables.words.end(), f.sums.begin(), f.sums.end());
}

void add_views(const WindowViews& views, size_t windows, LightTables& tables) {
  shader::LightSettings& settings = tables.settings;
  const uint32_t all = windows < 32 ? (1u << windows) - 1 : ~0u;
  settings.view_low = Vec3f(views.low());
  settings.view_scale = static_cast<float>(views.per_width());
  settings.view_x = static_cast<uint32_t>(views.size()[0]);
  settings.view_y = static_cast<uint32_t>(views.size()[1]);
  settings.view_z = static_cast<uint32_t>(views.size()[2]);
  settings.view_beyond = views.beyond() & all;
  settings.first_view = static_cast<uint32_t>(tables.words.size());
  for (const uint32_t mask : views.masks()) tables.words.push_back(mask & all);
}

}  // namespace

void add_windows(const WindowSky& windows, double radiance_unit, LightTables& tables) {
  std::vector<const WindowFrame*> frames;
  for (const WindowSky::Window& w : windows.windows()) {
    const auto found = std::find(frames.begin(), frames.end(), w.frame.get());
    const auto frame = static_cast<uint32_t>(found - frames.begin());
    if (found == frames.end()) {
      frames.push_back(w.frame.get());
      add_frame(*w.frame, radiance_unit, tables);
    }
    shader::SkyWindow window{};
    window.x0 = static_cast<float>(w.x0);
    window.x1 = static_cast<float>(w.x1);
    window.y0 = static_cast<float>(w.y0);
    window.y1 = static_cast<float>(w.y1);
    window.z = static_cast<float>(w.z);
    window.frame = frame;
    tables.windows.push_back(window);
  }
  tables.has_windows = !tables.windows.empty();
  if (tables.has_windows) add_views(windows.views(), tables.windows.size(), tables);
}

}  // namespace tdpt
