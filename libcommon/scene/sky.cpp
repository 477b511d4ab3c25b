#include "libcommon/scene/sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "libcommon/math/rng.h"

namespace tdpt {
namespace {

using std::numbers::pi;

// Versine of the half angle: solid angle / (2 pi), accurate for small ones.
double height_of(const Sky::Sun& sun) {
  const double s = std::sin(0.5 * sun.half_angle);
  return 2 * s * s;
}

bool holds(const Sky::Sun& sun, const Vec3d& towards) {
  const Vec3d d = towards - sun.towards;  // |d| = 2 sin(angle / 2)
  return 0.5 * dot(d, d) <= height_of(sun);
}

// Error up to 7e-5 rad, after Hastings (Abramowitz and Stegun 4.4.45): start of a search.
double rough_acos(double x) {
  const double a = std::min(std::abs(x), 1.0);
  const double p = ((-0.0187293 * a + 0.0742610) * a - 0.2121144) * a + 1.5707288;
  const double angle = std::sqrt(1 - a) * p;
  return x < 0 ? pi - angle : angle;
}

// Error up to 1.2e-5 rad, after Hastings (Abramowitz and Stegun 4.4.47).
double rough_atan2(double y, double x) {
  const double a = std::abs(x), b = std::abs(y), most = std::max(a, b);
  if (!(most > 0)) return 0;
  const double t = std::min(a, b) / most, t2 = t * t;
  double angle =
      t * (0.9998660 + t2 * (-0.3302995 + t2 * (0.1801410 + t2 * (-0.0851330 + t2 * 0.0208351))));
  if (b > a) angle = 0.5 * pi - angle;
  if (x < 0) angle = pi - angle;
  return std::copysign(angle, y);
}

double lerp(double t, double a, double b) {
  return (1 - t) * a + t * b;
}

// Samples a linear density on [0,1] with end values a and b.
double sample_linear(double a, double b, double u) {
  if (a == b) return u;
  return std::min(1.0, u * (a + b) / (a + std::sqrt(lerp(u, a * a, b * b))));
}

double bilinear(const std::array<double, 4>& c, double across, double down) {
  return lerp(down, lerp(across, c[0], c[1]), lerp(across, c[2], c[3]));
}

// Selects one of n weighted entries by `u`; rescales `u` to [0,1) within that entry.
template <class Weight>
int choose(int n, const Weight& weight, double total, double& u) {
  double left = u * total;
  int last = 0;
  for (int i = 0; i < n; ++i) {
    const double w = weight(i);
    if (!(w > 0)) continue;
    if (left < w) {
      u = left / w;
      return i;
    }
    left -= w;
    last = i;
  }
  u = std::nextafter(1.0, 0.0);  // rounding left no remainder
  return last;
}

// The table should fit the cache, which is worth summing the few cells of a block for a sample:
// measured 5 % of the time of nee for a map of 512 x 256. The upper bound only limits memory.
constexpr int64_t kFewBlocks = 10000, kMostBlocks = 2200000;
constexpr int kCachedBlock = 4;
constexpr int kLargestBlock = 16;
constexpr int kColumns = 128, kRows = 64;  // at least this many weights
// Samples stay this share of a fine cell away from its borders, so that look-up finds the same
// cell.
constexpr double kMargin = 1e-11;

}  // namespace

Sky::Sky(Map map, double rotation, std::vector<Sun> suns)
    : map_(std::move(map)),
      cos_(std::cos(rotation)),
      sin_(std::sin(rotation)),
      suns_(std::move(suns)) {
  top_.push_back(1);
  for (int i = 0; i < map_.height; ++i) top_.push_back(std::cos(pi * (i + 0.5) / map_.height));
  top_.push_back(-1);
}

void Sky::raster(const Vec3d& w, double& x, double& y) const {
  // Undoes the rotation about +y.
  const double wx = cos_ * w.x - sin_ * w.z, wz = sin_ * w.x + cos_ * w.z;
  const double u = 0.5 + std::atan2(wx, -wz) * (0.5 * std::numbers::inv_pi);
  const double v = std::acos(std::clamp(w.y, -1.0, 1.0)) * std::numbers::inv_pi;
  x = std::min(u * map_.width, std::nextafter(static_cast<double>(map_.width), 0.0));
  y = std::min(v * map_.height, std::nextafter(static_cast<double>(map_.height), 0.0));
}

Vec3d Sky::towards(double x, double y) const {
  const double phi = (x / map_.width - 0.5) * 2 * pi, theta = y / map_.height * pi;
  const double s = std::sin(theta), wx = s * std::sin(phi), wz = -s * std::cos(phi);
  return {cos_ * wx + sin_ * wz, std::cos(theta), -sin_ * wx + cos_ * wz};
}

Sky::Cell Sky::cell(const Vec3d& w) const {
  const double wx = cos_ * w.x - sin_ * w.z, wz = sin_ * w.x + cos_ * w.z;
  return cell(w, std::atan2(wx, -wz));
}

Sky::Cell Sky::cell(const Vec3d& w, double azimuth) const {
  double x = (0.5 + azimuth * (0.5 * std::numbers::inv_pi)) * map_.width - 0.5;
  if (x < 0) x += map_.width;
  Cell c;
  c.column = std::clamp(static_cast<int>(x), 0, map_.width - 1);  // also for NaN
  c.across = x - c.column;
  c.row = static_cast<int>(rough_acos(w.y) * std::numbers::inv_pi * map_.height + 0.5);
  c.row = std::clamp(c.row, 0, map_.height);
  const auto top = [&](int row) { return top_[static_cast<size_t>(row)]; };
  while (c.row > 0 && w.y > top(c.row)) --c.row;
  while (c.row < map_.height && w.y <= top(c.row + 1)) ++c.row;
  c.down = std::clamp((top(c.row) - w.y) / (top(c.row) - top(c.row + 1)), 0.0, 1.0);
  return c;
}

Vec3d Sky::towards(const Cell& c) const {
  const auto row = static_cast<size_t>(c.row);
  const double y = std::max(lerp(c.down, top_[row], top_[row + 1]),
                            std::nextafter(top_[row + 1], 1.0));  // still in that row
  const double phi = ((c.column + c.across + 0.5) / map_.width - 0.5) * 2 * pi;
  const double s = std::sqrt((1 - y) * (1 + y)), wx = s * std::sin(phi), wz = -s * std::cos(phi);
  return {cos_ * wx + sin_ * wz, y, -sin_ * wx + cos_ * wz};
}

std::array<size_t, 4> Sky::corners(const Cell& c) const {
  const auto width = static_cast<size_t>(map_.width);
  const auto left = static_cast<size_t>(c.column), right = left + 1 == width ? 0 : left + 1;
  const size_t upper = static_cast<size_t>(std::max(c.row - 1, 0)) * width;
  const size_t lower = static_cast<size_t>(std::min(c.row, map_.height - 1)) * width;
  return {upper + left, upper + right, lower + left, lower + right};
}

double Sky::solid_angle(int row) const {
  const auto i = static_cast<size_t>(row);
  return (top_[i] - top_[i + 1]) * 2 * pi / map_.width;
}

Sky::Place Sky::place(const Vec3d& w) const {
  if (map_.texels.empty()) return {w};
  const Cell c = cell(w);
  return {w, c, corners(c)};
}

Sky::Place Sky::rough_place(const Vec3d& w) const {
  if (map_.texels.empty()) return {w};
  const double wx = cos_ * w.x - sin_ * w.z, wz = sin_ * w.x + cos_ * w.z;
  const Cell c = cell(w, rough_atan2(wx, -wz));
  return {w, c, corners(c)};
}

Rgb Sky::radiance(const Place& place) const {
  Rgb sum{};
  if (one_colour()) {
    sum = map_.texels[0];
  } else if (!map_.texels.empty()) {
    const Cell& c = place.cell;
    const std::array<size_t, 4>& at = place.texels;
    const auto row = [&](size_t left, size_t right) {
      return map_.texels[left] * static_cast<float>(1 - c.across) +
             map_.texels[right] * static_cast<float>(c.across);
    };
    sum = row(at[0], at[1]) * static_cast<float>(1 - c.down) +
          row(at[2], at[3]) * static_cast<float>(c.down);
  }
  for (const Sun& sun : suns_)
    if (holds(sun, place.towards)) sum += sun.radiance;
  return sum;
}

SkyDirections::SkyDirections(const Sky& sky,
                             const std::function<double(const Vec3d& towards)>& weight)
    : sky_(&sky) {
  choose_blocks(static_cast<bool>(weight));
  std::vector<double> integrals;
  const auto add = [&](const Vec3d& towards, double light) {
    if (weight) {
      weights_.push_back(static_cast<float>(weight(towards)));
      light *= weights_.back();
    }
    integrals.push_back(light);
    total_ += light;
  };
  for (int i = 0; i < blocks(); ++i) {
    const Block b = block(i);
    double light = 0;
    for (int row = b.row; row < b.end_row; ++row)
      for (int column = b.column; column < b.end_column; ++column) light += integral(column, row);
    add(middle(b), light);
  }
  for (const Sky::Sun& sun : sky.suns())
    add(sun.towards, luminance(sun.radiance) * 2 * pi * height_of(sun));
  if (total_ > 0) table_ = CumulativeTable(integrals);
}

void SkyDirections::choose_blocks(bool weighted) {
  const Sky::Map& map = sky_->map();
  if (map.texels.empty()) return;
  if (weighted) {
    split_ = (kColumns + map.width - 1) / map.width;
    split_down_ = (kRows + map.height) / (map.height + 1);
  }
  for (block_ = 1;; block_ *= 2) {
    columns_ = (fine_columns() + block_ - 1) / block_;
    rows_ = (fine_rows() + block_ - 1) / block_;
    const int64_t most = block_ < kCachedBlock ? kFewBlocks : kMostBlocks;
    if (split_ * split_down_ > 1) return;
    if (int64_t{columns_} * rows_ <= most || block_ == kLargestBlock) return;
  }
}

SkyDirections::Block SkyDirections::block(int i) const {
  const int row = i / columns_ * block_, column = i % columns_ * block_;
  return {column, row, std::min(column + block_, fine_columns()),
          std::min(row + block_, fine_rows())};
}

SkyDirections::Corners SkyDirections::corners(int fine_column, int fine_row) const {
  const Sky::Cell cell{fine_column / split_, fine_row / split_down_};
  Corners c{};
  const std::array<size_t, 4> at = sky_->corners(cell);
  for (size_t i = 0; i < 4; ++i) c[i] = luminance(sky_->map().texels[at[i]]);
  if (split_ == 1 && split_down_ == 1) return c;
  const double x = 1.0 / split_, y = 1.0 / split_down_;
  const double left = fine_column % split_ * x, upper = fine_row % split_down_ * y;
  return {bilinear(c, left, upper), bilinear(c, left + x, upper), bilinear(c, left, upper + y),
          bilinear(c, left + x, upper + y)};
}

double SkyDirections::integral(int fine_column, int fine_row) const {
  const Corners c = corners(fine_column, fine_row);
  return 0.25 * (c[0] + c[1] + c[2] + c[3]) * sky_->solid_angle(fine_row / split_down_) /
         (split_ * split_down_);
}

Vec3d SkyDirections::middle(const Block& b) const {
  const int column = b.column + b.end_column, row = b.row + b.end_row;  // twice the centre
  const int columns = 2 * split_, rows = 2 * split_down_;
  return sky_->towards(Sky::Cell{column / columns, row / rows,
                                 static_cast<double>(column % columns) / columns,
                                 static_cast<double>(row % rows) / rows});
}

int SkyDirections::block_at(const Sky::Cell& cell) const {
  const auto part = [](double place, int parts) {
    return std::clamp(static_cast<int>(place * parts), 0, parts - 1);
  };
  const int column = cell.column * split_ + part(cell.across, split_);
  const int row = cell.row * split_down_ + part(cell.down, split_down_);
  return row / block_ * columns_ + column / block_;
}

Sky::Place SkyDirections::draw(double pick, double u, double v) const {
  const auto i = static_cast<int>(table_.sample(pick));
  return i < blocks() ? in_block(block(i), u, v)
                      : sky_->place(in_sun(sky_->suns()[static_cast<size_t>(i - blocks())], u, v));
}

// Selects a cell of the block; u and v become the position within it. Blocks of several cells have
// no fine cells.
void SkyDirections::choose_cell(const Block& b, int& column, int& row, double& u, double& v) const {
  const int columns = b.end_column - b.column, rows = b.end_row - b.row;
  column = b.column;
  row = b.row;
  if (columns * rows == 1) return;
  const Sky::Map& map = sky_->map();
  constexpr int kNodes = kLargestBlock + 1;
  std::array<float, size_t{kNodes} * kNodes> light;  // of texels
  const auto node = [&](int c, int r) -> float& {
    return light[static_cast<size_t>(r * kNodes + c)];
  };
  for (int r = 0; r <= rows; ++r) {
    const int y = std::clamp(b.row + r - 1, 0, map.height - 1);
    const Rgb* const texels = &map.texels[static_cast<size_t>(y) * static_cast<size_t>(map.width)];
    for (int c = 0; c <= columns; ++c)
      node(c, r) = luminance(texels[b.column + c < map.width ? b.column + c : 0]);
  }
  const auto of_cell = [&](int c, int r) {
    return double{node(c, r)} + node(c + 1, r) + node(c, r + 1) + node(c + 1, r + 1);
  };
  std::array<double, kLargestBlock> of_row{};
  double total = 0;
  for (int r = 0; r < rows; ++r) {
    double& sum = of_row[static_cast<size_t>(r)];
    for (int c = 0; c < columns; ++c) sum += of_cell(c, r);
    total += sum *= sky_->solid_angle(b.row + r);
  }
  const int r = choose(
      rows, [&](int i) { return of_row[static_cast<size_t>(i)]; }, total, v);
  const double sum = of_row[static_cast<size_t>(r)] / sky_->solid_angle(b.row + r);
  column += choose(
      columns, [&](int i) { return of_cell(i, r); }, sum, u);
  row += r;
}

Sky::Place SkyDirections::in_block(const Block& b, double u, double v) const {
  int column, row;
  choose_cell(b, column, row, u, v);
  const Corners c = corners(column, row);
  const double y = sample_linear(c[0] + c[1], c[2] + c[3], v);
  const double x = sample_linear(lerp(y, c[0], c[2]), lerp(y, c[1], c[3]), u);
  const Sky::Cell cell{column / split_, row / split_down_,
                       (column % split_ + std::clamp(x, kMargin, 1 - kMargin)) / split_,
                       (row % split_down_ + std::clamp(y, kMargin, 1 - kMargin)) / split_down_};
  return {sky_->towards(cell), cell, sky_->corners(cell)};
}

Vec3d SkyDirections::in_sun(const Sky::Sun& sun, double u, double v) const {
  const double h = std::min(v, 1 - kMargin) * height_of(sun);  // 1 - cos
  const double r = std::sqrt(h * (2 - h)), phi = 2 * pi * u;
  const Vec3d at(r * std::cos(phi), r * std::sin(phi), 1 - h);
  return normalize(Onb<double>(sun.towards).to_world(at));
}

double SkyDirections::pdf_w(const Sky::Place& place) const {
  if (empty()) return 0;
  const auto& [towards, cell, at] = place;
  double sum = 0;
  if (sky_->one_colour()) {
    sum = luminance(sky_->map().texels[0]);
  } else if (blocks() > 0) {
    Corners c{};
    for (size_t i = 0; i < 4; ++i) c[i] = luminance(sky_->map().texels[at[i]]);
    sum = bilinear(c, cell.across, cell.down);
  }
  if (blocks() > 0 && !weights_.empty()) {
    Sky::Cell asked = cell;
    if (sky_->one_colour()) {
      // Only the block matters, and most directions are not near its borders.
      constexpr double kRough = 1e-5;  // of the circle
      asked = sky_->rough_place(towards).cell;
      if (std::abs(asked.across - std::round(asked.across * split_) / split_) < kRough)
        asked = sky_->cell(towards);
    }
    sum *= weights_[static_cast<size_t>(block_at(asked))];
  }
  for (size_t i = 0; i < sky_->suns().size(); ++i)
    if (const Sky::Sun& sun = sky_->suns()[i]; holds(sun, towards))
      sum += luminance(sun.radiance) * weight(static_cast<size_t>(blocks()) + i);
  return sum / total_;
}

}  // namespace tdpt
