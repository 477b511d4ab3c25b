// Builds a BVH top-down by binned SAH: each range of triangles is binned by the centres of its
// boxes on three axes, and split between two bins where (area of the left box) (triangles left) +
// (the same on the right) is minimal. The result does not depend on threads: minima, maxima and
// counts commute, large ranges are partitioned stably and small ones by one thread.
#include "libcommon/trace/bvh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include <array>
#include <bit>
#include <limits>
#include <memory>

#include "libcommon/base/error.h"
#include "libcommon/scene/scene.h"

namespace tdpt {
namespace {

using shader::BvhNode;
using shader::BvhTriangle;

constexpr uint32_t kLeafSize = 4;
constexpr uint32_t kMaxTriangles = 1u << 28;
constexpr uint32_t kParallelPass = 1u << 16;  // triangles of a range that several threads share
constexpr uint32_t kChunk = 1u << 14;         // triangles of such a range per thread
constexpr uint32_t kParallelTask = 1u << 11;  // triangles of a range that becomes a task of its own
constexpr uint32_t kMaxBins = 16;
constexpr float kNodeCost = 2.0f;  // cost of visiting a node, in triangle tests
constexpr float kPad = 0x1p-18f;   // see traversal.h

// SIMD vectors of GCC and clang, independent of the processor.
using Four = float __attribute__((vector_size(16)));
using FourInts = int32_t __attribute__((vector_size(16)));

Four all_of(float v) {
  return Four{v, v, v, v};
}
Four least(Four a, Four b) {
  return a < b ? a : b;
}
Four most(Four a, Four b) {
  return a > b ? a : b;
}

struct Box {
  Four low, high;

  static Box empty() {
    constexpr float kInfinite = std::numeric_limits<float>::infinity();
    return {all_of(kInfinite), all_of(-kInfinite)};
  }

  void add(const Box& b) {
    low = least(low, b.low);
    high = most(high, b.high);
  }
  void add(Four point) {
    low = least(low, point);
    high = most(high, point);
  }
  /// Half the surface area; 0 for an empty box.
  float area() const {
    const Four d = most(high - low, Four{});
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
  }
};

// The box of a triangle. The fourth lane of `low` holds its index encoded as a normal float, which
// no instruction can trap on or flush.
struct Reference {
  Four low, high;

  uint32_t triangle() const { return std::bit_cast<uint32_t>(float{low[3]}) & 0x0FFFFFFFu; }
  Four twice_middle() const { return low + high; }
};

struct Range {
  uint32_t begin, end;
  Box box, middles;  // of its triangles; of twice the centres of their boxes
  uint32_t size() const { return end - begin; }
};

// A node whose final position is not yet known.
struct Split {
  std::array<Box, 2> box;
  std::array<uint32_t, 2> child;  // leaf as in BvhNode, or index into Builder::splits_
  uint32_t nodes;                 // in the subtree
};

uint32_t leaf(uint32_t first, uint32_t count) {
  return shader::kBvhLeaf | count << shader::kBvhCountShift | first;
}

// Levels of nodes needed to halve `count` triangles until they fit into leaves.
uint32_t levels(uint32_t count) {
  return static_cast<uint32_t>(std::bit_width((count + kLeafSize - 1) / kLeafSize - (count > 0)));
}

// Maps twice the centre of a box to a bin on each axis.
struct BinMap {
  Four low, scale;
  int bins;

  BinMap(const Box& middles, uint32_t count)
      : low(middles.low), bins(static_cast<int>(std::min(kMaxBins, 4 + count / 16))) {
    const Four size = middles.high - middles.low;
    const Four s = all_of(static_cast<float>(bins) * 0.9999f) / size;
    // On an axis without extent all are in bin 0.
    const FourInts wide = (size > all_of(1e-30f)) & (size < all_of(1e37f));
    scale = wide ? s : Four{};
  }
  FourInts operator()(Four middle) const {
    const Four last = all_of(static_cast<float>(bins - 1));
    return __builtin_convertvector(least(most((middle - low) * scale, Four{}), last), FourInts);
  }
};

struct Bins {
  std::array<std::array<Box, kMaxBins>, 3> box;
  std::array<std::array<uint32_t, kMaxBins>, 3> count;

