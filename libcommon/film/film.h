// Frame buffer of exact sums of samples. They are fixed-point integers, so a film does not depend
// on the order of threads, and films of different samples of one picture merge to the bytes of the
// undivided one [film_file.h].
//
// The unit of the sums is 2^-64 of the power of all lights together, rounded up to a power of two
// (as a number: the sums are of radiance). Light walks start in proportion to power, so every walk
// carries about that power however small or faint its light; with 64 bits below it, a room a
// billion times darker still has ten digits. One contribution may be up to 2^46 times that power,
// as where light is scattered next to the camera.
#pragma once
#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "libcommon/film/fixed_sum.h"
#include "libcommon/formats/picture.h"

namespace tdpt {

/// Samples first .. first + count - 1 of every pixel.
struct SampleRange {
  uint64_t first = 0, count = 0;
  uint64_t end() const { return first + count; }
  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

/// Layers of a picture with the means of its samples with even and with odd numbers.
inline constexpr std::array kHalves{"halfA", "halfB"};

class Film {
 public:
  static constexpr size_t kMostLayers = 8, kOddPlane = 1 + kMostLayers;

  struct Options {
    /// Names of the layers. A layer accumulates a part of the light separately, at the cost of
    /// another film; a layer with an empty name is not kept. Layers do not affect the picture. At
    /// most kMostLayers.
    std::vector<std::string> layers{};
    bool alpha = false;   ///< keep what alpha() needs
    bool halves = false;  ///< keep what half() and variance() need
    /// Memory of a pixel's sums.
    size_t bytes_of_pixel() const;
    friend bool operator==(const Options&, const Options&) = default;
  };

  /// `power`: of all lights together [Lights::power].
  Film(int width, int height, double power, Options options);
  Film(int width, int height, double power) : Film(width, height, power, Options()) {}

  /// 2^64 times the unit.
  static double power_of_two(double power);
  int width() const { return width_; }
  int height() const { return height_; }
  double unit() const { return unit_; }
  const Options& options() const { return options_; }

  // Adds radiance [W/m2/sr] of a sample to a pixel. Thread-safe; `coin`: 64 random bits of its own;
  // `sample`: its number. False if it cannot be represented: then it is left out, or the sum has
  // wrapped round.
  bool add(int x, int y, const Vec3d& radiance, uint64_t coin, uint64_t sample) {
    Plane& odd = planes_[kOddPlane];
    return add(planes_[0], x, y, radiance, coin) &&
           (!odd || sample % 2 == 0 || add(odd, x, y, radiance, coin));
  }
  /// Adds the part of it that belongs to one layer; ignored if the layer is not kept.
  bool add_to_layer(size_t layer, int x, int y, const Vec3d& radiance, uint64_t coin) {
    Plane& plane = planes_[1 + layer];
    return !plane || add(plane, x, y, radiance, coin);
  }

  bool has_alpha() const { return options_.alpha; }
  /// The camera ray of a sample of this pixel hits something. Thread-safe.
  void meet(int x, int y) { met_[index(x, y)].fetch_add(1, std::memory_order_relaxed); }

  /// Adds sums made elsewhere in this film's unit: sum i, three per pixel, of the picture (plane
  /// 0), of layer plane - 1, or of the samples with odd numbers (kOddPlane), and the number of each
  /// pixel's samples that hit something, as far as they are kept. Throws std::overflow_error if a
  /// sum wraps round.
  void add_sums(const std::function<Units(size_t plane, size_t i)>& sum,
                const std::function<uint64_t(size_t pixel)>& met);
  /// All contributions of a range of samples have been added.
  void complete(const SampleRange& range);
  /// In order; adjacent ranges are merged.
  const std::vector<SampleRange>& ranges() const { return ranges_; }
  uint64_t samples() const;

  /// Adds the samples of another film. Throws std::invalid_argument if size, unit or options differ
  /// or if both hold the same samples, and std::overflow_error if a sum wraps round: then
  /// neither film is usable.
  void merge(const Film& other);
  /// Back to the state after construction.
  void clear();

  /// Sum over the samples of each pixel, row by row.
  std::vector<Vec3d> sums() const { return sums(planes_[0]); }
  /// For every `step`-th pixel.
  std::vector<Vec3d> sums(size_t step) const;
  std::vector<Vec3d> layer_sums(size_t layer) const { return sums(planes_[1 + layer]); }
  bool has_layer(size_t layer) const { return planes_[1 + layer] != nullptr; }
  /// Mean over the samples; black without samples.
  Picture picture() const;
  Picture layer(size_t layer) const;
  /// Share of each pixel's samples that hit something; empty if it is not kept.
  std::vector<float> alpha() const;
  /// Number of samples with even (0) or odd (1) numbers.
  uint64_t samples_of_half(uint64_t half) const;
  bool has_both_halves() const { return samples_of_half(0) > 0 && samples_of_half(1) > 0; }
  /// Mean over the samples with even (0) or odd (1) numbers, which are independent of each other in
  /// a rendering; black without any, or if halves are not kept.
  Picture half(uint64_t half) const;
  /// Variance of each pixel's mean luminance, from the difference of the halves; the mean over 5 x
  /// 5 pixels, because a single difference is as uncertain as it is large. 0 if a half has no
  /// samples.
  std::vector<double> variance() const;

  /// All sums, as they lie in memory, to be saved in a file and restored; while no thread adds. Per
  /// pixel `each` consecutive numbers of 128 bits (Units) or of 64.
  struct Numbers {
    std::string name;  ///< "" for the picture, a layer's name, "odd" or "met"
    unsigned char* first;
    size_t each, bytes;  ///< numbers per pixel, bytes per number
  };
  std::vector<Numbers> numbers();
  /// Sets the ranges of the restored samples, as ranges() returned them. Throws
  /// std::invalid_argument if they are out of order, empty or overlapping.
  void restore(const std::vector<SampleRange>& ranges);

 private:
  using Plane = std::unique_ptr<FixedSum[]>;  // three per pixel; null: not kept

  size_t pixels() const { return static_cast<size_t>(width_) * static_cast<size_t>(height_); }
  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  bool keeps(size_t plane) const;
  bool add(Plane& plane, int x, int y, const Vec3d& radiance, uint64_t coin);
  Vec3d sum(const Plane& plane, size_t pixel) const;
  Picture mean(const Plane& plane) const;
  Vec3d sum_of_half(uint64_t half, size_t pixel) const;
  std::vector<Vec3d> sums(const Plane& plane) const;

  int width_, height_;
  double unit_, per_unit_;
  Options options_;
  std::array<Plane, 1 + kOddPlane> planes_;       // the picture, its layers, odd samples
  std::unique_ptr<std::atomic<uint64_t>[]> met_;  // number of samples per pixel; null: not kept
  std::vector<SampleRange> ranges_;
};

/// `sums` times `factor`: the mean for 1 / number of samples.
Picture scaled_picture(int width, int height, const std::vector<Vec3d>& sums, double factor);

}  // namespace tdpt
