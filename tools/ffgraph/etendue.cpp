#include "tools/ffgraph/etendue.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include "libcommon/math/discrete.h"
#include "libcommon/math/streams.h"
#include "libcommon/scene/sky_bins.h"

namespace tdpt {
namespace {

// Clips triangles to the cells of the patches.
//
// Method: polygon clipping (Sutherland-Hodgman) against the six faces of a cell, recursively in a
// tree of 4 x 4 x 4 cells where cells are split. Coordinates are in base cells from the origin of
// the grid, so cell bounds are exact.

// A triangle clipped by six planes has at most nine corners.
struct Polygon {
  int n = 0;
  std::array<Vec3d, 10> p;
  void push(const Vec3d& v) {
    if (n < 10) p[static_cast<size_t>(n++)] = v;
  }
  const Vec3d& operator[](int i) const { return p[static_cast<size_t>(i)]; }
};

// Keeps the part where sign * (v[axis] - bound) >= 0.
void keep_half(Polygon& poly, int axis, double bound, double sign) {
  bool whole = true;
  for (int i = 0; i < poly.n; ++i) whole = whole && sign * (poly[i][axis] - bound) >= 0;
  if (whole) return;
  Polygon out;
  for (int i = 0; i < poly.n; ++i) {
    const Vec3d &a = poly[i], &b = poly[(i + 1) % poly.n];
    const double da = sign * (a[axis] - bound), db = sign * (b[axis] - bound);
    if (da >= 0) out.push(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
      Vec3d v = a + (b - a) * (da / (da - db));
      v[axis] = bound;
      out.push(v);
    }
  }
  poly = out;
}

Polygon clip(Polygon poly, const std::array<int32_t, 3>& cell, double size) {
  for (int axis = 0; axis < 3 && poly.n > 0; ++axis) {
    const double low = cell[static_cast<size_t>(axis)] * size;
    keep_half(poly, axis, low, 1);
    keep_half(poly, axis, low + size, -1);
  }
  return poly;
}

// Twice the area, and six times the area times the centroid.
double measure(const Polygon& poly, Vec3d& moment) {
  double twice = 0;
  for (int i = 1; i + 1 < poly.n; ++i) {
    const double a = length(cross(poly[i] - poly[0], poly[i + 1] - poly[0]));
    twice += a;
    moment += (poly[0] + poly[i] + poly[i + 1]) * a;
  }
  return twice;
}

double cell_size(int level) {
  return std::ldexp(1.0, -2 * level);
}

Polygon in_grid(const PatchMap& patches, uint32_t triangle) {
  const Scene& scene = patches.scene();
  Polygon poly;
  for (int k = 0; k < 3; ++k)
    poly.push((scene.frame.to_metres(Vec3d(scene.vertex(triangle, k))) - patches.grid().origin) /
              patches.grid().base_cell);
  return poly;
}

}  // namespace

// Fragments of some faces, and the patches missing below split cells.
struct Fragments::Part {
  struct Missing {
    size_t fragment;
    PatchKey key;
  };
  std::vector<Fragment> fragments;
  std::vector<Missing> missing;
};

struct Fragments::Walker {
  const PatchMap& patches;
  Part& out;
  uint32_t face;
  bool grow;  // whether to collect missing patches below split cells
  const PatchMap::Extent& extent;

  void visit(const Polygon& poly, int level) {
    const double size = cell_size(level);
    Vec3d low(1e300), high(-1e300);
    for (int i = 0; i < poly.n; ++i) low = min(low, poly[i]), high = max(high, poly[i]);
    std::array<int32_t, 3> a, b;
    for (int k = 0; k < 3; ++k) {
      a[static_cast<size_t>(k)] = static_cast<int32_t>(std::floor(low[k] / size));
      b[static_cast<size_t>(k)] = static_cast<int32_t>(std::floor(high[k] / size));
    }
    PatchKey key{a, level, patches.piece(face)};
    if (a == b) return cell(poly, key);
    if (level == 0)  // a large triangle may overlap countless cells besides the few that matter
      for (size_t k = 0; k < 3; ++k) {
        a[k] = std::max(a[k], extent.low[k]);
        b[k] = std::min(b[k], extent.high[k]);
      }
    for (key.cell[0] = a[0]; key.cell[0] <= b[0]; ++key.cell[0])
      for (key.cell[1] = a[1]; key.cell[1] <= b[1]; ++key.cell[1])
        for (key.cell[2] = a[2]; key.cell[2] <= b[2]; ++key.cell[2]) {
          if (patches.lookup(key) == kNoPatch && !grows(key)) continue;
          cell(clip(poly, key.cell, size), key);
        }
  }