  explicit Bins(int bins) {
    for (size_t axis = 0; axis < 3; ++axis)
      for (size_t b = 0; b < static_cast<size_t>(bins); ++b) {
        box[axis][b] = Box::empty();
        count[axis][b] = 0;
      }
  }
  void add(const Reference* begin, const Reference* end, const BinMap& map) {
    for (const Reference* r = begin; r != end; ++r) {
      const FourInts bin = map(r->twice_middle());
      for (size_t axis = 0; axis < 3; ++axis) {
        const auto b = static_cast<size_t>(bin[axis]);
        box[axis][b].add(Box{r->low, r->high});
        ++count[axis][b];
      }
    }
  }
  void add(const Bins& other, int bins) {
    for (size_t axis = 0; axis < 3; ++axis)
      for (size_t b = 0; b < static_cast<size_t>(bins); ++b) {
        box[axis][b].add(other.box[axis][b]);
        count[axis][b] += other.count[axis][b];
      }
  }
};

struct Cut {
  float cost = std::numeric_limits<float>::infinity();  // area times count, summed over both sides
  int axis = -1;                                        // -1: no split
  int bin = 0;                                          // first bin on the right
  uint32_t left = 0;
};

Cut best_cut(const Bins& bins, int count) {
  Cut best;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& box = bins.box[static_cast<size_t>(axis)];
    const auto& number = bins.count[static_cast<size_t>(axis)];
    std::array<float, kMaxBins> right_cost;
    Box right = Box::empty();
    uint32_t n = 0;
    for (int b = count - 1; b > 0; --b) {
      const auto i = static_cast<size_t>(b);
      right.add(box[i]);
      n += number[i];
      right_cost[i] = n == 0 ? -1.0f : right.area() * static_cast<float>(n);
    }
    Box left = Box::empty();
    uint32_t m = 0;
    for (int b = 1; b < count; ++b) {
      const auto i = static_cast<size_t>(b);
      left.add(box[i - 1]);
      m += number[i - 1];
      if (m == 0 || right_cost[i] < 0) continue;
      const float cost = left.area() * static_cast<float>(m) + right_cost[i];
      if (cost < best.cost) best = {cost, axis, b, m};
    }
  }
  return best;
}

// Which side of a split a triangle belongs to.
struct Side {
  const BinMap& map;
  int axis;
  int last;  // last bin on the left

  Side(const BinMap& m, const Cut& cut) : map(m), axis(cut.axis), last(cut.bin - 1) {}
  bool right(Four middle) const { return map(middle)[axis] > last; }
};

class Builder {
 public:
  explicit Builder(const Scene& scene) : scene_(scene) {}

  Bvh build() {
    const auto n = static_cast<uint32_t>(scene_.triangles.size());
    references_ = std::make_unique_for_overwrite<Reference[]>(n);
    spare_ = std::make_unique_for_overwrite<Reference[]>(n > kParallelPass ? n : 0);
    splits_ = std::make_unique_for_overwrite<Split[]>(n);
    order_ = std::make_unique_for_overwrite<uint32_t[]>(n);
    const Range all = refer();
    float extent = 1;
    for (size_t axis = 0; n > 0 && axis < 3; ++axis)
      extent = std::max({extent, std::abs(all.box.low[axis]), std::abs(all.box.high[axis])});
    pad_ = all_of(kPad * extent);

    Bvh bvh;
    uint32_t root = 0, nodes = 0;
    const auto top = [&] { root = build(references_.get(), spare_.get(), all, 0, nodes); };
    // Value-initialising so many triangles takes time, so it runs in parallel.
    tbb::parallel_invoke(top, [&] { bvh.triangles.resize(n); });
    bvh.nodes.resize(std::max(nodes, 1u));
    if (nodes > 0) {
      place(bvh.nodes, root, 0);
    } else {
      Split only;
      const Box nothing{Four{}, Four{}};
      only.box = {n > 0 ? all.box : nothing, nothing};
      write(bvh.nodes[0], only, root, leaf(0, 0));
    }
    bvh.nodes[0].extent = extent;
    fill(bvh.triangles);
    return bvh;
  }

 private:
  // Makes the references of all triangles, and their range.
  Range refer() const {
    const auto n = static_cast<uint32_t>(scene_.triangles.size());
    Range all = tbb::parallel_reduce(
        tbb::blocked_range<uint32_t>(0, n, kChunk), Range{0, n, Box::empty(), Box::empty()},
        [&](const tbb::blocked_range<uint32_t>& part, Range sum) {
          for (uint32_t t = part.begin(); t != part.end(); ++t) {
            Box box = Box::empty();
            for (int corner = 0; corner < 3; ++corner) {
              const Vec3f p = scene_.vertex(t, corner);
              box.add(Four{p.x, p.y, p.z, 1});
            }
            references_[t] = {box.low, box.high};
            references_[t].low[3] = std::bit_cast<float>(0x40000000u | t);
            sum.box.add(box);
            sum.middles.add(references_[t].twice_middle());
          }
          return sum;
        },
        [](Range a, const Range& b) {
          a.box.add(b.box);
          a.middles.add(b.middles);
          return a;
        });
    return all;
  }

