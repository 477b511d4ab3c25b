// The picture is cut into tiles. A tile copies what its windows reach, computes the distances d^2
// of all its pixels at each offset of the window, and then, for a few pixels at a time, sums the
// normal equations in registers and solves them.

#include "libcommon/denoise/regression.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>

namespace tdpt::denoise {
namespace {

constexpr float kRidge = 1e-4f;  // for features in [-1,1], of the sum of weights
constexpr float kNever = 1e30f;  // distance to pixels outside the picture

constexpr int kWidth = 32, kHeight = 16;  // of a tile
constexpr int kLanes = 4;                 // pixels at a time
constexpr int kSide = 2 * kReach + 1, kOffsets = kSide * kSide;
constexpr int kColumns = kWidth + 2 * kReach, kRows = kHeight + 2 * kReach;
constexpr int kTerms = static_cast<int>(kFeatures) + 1;  // of the linear model
constexpr int kMargin = kReach + kMostPatch;
constexpr int kGuideColumns = kWidth + 2 * kMargin, kGuideRows = kHeight + 2 * kMargin;

constexpr int kArea = kRows * kColumns;
constexpr int kOwn = kOffsets / 2;  // the offset of a pixel to itself
constexpr float kLeastOwn = 1e-6f;  // its weight where no other is alike

// What distances are made of.
struct GuideTile {
  float guide[3][kGuideRows][kGuideColumns], variance[3][kGuideRows][kGuideColumns],
      tolerance[3][kGuideRows][kGuideColumns];
};

struct Tile {
  int x, y;    // of its top left pixel
  int frames;  // planes of frames follow each other
  float colour[3][kMostSources * kArea], features[kFeatures][kMostSources * kArea];
  GuideTile guides[kMostSources];
  float present[kArea];
  float distance[kMostSources * kOffsets][kHeight][kWidth];
};

// Copies the part of a plane that begins `margin` pixels above and left of the tile; pixels outside
// the picture are those at its border.
void copy(const Plane& from, Size size, const Tile& tile, int margin, float* to) {
  const int rows = kHeight + 2 * margin, columns = kWidth + 2 * margin;
  for (int y = 0; y < rows; ++y) {
    const int row = std::clamp(tile.y + y - margin, 0, size.height - 1);
    const float* source = from.data() + size.index(0, row);
    for (int x = 0; x < columns; ++x)
      *to++ = source[std::clamp(tile.x + x - margin, 0, size.width - 1)];
  }
}

// Distances of all pixels of the tile to those of another frame, or the same, at one offset.
void measure(const Tile& tile, const GuideTile& other, Patches patches, Size size, int dx, int dy,
             float (&distance)[kHeight][kWidth]) {
  const GuideTile& own = tile.guides[0];
  const int patch = patches.radius, columns = kWidth + 2 * patch, rows = kHeight + 2 * patch;
  constexpr int kMostColumns = kWidth + 2 * kMostPatch, kMostRows = kHeight + 2 * kMostPatch;
  float raw[kMostRows][kMostColumns], sums[kMostRows][kWidth];
  const int first = kMargin - patch;
  for (int y = 0; y < rows; ++y) {
    float* to = raw[y];
    for (int x = 0; x < columns; ++x) to[x] = 0;
    for (int c = 0; c < 3; ++c) {
      const float* gp = &own.guide[c][first + y][first];
      const float* gq = &other.guide[c][first + y + dy][first + dx];
      const float* vp = &own.variance[c][first + y][first];
      const float* vq = &other.variance[c][first + y + dy][first + dx];
      const float* tp = &own.tolerance[c][first + y][first];
      const float* tq = &other.tolerance[c][first + y + dy][first + dx];
      for (int x = 0; x < columns; ++x) {
        const float d = gp[x] - gq[x];
        to[x] +=
            (d * d - vp[x] - std::min(vp[x], vq[x])) / (patches.least_tolerance + tp[x] + tq[x]);
      }
    }
  }
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < kWidth; ++x) {
      float sum = 0;
      for (int k = 0; k <= 2 * patch; ++k) sum += raw[y][x + k];
      sums[y][x] = sum;
    }
  const auto side = static_cast<float>(2 * patch + 1);
  const float share = 1 / (3 * side * side);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      float sum = 0;
      for (int k = 0; k <= 2 * patch; ++k) sum += sums[y + k][x];
      const int qx = tile.x + x + dx, qy = tile.y + y + dy;
      const bool inside = qx >= 0 && qy >= 0 && qx < size.width && qy < size.height &&
                          tile.present[(y + dy + kReach) * kColumns + x + dx + kReach] > 0;
      distance[y][x] = inside ? std::max(sum * share, 0.0f) : kNever;
    }
}