  bool grows(const PatchKey& key) const { return grow && patches.below_split(key); }

  void cell(const Polygon& poly, const PatchKey& key) {
    if (poly.n < 3) return;
    const uint32_t id = patches.lookup(key);
    if (id == PatchMap::kSplit) return visit(poly, key.level + 1);
    Vec3d moment;
    const double twice = measure(poly, moment);
    if (!(twice > 1e-12)) return;
    if (id == kNoPatch && !grows(key)) return;
    if (id == kNoPatch) out.missing.push_back({out.fragments.size(), key});
    const PatchGrid& grid = patches.grid();
    const Frame& frame = patches.scene().frame;
    const double unit = grid.base_cell * frame.scale;
    out.fragments.push_back(
        {id, face, 0.5 * twice * unit * unit,
         frame.to_canonical(moment / (3 * twice) * grid.base_cell + grid.origin)});
  }
};

Fragments::Fragments(const PatchMap& patches, PatchMap* grow) : patches_(patches) {
  constexpr uint32_t kFaces = 4096;  // per part
  const auto faces = static_cast<uint32_t>(2 * patches.scene().triangles.size());
  std::vector<Part> parts(faces / kFaces + 1);
  const PatchMap::Extent extent = patches.extent();
  tbb::parallel_for(size_t{0}, parts.size(), [&](size_t p) {
    const auto first = static_cast<uint32_t>(p) * kFaces;
    for (uint32_t face = first; face < std::min(first + kFaces, faces); ++face)
      if (patches.touched(patches.piece(face)))
        Walker{patches, parts[p], face, grow != nullptr, extent}.visit(in_grid(patches, face / 2),
                                                                       0);
  });
  for (Part& part : parts)
    for (const Part::Missing& m : part.missing) part.fragments[m.fragment].patch = grow->add(m.key);

  // Sorted by patch; within a patch they are already in the order of faces.
  std::vector<size_t> next(patches.size() + 1, 0);
  for (const Part& part : parts)
    for (const Fragment& f : part.fragments) ++next[f.patch + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  fragments_.resize(next.back());
  for (const Part& part : parts)
    for (const Fragment& f : part.fragments) fragments_[next[f.patch]++] = f;
}

void Fragments::renumber(const std::vector<uint32_t>& numbers) {
  for (Fragment& f : fragments_) f.patch = numbers[f.patch];
}

Fragments::Point Fragments::sample(uint32_t f, Rng& rng) const {
  const double pick = rng.uniform();
  const double u = rng.uniform();
  const double v = rng.uniform();
  const Fragment& fragment = fragments_[f];
  const PatchKey& key = patches_.keys()[fragment.patch];
  const Polygon poly = clip(in_grid(patches_, fragment.face / 2), key.cell, cell_size(key.level));
  Vec3d moment;
  double rest = pick * measure(poly, moment);
  int corner = 1;
  for (; corner + 2 < poly.n; ++corner) {
    rest -= length(cross(poly[corner] - poly[0], poly[corner + 1] - poly[0]));
    if (rest < 0) break;
  }
  double b1, b2;
  uniform_triangle(u, v, b1, b2);
  const Vec3d q = poly[0] + (poly[corner] - poly[0]) * b1 + (poly[corner + 1] - poly[0]) * b2;
  const TriangleShape s = facing(patches_.scene(), fragment.face);
  const Vec3d p =
      patches_.scene().frame.to_canonical(q * patches_.grid().base_cell + patches_.grid().origin);
  // Projects back onto the triangle: the transform to the grid and back loses some last digits.
  return {fragment.patch, p - s.normal * dot(p - s.p0, s.normal), s.normal};
}

namespace {

constexpr int kDensestLevel = 2;

// `level`: relative to that of the fine region.
double density(int level) {
  return std::ldexp(1.0, 2 * std::min(level, kDensestLevel));
}

using Ends = std::pair<uint32_t, uint32_t>;  // smaller index first

void add_steps(const PatchMap& patches, const PatchTrace& walks, std::vector<double>& starts,
               std::vector<Ends>& rays) {
  const auto on_patch = [](uint32_t entry) { return entry < kTraceStopped; };
  for (size_t k = 0; k + 1 < walks.size(); ++k) {
    const uint32_t from = walks[k], to = walks[k + 1];
    if (!on_patch(from) || patches.is_sky(from) || to == kTraceStopped) continue;
    starts[from] += 1;
    if (on_patch(to) && to != from) rays.push_back(std::minmax(from, to));
  }
}

// Counts rays with equal ends. q: rays that start on a patch per sample.
std::vector<Etendue::Pair> pairs_of(std::vector<Ends>& rays, const std::vector<double>& q) {
  const auto key = [](const Ends& e) { return uint64_t{e.first} << 32 | e.second; };
  tbb::parallel_sort(rays.begin(), rays.end(),
                     [key](const Ends& a, const Ends& b) { return key(a) < key(b); });
  std::vector<Etendue::Pair> pairs;
  for (size_t k = 0; k < rays.size();) {
    size_t end = k;
    while (end < rays.size() && rays[end] == rays[k]) ++end;
    const auto [i, j] = rays[k];
    pairs.push_back({i, j, 2 * static_cast<double>(end - k) / (q[i] + q[j])});
    k = end;
  }
  return pairs;
}

}  // namespace

Etendue measure_etendue(const PatchMap& patches, const Fragments& fragments, const Tracer& tracer,
                        uint64_t seed, uint32_t rays, const std::vector<PatchTrace>& walks) {
  Etendue e;
  e.samples.assign(patches.size(), 0);
  if (fragments.all().empty()) return e;
  std::vector<double> weights, starts(patches.size(), 0);
  double total = 0;
  for (const Fragments::Fragment& f : fragments.all()) {
    weights.push_back(f.area * density(patches.keys()[f.patch].level - patches.fine_level()));
    total += weights.back();
  }
  size_t k = 0;
  for (const Fragments::Fragment& f : fragments.all()) {
    e.samples[f.patch] += rays * f.area / total;
    starts[f.patch] += rays * weights[k++] / total;
  }
  const AliasTable table(weights);

  std::vector<Ends> ray(rays, {kNoPatch, kNoPatch});
  tbb::parallel_for(uint32_t{0}, rays, [&](uint32_t n) {
    Rng rng(seed, kEtendue.first, n);
    const uint32_t fragment = table.sample(rng.uniform());
    const Fragments::Point from = fragments.sample(fragment, rng);
    const double u = rng.uniform();
    const double v = rng.uniform();
    const Vec3d w = Onb<double>(from.normal).to_world(cosine_hemisphere(u, v));
    Hit hit;
    const uint32_t to =
        tracer.closest({from.position, from.normal}, w, hit)
            ? patches.find(2 * hit.triangle + (dot(hit.normal, w) > 0 ? 1 : 0), hit.position)
        : patches.has_sky() && hit.triangle == ~0u ? patches.find_sky(sky_bin(w))
                                                   : kNoPatch;
    if (to != kNoPatch && to != from.patch) ray[n] = std::minmax(from.patch, to);
  });
  std::erase_if(ray, [](const Ends& r) { return r.first == kNoPatch; });
  for (const PatchTrace& trace : walks) add_steps(patches, trace, starts, ray);
  for (size_t i = 0; i < starts.size(); ++i)
    if (e.samples[i] > 0) starts[i] /= e.samples[i];
  e.pairs = pairs_of(ray, starts);
  // No ray starts in the sky; a bin's samples are half the sum of what it exchanges.
  for (const Etendue::Pair& p : e.pairs)
    for (const uint32_t end : {p.i, p.j})
      if (patches.is_sky(end)) e.samples[end] += 0.5 * p.count;
  return e;
}

}  // namespace tdpt