  // Returns the child code of the subtree over `range`; its references are in `from`, `to` is
  // scratch. `nodes`: its number of nodes.
  uint32_t build(Reference* from, Reference* to, const Range& range, uint32_t depth,
                 uint32_t& nodes) {
    nodes = 0;
    const uint32_t n = range.size();
    // A node costs more than testing two triangles.
    if (n <= 2 || (n <= kLeafSize && depth == shader::kBvhStack)) return make_leaf(from, range);
    const BinMap map(range.middles, n);
    const Cut cut = find_cut(from, range, map);
    const bool worth = cut.axis >= 0 && cut.cost + kNodeCost * range.box.area() <
                                            static_cast<float>(n) * range.box.area();
    if (n <= kLeafSize && !worth) return make_leaf(from, range);
    const uint32_t larger = std::max(cut.left, n - cut.left);
    const bool deep = depth + 1 + levels(larger) > shader::kBvhStack;
    std::array<Range, 2> part;
    if (cut.axis < 0 || deep) {
      part = halve(from, range);
    } else if (n > kParallelPass) {
      part = part_in_parallel(from, to, range, map, cut);
      std::swap(from, to);
    } else {
      part = part_in_place(from, range, map, cut);
    }
    std::array<uint32_t, 2> count;
    Split& split = splits_[part[1].begin - 1];  // each position between two triangles is split once
    const auto child = [&](size_t i) {
      split.child[i] = build(from, to, part[i], depth + 1, count[i]);
      split.box[i] = part[i].box;
    };
    if (n > kParallelTask) {
      tbb::parallel_invoke([&] { child(0); }, [&] { child(1); });
    } else {
      child(0);
      child(1);
    }
    split.nodes = nodes = 1 + count[0] + count[1];
    return part[1].begin - 1;
  }

  uint32_t make_leaf(const Reference* from, const Range& range) {
    for (uint32_t i = range.begin; i < range.end; ++i) order_[i] = from[i].triangle();
    return leaf(range.begin, range.size());
  }

  static Cut find_cut(const Reference* from, const Range& range, const BinMap& map) {
    Bins bins(map.bins);
    if (range.size() <= kParallelPass) {
      bins.add(from + range.begin, from + range.end, map);
    } else {
      bins = tbb::parallel_reduce(
          tbb::blocked_range<uint32_t>(range.begin, range.end, kChunk), bins,
          [&](const tbb::blocked_range<uint32_t>& part, Bins sum) {
            sum.add(from + part.begin(), from + part.end(), map);
            return sum;
          },
          [&](Bins a, const Bins& b) {
            a.add(b, map.bins);
            return a;
          });
    }
    return best_cut(bins, map.bins);
  }

  static Range range_of(const Reference* from, uint32_t begin, uint32_t end) {
    Range r{begin, end, Box::empty(), Box::empty()};
    for (uint32_t i = begin; i < end; ++i) {
      r.box.add(Box{from[i].low, from[i].high});
      r.middles.add(from[i].twice_middle());
    }
    return r;
  }

  // If no split separates the triangles, or the traversal stack would overflow.
  static std::array<Range, 2> halve(Reference* from, const Range& range) {
    const uint32_t middle = range.begin + range.size() / 2;
    const Four size = range.middles.high - range.middles.low;
    int axis = size[1] > size[0] ? 1 : 0;
    if (size[2] > size[axis]) axis = 2;
    if (size[axis] > 0)
      std::nth_element(from + range.begin, from + middle, from + range.end,
                       [axis](const Reference& a, const Reference& b) {
                         const float x = a.twice_middle()[axis], y = b.twice_middle()[axis];
                         return x < y || (x == y && a.triangle() < b.triangle());
                       });
    return {range_of(from, range.begin, middle), range_of(from, middle, range.end)};
  }

  static std::array<Range, 2> part_in_place(Reference* from, const Range& range, const BinMap& map,
                                            const Cut& cut) {
    const Side side(map, cut);
    std::array<Range, 2> part{
        Range{range.begin, range.begin + cut.left, Box::empty(), Box::empty()},
        Range{range.begin + cut.left, range.end, Box::empty(), Box::empty()}};
    uint32_t i = range.begin, j = range.end;
    while (i < j) {
      const Reference r = from[i];
      const Four middle = r.twice_middle();
      const bool right = side.right(middle);
      part[right].box.add(Box{r.low, r.high});
      part[right].middles.add(middle);
      if (right) {
        --j;
        from[i] = from[j];
        from[j] = r;
      } else {
        ++i;
      }
    }
    return part;
  }

