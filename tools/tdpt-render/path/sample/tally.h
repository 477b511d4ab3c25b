// Counts of samples besides the film: integers, so that the order of threads cannot matter.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "libcommon/film/fixed_sum.h"
#include "tools/tdpt-render/path/sample/mixture.h"

namespace tdpt {

struct RayCounts {
  uint64_t closest = 0;  ///< first-hit rays
  uint64_t shadow = 0;   ///< visibility tests
  uint64_t portal = 0;   ///< edges tested against the portals
  uint64_t connect = 0;  ///< pairs of ends considered for a connection

  void merge(const RayCounts& other) {
    closest += other.closest;
    shadow += other.shadow;
    portal += other.portal;
    connect += other.connect;
  }
};

struct Tally {
  /// `unit`: of energies, a power of two [Film::unit].
  explicit Tally(double unit = 0x1p-64) : unit_(unit) {
    energy.fill(UnitSum(unit));
    by_length.fill(UnitSum(unit));
  }

  RayCounts rays;
  std::array<UnitSum, kTechniques> energy;  ///< sum of luminance per technique
  /// The same by path length: [i] for paths of more than 2^(i-1) and up to 2^i edges.
  static constexpr size_t kOctaves = 11;
  std::array<UnitSum, kOctaves> by_length;
  /// Counts of the segments drawn through one portal.
  struct OfPortal {
    uint64_t drawn = 0, lit = 0;  ///< lit: those that connected a light with the camera
    UnitSum energy;               ///< sum of luminance of their contributions
  };
  std::vector<OfPortal> portals;  ///< one for each portal; empty: no segment was drawn
  uint64_t not_finite = 0;        ///< contributions left out
  struct SamplePixel {
    uint64_t sample;
    int y, x;
    friend auto operator<=>(const SamplePixel&, const SamplePixel&) = default;
  };
  static constexpr size_t kMostPlaces = 4;
  std::vector<SamplePixel> not_finite_at;  ///< the first few, in order

  void begin_portals(size_t n) {
    if (portals.empty()) portals.resize(n, {0, 0, UnitSum(unit_)});
  }
  void count_length(int edges, double luminance) {
    by_length[std::bit_width(static_cast<unsigned>(edges) - 1)].add(luminance);
  }
  void leave_out(const SamplePixel& place);
  void merge(const Tally& other);

 private:
  double unit_;
};

}  // namespace tdpt
