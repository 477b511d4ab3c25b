// Where the samples of a picture add up: a frame buffer of exact sums. They are integers, so a film
// is the same whatever the order of threads, and films of different samples of one picture merge to
// the bytes of the undivided one [film_file.h].
//
// The unit of the sums is the number 2^-64 of the power of all lights together, rounded up to a
// power of two (radiance is summed: numbers alone are compared). Walks start in proportion to
// power, so every walk carries about that much however small or faint its light is; 64 bits below
// it a room a billion times darker still has ten digits. One contribution may be up to 2^46 times
// that power, as where light is scattered next to the camera.
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

class Film {
 public:
  static constexpr size_t kMostLayers = 8;

  struct Options {
    /// Names of the layers: each, of a part of the light, is kept apart as well, at the cost of
    /// another film; one without a name is not kept. The picture's sums are the same with and
    /// without. At most kMostLayers.
    std::vector<std::string> layers;
    /// Errors are known from the squares of what aligned blocks of so many samples add up to; 0:
    /// they are not kept.
    uint64_t error_block = 0;
    bool alpha = false;  ///< what is before the sky is known [alpha()]
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

  // Radiance [W/m2/sr] that a sample brings to a pixel. Any thread; `coin`: 64 random bits of its
  // own. False when it cannot be held: then it is left out, or the sum has wrapped round.
  bool add(int x, int y, const Vec3d& radiance, uint64_t coin) {
    return add(picture_, x, y, radiance, coin);
  }
  /// The part of it that one layer shows; nothing where that is not kept.
  bool add_to_layer(size_t layer, int x, int y, const Vec3d& radiance, uint64_t coin) {
    return !layers_[layer] || add(layers_[layer], x, y, radiance, coin);
  }

  bool has_alpha() const { return options_.alpha; }
  /// The camera ray of a sample of the pixel meets something. Any thread.
  void meet(int x, int y) {
    met_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)].fetch_add(
        1, std::memory_order_relaxed);
  }

  /// Adds what was summed elsewhere in this film's unit: sum i, three for each pixel, of the
  /// picture (plane 0) or of layer plane - 1, and the samples of each pixel that meet something,
  /// where that is kept. Throws std::overflow_error when a sum wraps round.
  void add_sums(const std::function<Units(size_t plane, size_t i)>& sum,
                const std::function<uint64_t(size_t pixel)>& met);
  /// All that the samples of a range brought is in. Where errors are kept it is a block, aligned,
  /// the only one that was added to since the last.
  void complete(const SampleRange& range);
  /// In order; neighbours are one.
  const std::vector<SampleRange>& ranges() const { return ranges_; }
  uint64_t samples() const;

  /// Adds the samples of another film. Throws std::invalid_argument when it differs in size, unit,
  /// layers or blocks, or holds samples that this one holds, and std::overflow_error when a sum
  /// wraps round: then neither film is of use.
  void merge(const Film& other);
  /// As it was made.
  void clear();

  /// Sum over its samples, pixel by pixel, row by row.
  std::vector<Vec3d> sums() const { return sums(picture_); }
  /// Of every `step`-th pixel.
  std::vector<Vec3d> sums(size_t step) const;
  std::vector<Vec3d> layer_sums(size_t layer) const { return sums(layers_[layer]); }
  bool has_layer(size_t layer) const { return layers_[layer] != nullptr; }
  /// The mean over its samples; black where there are none.
  Picture picture() const;
  Picture layer(size_t layer) const;
  /// Share of each pixel's samples that meet something; empty when it is not kept.
  std::vector<float> alpha() const;
  /// Variance of each pixel's mean luminance, over blocks; 0 for less than two, infinite where a
  /// blocks were too bright to tell.
  std::vector<double> variance() const;

  /// All that adds up, as it lies in memory, while no thread adds: what a file keeps and gives
  /// back. Of each pixel `each` numbers, of 128 bits as Units or of 64, one after the other.
  struct Numbers {
    std::string name;  ///< "", a layer's name, "squares" or "met"
    unsigned char* first;
    size_t each, bytes;  ///< numbers of a pixel, and bytes of a number
  };
  std::vector<Numbers> numbers();
  /// What was given back holds the samples of these ranges, as ranges() had them. Throws
  /// std::invalid_argument where they are not in order, empty, or not apart.
  void restore(const std::vector<SampleRange>& ranges);

 private:
  using Plane = std::unique_ptr<FixedSum[]>;  // three for each pixel; null: not kept

  size_t pixels() const { return static_cast<size_t>(width_) * static_cast<size_t>(height_); }
  bool add(Plane& plane, int x, int y, const Vec3d& radiance, uint64_t coin);
  Vec3d sum(const Plane& plane, size_t pixel) const;
  Picture mean(const Plane& plane) const;
  std::vector<Vec3d> sums(const Plane& plane) const;
  void add_range(const SampleRange& range);

  int width_, height_;
  double unit_, per_unit_, square_unit_;
  Options options_;
  Plane picture_;
  std::array<Plane, kMostLayers> layers_;
  std::unique_ptr<std::atomic<uint64_t>[]> met_;  // samples of each pixel; null: not kept
  std::vector<SampleRange> ranges_;
  // Of errors: sums before the block that is being added, and sums of squares of luminance.
  std::vector<Units> before_;
  Plane squares_;  // one for each pixel
};

/// The mean of `samples` samples whose sum is given, or any other multiple of it.
Picture scaled_picture(int width, int height, const std::vector<Vec3d>& sums, double factor);

}  // namespace tdpt