// exp(-e) nearly, and 0 from e = 8 on.
float weight_of(float e) {
  const float root = std::max(0.0f, 1 - e * 0.125f);
  const float second = root * root, fourth = second * second;
  return fourth * fourth;
}

// Neighbours count less with distance, by a Gaussian of this deviation [pixels]: cut off at once
// they would leave a weave along the axes.
constexpr float kNear = 4;
const std::array<float, kOffsets> kNearness = [] {
  std::array<float, kOffsets> all{};
  for (int o = 0; o < kOffsets; ++o) {
    const auto x = static_cast<float>(o % kSide - kReach),
               y = static_cast<float>(o / kSide - kReach);
    all[static_cast<size_t>(o)] = std::exp(-(x * x + y * y) / (2 * kNear * kNear));
  }
  return all;
}();

// Weights of the neighbours of kLanes pixels, as far as any of them is above 0.
struct Weights {
  int count = 0;
  int place[kMostSources * kOffsets];  ///< of the first pixel's neighbour, in the tile's planes
  float of[kMostSources * kOffsets][kLanes];
};

// Tells the pixels' weights: their own is that of the neighbour that is most alike, so that one
// that looks like no other does not keep its noise.
void weigh(const Tile& tile, int x, int y, float bandwidth, Weights& weights) {
  weights.count = 0;
  const float per = 1 / (bandwidth * bandwidth);
  float most_other[kLanes] = {};
  const auto add = [&](int o, float(&w)[kLanes]) {
    const int frame = o / kOffsets, offset = o % kOffsets;
    weights.place[weights.count] =
        frame * kArea + (y + offset / kSide) * kColumns + x + offset % kSide;
    weights.count += *std::max_element(w, w + kLanes) > 0;
  };
  for (int o = 0; o < tile.frames * kOffsets; ++o) {
    if (o == kOwn) continue;
    float(&w)[kLanes] = weights.of[weights.count];
    for (int i = 0; i < kLanes; ++i) {
      w[i] = weight_of(tile.distance[o][y][x + i] * per);
      most_other[i] = std::max(most_other[i], w[i]);
      w[i] *= kNearness[static_cast<size_t>(o % kOffsets)];
    }
    add(o, w);
  }
  float(&own)[kLanes] = weights.of[weights.count];
  for (int i = 0; i < kLanes; ++i) own[i] = std::max(most_other[i], kLeastOwn);
  add(kOwn, own);
}

// Sums over the window, for kLanes pixels: of w f_r f_s (s <= r, f_0 = 1) and of w f_r c.
struct Sums {
  float moments[kTerms][kTerms][kLanes], colours[kTerms][3][kLanes];
};

// Those for one r.
template <int r>
void sum_row(const Tile& tile, const Weights& weights, Sums& sums) {
  float moments[r + 1][kLanes] = {}, colours[3][kLanes] = {};
  for (int o = 0; o < weights.count; ++o) {
    const int place = weights.place[o];
    float u[kLanes];
    for (int i = 0; i < kLanes; ++i) {
      u[i] = weights.of[o][i];
      if constexpr (r > 0) u[i] *= tile.features[r - 1][place + i];
    }
    for (int i = 0; i < kLanes; ++i) moments[0][i] += u[i];
    for (int s = 1; s <= r; ++s)
      for (int i = 0; i < kLanes; ++i) moments[s][i] += u[i] * tile.features[s - 1][place + i];
    for (int c = 0; c < 3; ++c)
      for (int i = 0; i < kLanes; ++i) colours[c][i] += u[i] * tile.colour[c][place + i];
  }
  for (int i = 0; i < kLanes; ++i) {
    for (int s = 0; s <= r; ++s) sums.moments[r][s][i] = moments[s][i];
    for (int c = 0; c < 3; ++c) sums.colours[r][c][i] = colours[c][i];
  }
}

template <int... r>
void sum_rows(std::integer_sequence<int, r...>, const Tile& tile, const Weights& weights,
              Sums& sums) {
  (sum_row<r>(tile, weights, sums), ...);
}

