#include "libcommon/film/film.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace tdpt {
namespace {

double luminance_of(const Vec3d& c) {
  return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

}  // namespace

size_t Film::Options::bytes_of_pixel() const {
  const auto kept = std::count_if(layers.begin(), layers.end(),
                                  [](const std::string& name) { return !name.empty(); });
  const size_t planes = 1 + static_cast<size_t>(kept) + (halves ? 1 : 0);
  return 3 * sizeof(FixedSum) * planes + (alpha ? sizeof(uint64_t) : 0);
}

double Film::power_of_two(double power) {
  return std::exp2(std::ceil(std::log2(power > 0 ? power : 1.0)));
}

Film::Film(int width, int height, double power, Options options)
    : width_(width),
      height_(height),
      unit_(power_of_two(power) * 0x1p-64),
      per_unit_(1 / unit_),
      options_(std::move(options)) {
  if (options_.layers.size() > kMostLayers) throw std::invalid_argument("too many layers");
  clear();
}

bool Film::keeps(size_t plane) const {
  if (plane == 0) return true;
  if (plane == kOddPlane) return options_.halves;
  return plane <= options_.layers.size() && !options_.layers[plane - 1].empty();
}

void Film::clear() {
  for (size_t p = 0; p < planes_.size(); ++p)
    if (keeps(p)) planes_[p] = std::make_unique<FixedSum[]>(3 * pixels());
  if (options_.alpha) met_ = std::make_unique<std::atomic<uint64_t>[]>(pixels());
  ranges_.clear();
}

bool Film::add(Plane& plane, int x, int y, const Vec3d& radiance, uint64_t coin) {
  std::array<Units, 3> units;
  for (size_t c = 0; c < 3; ++c)
    if (!to_units(radiance[static_cast<int>(c)], per_unit_,
                  std::rotl(coin, 21 * static_cast<int>(c)), units[c]))
      return false;
  FixedSum* sums = &plane[3 * index(x, y)];
  bool held = true;
  for (size_t c = 0; c < 3; ++c) held &= units[c] == 0 || sums[c].add(units[c]);
  return held;
}

Vec3d Film::sum(const Plane& plane, size_t pixel) const {
  const auto channel = [&](size_t c) { return from_units(plane[3 * pixel + c].units(), unit_); };
  return {channel(0), channel(1), channel(2)};
}

std::vector<Vec3d> Film::sums(const Plane& plane) const {
  std::vector<Vec3d> all(pixels());
  if (!plane) return all;
  for (size_t i = 0; i < pixels(); ++i) all[i] = sum(plane, i);
  return all;
}

std::vector<Vec3d> Film::sums(size_t step) const {
  std::vector<Vec3d> some;
  for (size_t i = 0; i < pixels(); i += step) some.push_back(sum(planes_[0], i));
  return some;
}

uint64_t Film::samples() const {
  uint64_t n = 0;
  for (const SampleRange& range : ranges_) n += range.count;
  return n;
}

void Film::complete(const SampleRange& range) {
  if (range.count == 0) return;
  const auto after = std::find_if(ranges_.begin(), ranges_.end(),
                                  [&](const SampleRange& r) { return r.end() > range.first; });
  if (after != ranges_.end() && after->first < range.end())
    throw std::invalid_argument("samples are in the film already");
  auto at = ranges_.insert(after, range);
  if (at + 1 != ranges_.end() && at->end() == (at + 1)->first) {
    at->count += (at + 1)->count;
    ranges_.erase(at + 1);
  }
  if (at != ranges_.begin() && (at - 1)->end() == at->first) {
    (at - 1)->count += at->count;
    ranges_.erase(at);
  }
}

void Film::add_sums(const std::function<Units(size_t plane, size_t i)>& sum,
                    const std::function<uint64_t(size_t pixel)>& met) {
  for (size_t p = 0; p < planes_.size(); ++p)
    for (size_t i = 0; planes_[p] && i < 3 * pixels(); ++i)
      if (const Units units = sum(p, i); units != 0 && !planes_[p][i].add(units))
        throw std::overflow_error("a sum has wrapped round");
  for (size_t i = 0; met_ && i < pixels(); ++i) met_[i] += met(i);
}

void Film::merge(const Film& other) {
  if (width_ != other.width_ || height_ != other.height_ || unit_ != other.unit_ ||
      options_ != other.options_)
    throw std::invalid_argument("films of different pictures");
  std::vector<SampleRange> ranges = ranges_;
  try {
    for (const SampleRange& range : other.ranges_) complete(range);
  } catch (const std::invalid_argument&) {
    ranges_ = std::move(ranges);
    throw;
  }
  add_sums([&](size_t plane, size_t i) { return other.planes_[plane][i].units(); },
           [&](size_t pixel) { return other.met_[pixel].load(); });
}

Picture Film::mean(const Plane& plane) const {
  return scaled_picture(width_, height_, sums(plane),
                        1 / static_cast<double>(std::max<uint64_t>(samples(), 1)));
}

Picture Film::picture() const {
  Picture picture = mean(planes_[0]);
  picture.alpha = alpha();
  return picture;
}

Picture Film::layer(size_t layer) const {
  return mean(planes_[1 + layer]);
}

std::vector<Film::Numbers> Film::numbers() {
  static_assert(sizeof(FixedSum) == sizeof(Units) && sizeof(met_[0]) == sizeof(uint64_t));
  std::vector<Numbers> all;
  const auto keep = [&](const std::string& name, auto* first, size_t each) {
    if (first) all.push_back({name, reinterpret_cast<unsigned char*>(first), each, sizeof *first});
  };
  for (size_t p = 0; p < planes_.size(); ++p)
    if (planes_[p])
      keep(p == 0 ? "" : p == kOddPlane ? "odd" : options_.layers[p - 1], planes_[p].get(), 3);
  keep("met", met_.get(), 1);
  return all;
}

void Film::restore(const std::vector<SampleRange>& ranges) {
  for (size_t i = 0; i < ranges.size(); ++i)
    if (ranges[i].count == 0 || ranges[i].end() < ranges[i].first ||
        (i > 0 && ranges[i].first <= ranges[i - 1].end()))
      throw std::invalid_argument("ranges that are not apart and in order");
  ranges_ = ranges;
}

std::vector<float> Film::alpha() const {
  std::vector<float> shares;
  const auto n = static_cast<double>(std::max<uint64_t>(samples(), 1));
  for (size_t i = 0; met_ && i < pixels(); ++i)
    shares.push_back(static_cast<float>(static_cast<double>(met_[i].load()) / n));
  return shares;
}

uint64_t Film::samples_of_half(uint64_t half) const {
  uint64_t n = 0;
  for (const SampleRange& r : ranges_) n += (r.end() + 1 - half) / 2 - (r.first + 1 - half) / 2;
  return n;
}

Vec3d Film::sum_of_half(uint64_t half, size_t pixel) const {
  const auto channel = [&](size_t c) {
    const Units odd = planes_[kOddPlane][3 * pixel + c].units();
    return from_units(half == 1 ? odd : planes_[0][3 * pixel + c].units() - odd, unit_);
  };
  return {channel(0), channel(1), channel(2)};
}

Picture Film::half(uint64_t half) const {
  std::vector<Vec3d> sums(pixels());
  for (size_t i = 0; planes_[kOddPlane] && i < pixels(); ++i) sums[i] = sum_of_half(half, i);
  return scaled_picture(width_, height_, sums,
                        1 / static_cast<double>(std::max<uint64_t>(samples_of_half(half), 1)));
}

// Half 0 has the mean A of a samples, half 1 the mean B of b. The halves are independent, so the
// expectation of (A - B)^2 a b / (a + b)^2 is the variance of the mean of all.
std::vector<double> Film::variance() const {
  std::vector<double> alone(pixels()), variance(pixels());
  const auto a = static_cast<double>(samples_of_half(0)),
             b = static_cast<double>(samples_of_half(1));
  if (!planes_[kOddPlane] || a == 0 || b == 0) return variance;
  for (size_t i = 0; i < pixels(); ++i) {
    const double difference =
        luminance_of(sum_of_half(0, i)) / a - luminance_of(sum_of_half(1, i)) / b;
    alone[i] = difference * difference * a * b / ((a + b) * (a + b));
  }
  constexpr int kReach = 2;
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      double sum = 0;
      int n = 0;
      for (int v = std::max(y - kReach, 0); v <= std::min(y + kReach, height_ - 1); ++v)
        for (int u = std::max(x - kReach, 0); u <= std::min(x + kReach, width_ - 1); ++u, ++n)
          sum += alone[index(u, v)];
      variance[index(x, y)] = sum / n;
    }
  return variance;
}

Picture scaled_picture(int width, int height, const std::vector<Vec3d>& sums, double factor) {
  Picture picture{width, height, {}};
  picture.pixels.reserve(sums.size());
  // Pictures must not contain infinities.
  constexpr double most = std::numeric_limits<float>::max();
  for (const Vec3d& sum : sums) {
    const Vec3d mean = sum * factor;
    picture.pixels.emplace_back(
        Vec3f(Vec3d(std::min(mean.x, most), std::min(mean.y, most), std::min(mean.z, most))));
  }
  return picture;
}

}  // namespace tdpt
