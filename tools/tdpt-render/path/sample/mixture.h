// Defines an integrator: a mixture of sampling techniques, how often each is run, how much its
// samples count, and how its walks are guided. All MIS weights follow from it and the heuristic,
// and so do the calls that make a sample.
//
// MIS sample weights. The balance heuristic treats the samples of a picture as independent. But
// each pixel gets the same number of camera walks, so their contributions have less noise than
// their density suggests, next events at z_1 above all, while splats are scattered at random. A
// mixture may therefore count next events as more than one sample: their densities weigh more, and
// the weights still sum to 1. Measured with tdpt-guided, 128 x 96 pixels: 6 at z_1 and 2 later
// raise the PSNR by 3 dB where lamps are seen directly (rooms with holes of 0.5 and 0.25 m), and
// change the relMSE by 0 to 4 %.
#pragma once
#include <array>
#include <cstdint>

namespace tdpt {

enum class Technique : uint8_t { camera, direct, light, bi, portal };
constexpr int kTechniques = 5;
constexpr std::array<const char*, kTechniques> kTechniqueNames{"camera", "direct", "light", "bi",
                                                               "portal"};

class TechniqueSet {
 public:
  template <class... T>
  constexpr explicit TechniqueSet(T... members)
      : bits_(static_cast<uint8_t>((0u | ... | (1u << static_cast<int>(members))))) {}
  constexpr bool has(Technique t) const { return (bits_ >> static_cast<int>(t)) & 1u; }
  /// Whether some technique needs a prefix walked from a light.
  constexpr bool walks_from_light() const {
    return has(Technique::light) || has(Technique::bi) || has(Technique::portal);
  }
  constexpr TechniqueSet operator|(const TechniqueSet& other) const {
    TechniqueSet all;
    all.bits_ = static_cast<uint8_t>(bits_ | other.bits_);
    return all;
  }
  /// Bit t for technique t.
  constexpr uint8_t bits() const { return bits_; }
  static constexpr TechniqueSet of_bits(uint8_t bits) {
    TechniqueSet set;
    set.bits_ = bits;
    return set;
  }
  friend constexpr bool operator==(const TechniqueSet&, const TechniqueSet&) = default;

 private:
  uint8_t bits_;
};

/// Path guiding by the portals (guide.h): the probability, below 1, that a vertex aims at a portal,
/// for walks from the light and from the camera.
struct Guiding {
  std::array<double, 2> chance{};
  friend constexpr bool operator==(const Guiding&, const Guiding&) = default;
};

/// Below 1. From 0.5 to 0.9 the errors of `nee` and `bdpt` in two rooms differed by no more than
/// noise.
inline constexpr double kThroughWindows = 0.75;

/// Lower limit of Mixture::light_walks.
inline constexpr double kFewestLightWalks = 1.0 / 16;

struct Mixture {
  TechniqueSet techniques;
  /// MIS sample weights of next events at z_1 and at later vertices.
  double first_direct = 1, later_direct = 1;
  double segments = 1;  ///< share of the samples that draw a portal segment, (0,1]
  Guiding guiding{};
  /// Of the next events that sample the sky: the share that aims through a portal, if there are any
  /// [next_event.h].
  double through_windows = kThroughWindows;

  /// Share of the samples that make a light walk. The others are connected with cached walks, and
  /// splats are weighted to count for all [light_vertex_cache.h].
  double light_walks = 1;

  /// Candidates that a vertex is connected with, per connectible vertex of an average light walk:
  /// without y_0, and with y_0 [light_vertex_cache.h, expecting_connections()]. 1: as many as one
  /// whole walk has.
  double connected = 1, connected_to_segments = 1;
  /// Number of camera walks whose vertices each segment is connected with.
  double segments_connected = 1;

  bool has(Technique t) const { return techniques.has(t); }
  bool looks_out() const { return has(Technique::direct) && through_windows > 0; }
  /// Expected number of samples of a strategy for paths of k edges per sample of the picture. All
  /// segments of a cache are connected with its camera vertices, but the camera itself sees only
  /// the segment of its own sample.
  constexpr double samples_of(Technique t, int split, int k) const {
    if (t == Technique::bi) return connected;
    if (t == Technique::light) return light_walks;
    if (t != Technique::portal) return 1;
    return segments * (split > 0 ? connected_to_segments : 1) *
           (sees_segment(split, k) ? 1 : segments_connected);
  }
  /// Whether the segment's end x_c is connected with the camera itself.
  static constexpr bool sees_segment(int split, int k) { return split == k - 2; }
  /// Factor of a strategy's density in the weights of paths of k edges: samples of it per sample of
  /// the picture, times its MIS sample weight.
  constexpr double sample_weight(Technique t, int split, int k) const {
    return t != Technique::direct ? samples_of(t, split, k) : k == 2 ? first_direct : later_direct;
  }
  friend constexpr bool operator==(const Mixture&, const Mixture&) = default;
};

}  // namespace tdpt