// Solves the normal equations by Cholesky's method: the constant term of each channel.
void solve(const Sums& sums, int lane, const double (&f)[kTerms], std::array<float, 3>& constants) {
  const auto moment = [&](int r, int s) {
    return static_cast<double>(sums.moments[std::max(r, s)][std::min(r, s)][lane]);
  };
  double l[kTerms][kTerms];
  const double all = moment(0, 0);
  if (!(all > 0)) {
    constants = {};
    return;
  }
  for (int r = 0; r < kTerms; ++r)
    for (int s = 0; s <= r; ++s) {
      double v = moment(r, s);
      // Relative to the features of the pixel.
      if (r > 0) v -= f[r] * moment(0, s);
      if (s > 0) v -= f[s] * (moment(r, 0) - f[r] * all);
      if (r > 0 && r == s) v = std::max(v, 0.0) + static_cast<double>(kRidge) * all;
      for (int u = 0; u < s; ++u) v -= l[r][u] * l[s][u];
      l[r][s] =
          r == s ? std::sqrt(std::max(v, 1e-3 * static_cast<double>(kRidge) * all)) : v / l[s][s];
    }
  for (int c = 0; c < 3; ++c) {
    double z[kTerms];
    const auto mean = static_cast<double>(sums.colours[0][c][lane]);
    for (int r = 0; r < kTerms; ++r) {
      double v = static_cast<double>(sums.colours[r][c][lane]) - (r > 0 ? f[r] * mean : 0);
      for (int u = 0; u < r; ++u) v -= l[r][u] * z[u];
      z[r] = v / l[r][r];
    }
    for (int r = kTerms - 1; r >= 0; --r) {
      for (int u = r + 1; u < kTerms; ++u) z[r] -= l[u][r] * z[u];
      z[r] /= l[r][r];
    }
    constants[static_cast<size_t>(c)] = static_cast<float>(std::max(z[0], 0.0));
  }
}

// Estimates the pixels x .. x + kLanes - 1 of row y of the tile, as far as they are in the picture.
void estimate(const Tile& tile, Size size, int x, int y, float bandwidth, Colour& to) {
  Weights weights;
  weigh(tile, x, y, bandwidth, weights);
  Sums sums;
  sum_rows(std::make_integer_sequence<int, kTerms>(), tile, weights, sums);
  for (int i = 0; i < kLanes && tile.x + x + i < size.width; ++i) {
    double f[kTerms] = {1};
    for (int r = 1; r < kTerms; ++r)
      f[r] = static_cast<double>(tile.features[r - 1][(y + kReach) * kColumns + x + kReach + i]);
    std::array<float, 3> constants;
    solve(sums, i, f, constants);
    const size_t pixel = size.index(tile.x + x + i, tile.y + y);
    for (size_t c = 0; c < 3; ++c) to[c][pixel] = constants[c];
  }
}

// Copies what the tile's windows reach in a frame, and measures its distances.
void add(const Source& from, Size size, Patches patches, Tile& tile) {
  const int frame = tile.frames++;
  GuideTile& planes = tile.guides[frame];
  for (size_t c = 0; c < 3; ++c) {
    copy(from.data[c], size, tile, kReach, tile.colour[c] + frame * kArea);
    copy(from.guide[c], size, tile, kMargin, planes.guide[c][0]);
    copy(from.variance[c], size, tile, kMargin, planes.variance[c][0]);
    copy(from.tolerance[c], size, tile, kMargin, planes.tolerance[c][0]);
  }
  for (size_t f = 0; f < kFeatures; ++f)
    copy(from.features[f], size, tile, kReach, tile.features[f] + frame * kArea);
  if (from.present.empty())
    std::fill(std::begin(tile.present), std::end(tile.present), 1.0f);
  else
    copy(from.present, size, tile, kReach, tile.present);
  for (int o = 0; o < kOffsets; ++o)
    measure(tile, planes, patches, size, o % kSide - kReach, o / kSide - kReach,
            tile.distance[frame * kOffsets + o]);
}

}  // namespace

std::vector<Colour> regressions(Size size, std::span<const Source> sources, Patches patches,
                                std::span<const float> bandwidths) {
  std::vector<Colour> estimates(bandwidths.size());
  for (Colour& estimate : estimates) estimate.fill(Plane(size.pixels()));
  const int across = (size.width + kWidth - 1) / kWidth;
  const int down = (size.height + kHeight - 1) / kHeight;
  tbb::parallel_for(0, across * down, [&](int number) {
    const std::unique_ptr<Tile> tile(new Tile);  // not initialised
    tile->x = number % across * kWidth;
    tile->y = number / across * kHeight;
    tile->frames = 0;
    for (const Source& source : sources) add(source, size, patches, *tile);
    for (size_t k = 0; k < bandwidths.size(); ++k)
      for (int y = 0; y < std::min(kHeight, size.height - tile->y); ++y)
        for (int x = 0; x < kWidth && tile->x + x < size.width; x += kLanes)
          estimate(*tile, size, x, y, bandwidths[k], estimates[k]);
  });
  return estimates;
}

}  // namespace tdpt::denoise
