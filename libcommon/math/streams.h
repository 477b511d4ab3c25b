// Which random stream each part of a program uses [rng.h, sequence.h]. All streams are listed here,
// and a static assertion checks that no two users of one seed share one. (Rounding of a film's sums
// needs none: it uses a hash of seed, pixel and sample.)
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace tdpt {

/// `count` streams from `first` on, for any seed or for one only.
struct Streams {
  uint64_t first, count;
  std::optional<uint64_t> seed{};
};

constexpr bool disjoint(const Streams& a, const Streams& b) {
  if (a.seed && b.seed && *a.seed != *b.seed) return true;
  return a.first + a.count <= b.first || b.first + b.count <= a.first;
}
/// Pairwise.
template <size_t n>
constexpr bool disjoint(const std::array<Streams, n>& all) {
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < i; ++j)
      if (!disjoint(all[i], all[j])) return false;
  return true;
}

// Each integrator has sixteen streams in each round, one per purpose of a sample. Other users are
// placed beside them.

constexpr uint64_t kPurposes = 16;
/// Integrators, below kStreams: first the rows of the table, then what else `auto` tries.
namespace stream {
enum Integrator : uint64_t {
  pt = 1,
  nee,
  bdpt,
  tdpt_org,
  tdpt,
  tdpt_guided,
  nee_guided_to_windows,
  bdpt_with_few_light_walks
};
}  // namespace stream
constexpr uint64_t kStreams = 256;
constexpr uint64_t kStreamsOfRound = 1024;

/// Rounds from `first` on, whose samples are independent.
struct Rounds {
  uint64_t first, count = 1;
};
constexpr Rounds kPictureRound{0}, kPilotRound{1}, kErrorPilotRounds{3, 8}, kTimingRound{11};

/// Stream of an integrator's samples, before multiplication by kPurposes.
constexpr uint64_t stream_in(uint64_t round, uint64_t integrator) {
  return integrator + kStreamsOfRound * round;
}
constexpr Streams streams_of(const Rounds& rounds) {
  const uint64_t first = stream_in(rounds.first, 1);
  return {first * kPurposes,
          (stream_in(rounds.first + rounds.count - 1, kStreams) - first) * kPurposes};
}

/// Takes the place of an integrator.
constexpr uint64_t kExplorationStream = 1023;
constexpr Streams kExploration{kExplorationStream * kPurposes, kPurposes},
    kFeaturePlaces{kStreamsOfRound * kPurposes + 15, 1},  // of places in pixels
    kPortalProbe{0x9000, 2, 1},  // of walks from a portal, to the light and to the camera
    kWindowViews{0, 1, 1}, kExpectedWalks{0, 1, 0},
    kCoveredLamps{uint64_t{1} << 32, uint64_t{1} << 32};  // of each triangle

static_assert(disjoint(std::array{streams_of(kPictureRound), streams_of(kPilotRound),
                                  streams_of(kErrorPilotRounds), streams_of(kTimingRound),
                                  kExploration, kFeaturePlaces, kPortalProbe, kWindowViews,
                                  kExpectedWalks, kCoveredLamps}));

// ffgraph.
constexpr Streams kWalksFromLight{101, 1}, kWalksFromCamera{102, 1}, kEtendue{103, 1},
    kTriangleFlow{104, 1};
static_assert(disjoint(std::array{kWalksFromLight, kWalksFromCamera, kEtendue, kTriangleFlow}));

// lightgrid: each of these has 256 streams, one for each cut c. A line has a stream of its own, two
// for the votes at its ends and one for coverage [shaders/shared/light_lines.h]. Chains of cut c
// use the streams whose upper word is c.
constexpr Streams kPivotLines{1 << 16, 0x400}, kTriedLines{2 << 16, 0x400},
    kChains{0x6c67'0002, uint64_t{1} << 40};
static_assert(disjoint(std::array{kPivotLines, kTriedLines, kChains}));

}  // namespace tdpt