  // Stable, from one array into the other.
  static std::array<Range, 2> part_in_parallel(const Reference* from, Reference* to,
                                               const Range& range, const BinMap& map,
                                               const Cut& cut) {
    const Side side(map, cut);
    const uint32_t chunks = (range.size() + kChunk - 1) / kChunk;
    const auto begin_of = [&](uint32_t c) {
      return range.begin + std::min(c * kChunk, range.size());
    };
    std::vector<uint32_t> left(chunks);
    tbb::parallel_for(0u, chunks, [&](uint32_t c) {
      uint32_t n = 0;
      for (uint32_t i = begin_of(c); i < begin_of(c + 1); ++i)
        n += !side.right(from[i].twice_middle());
      left[c] = n;
    });
    std::vector<uint32_t> place(chunks);  // where the chunk's first left triangle goes
    uint32_t sum = range.begin;
    for (uint32_t c = 0; c < chunks; ++c) {
      place[c] = sum;
      sum += left[c];
    }
    std::vector<std::array<Range, 2>> parts(chunks);
    tbb::parallel_for(0u, chunks, [&](uint32_t c) {
      std::array<Range, 2> part;
      for (Range& p : part) p.box = p.middles = Box::empty();
      std::array<uint32_t, 2> at{place[c], sum + (begin_of(c) - place[c])};
      for (uint32_t i = begin_of(c); i < begin_of(c + 1); ++i) {
        const Reference& r = from[i];
        const bool right = side.right(r.twice_middle());
        part[right].box.add(Box{r.low, r.high});
        part[right].middles.add(r.twice_middle());
        to[at[right]++] = r;
      }
      parts[c] = part;
    });
    std::array<Range, 2> part{Range{range.begin, sum, Box::empty(), Box::empty()},
                              Range{sum, range.end, Box::empty(), Box::empty()}};
    for (const auto& p : parts)
      for (size_t s = 0; s < 2; ++s) {
        part[s].box.add(p[s].box);
        part[s].middles.add(p[s].middles);
      }
    return part;
  }

  void write(BvhNode& node, const Split& split, uint32_t child0, uint32_t child1) const {
    const auto vector = [](Four a) { return Vec3f(a[0], a[1], a[2]); };
    node.low0 = vector(split.box[0].low - pad_);
    node.high0 = vector(split.box[0].high + pad_);
    node.low1 = vector(split.box[1].low - pad_);
    node.high1 = vector(split.box[1].high + pad_);
    node.child0 = child0;
    node.child1 = child1;
    node.extent = 0;
    node.pad = 0;
  }

  // Writes a subtree from index `at` on, depth first.
  void place(std::vector<BvhNode>& out, uint32_t split_index, uint32_t at) const {
    const Split& split = splits_[split_index];
    const auto is_leaf = [&](size_t i) { return (split.child[i] & shader::kBvhLeaf) != 0; };
    const uint32_t at0 = at + 1;
    const uint32_t at1 = at0 + (is_leaf(0) ? 0 : splits_[split.child[0]].nodes);
    write(out[at], split, is_leaf(0) ? split.child[0] : at0, is_leaf(1) ? split.child[1] : at1);
    const auto first = [&] {
      if (!is_leaf(0)) place(out, split.child[0], at0);
    };
    const auto second = [&] {
      if (!is_leaf(1)) place(out, split.child[1], at1);
    };
    if (split.nodes > kParallelTask) {
      tbb::parallel_invoke(first, second);
    } else {
      first();
      second();
    }
  }

  void fill(std::vector<BvhTriangle>& out) const {
    std::vector<uint8_t> stops;
    for (const Material& m : scene_.materials) stops.push_back(stops_every_ray(m));
    tbb::parallel_for(tbb::blocked_range<size_t>(0, out.size(), kChunk),
                      [&](const tbb::blocked_range<size_t>& part) {
                        for (size_t i = part.begin(); i != part.end(); ++i) {
                          const uint32_t t = order_[i];
                          out[i] = {scene_.vertex(t, 0), t,
                                    scene_.vertex(t, 1), stops[scene_.triangles[t].material],
                                    scene_.vertex(t, 2), 0};
                        }
                      });
  }

  const Scene& scene_;
  Four pad_;
  std::unique_ptr<Reference[]> references_, spare_;
  std::unique_ptr<Split[]> splits_;
  std::unique_ptr<uint32_t[]> order_;
};

}  // namespace

bool stops_every_ray(const Material& material) {
  return !pane_of(material) && material.alpha_mode == Material::Alpha::opaque;
}

Bvh build_bvh(const Scene& scene) {
  if (scene.triangles.size() > kMaxTriangles)
    throw Error(Exit::bad_input, "more than 2^28 triangles");
  return Builder(scene).build();
}

}  // namespace tdpt
