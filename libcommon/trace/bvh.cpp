// Builds a BVH top-down by binned SAH: each range of triangles is binned by the centres of its
// boxes on three axes, and split between two bins where (area of the left box) (triangles left) +
// (the same on the right) is minimal. Subtrees are built in parallel; each range belongs to one
// thread, so the result does not depend on their number.
#include "libcommon/trace/bvh.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "libcommon/base/error.h"

namespace tdpt {
namespace {

using shader::BvhNode;
using shader::BvhTriangle;

constexpr uint32_t kLeafSize = 4;
constexpr uint32_t kMaxTriangles = 1u << 28;
constexpr uint32_t kParallelTask = 1u << 11;  // triangles of a range that becomes a task of its own
constexpr int kMaxBins = 16;
constexpr float kNodeCost = 2.0f;  // cost of visiting a node, in triangle tests
constexpr float kPad = 0x1p-18f;   // see traversal.h
constexpr float kInfinite = std::numeric_limits<float>::infinity();

struct Bounds {
  Vec3f low{kInfinite}, high{-kInfinite};

  void add(const Bounds& b) {
    low = min(low, b.low);
    high = max(high, b.high);
  }
  void add(const Vec3f& point) {
    low = min(low, point);
    high = max(high, point);
  }
  /// Half the surface area; 0 for an empty box.
  float area() const {
    const Vec3f d = max(high - low, Vec3f(0));
    return d.x * d.y + d.y * d.z + d.z * d.x;
  }
};

struct Reference {
  Bounds box;
  uint32_t triangle;

  Vec3f twice_middle() const { return box.low + box.high; }
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
  Vec3f low, scale;
  int bins;

  BinMap(const Bounds& middles, uint32_t count)
      : low(middles.low), bins(static_cast<int>(std::min<uint32_t>(kMaxBins, 4 + count / 16))) {
    const Vec3f size = middles.high - middles.low;
    // On an axis without extent all are in bin 0.
    for (int axis = 0; axis < 3; ++axis)
      if (size[axis] > 1e-30f && size[axis] < 1e37f)
        scale[axis] = static_cast<float>(bins) * 0.9999f / size[axis];
  }
  int operator()(const Vec3f& middle, int axis) const {
    const float bin = std::max(0.0f, (middle[axis] - low[axis]) * scale[axis]);
    return static_cast<int>(std::min(bin, static_cast<float>(bins - 1)));
  }
};

struct Split {
  float cost = kInfinite;  // area times count, summed over both sides
  int axis = -1;           // -1: no split
  int bin = 0;             // first bin on the right
  uint32_t left = 0;       // triangles
};

struct Bin {
  Bounds box;
  uint32_t count = 0;
};

// Improves `best` by the splits between the bins of one axis.
void find_split(const std::array<Bin, kMaxBins>& bins, int count, int axis, Split& best) {
  std::array<float, kMaxBins> right_cost;
  Bin right, left;
  const auto join = [](Bin& side, const Bin& bin) {
    side.box.add(bin.box);
    side.count += bin.count;
  };
  const auto cost = [](const Bin& side) {
    return side.box.area() * static_cast<float>(side.count);
  };
  for (auto b = static_cast<size_t>(count) - 1; b > 0; --b) {
    join(right, bins[b]);
    right_cost[b] = right.count == 0 ? -1.0f : cost(right);
  }
  for (size_t b = 1; b < static_cast<size_t>(count); ++b) {
    join(left, bins[b - 1]);
    if (left.count == 0 || right_cost[b] < 0) continue;
    if (const float both = cost(left) + right_cost[b]; both < best.cost)
      best = {both, axis, static_cast<int>(b), left.count};
  }
}

class Builder {
 public:
  explicit Builder(const Scene& scene)
      : scene_(scene),
        size_(static_cast<uint32_t>(scene.triangles.size())),
        references_(size_),
        splits_(size_) {}

  Bvh build() {
    tbb::parallel_for(0u, size_, [&](uint32_t t) {
      references_[t].triangle = t;
      for (int corner = 0; corner < 3; ++corner) references_[t].box.add(scene_.vertex(t, corner));
    });
    Child root = build(0, size_, 0);
    if (size_ == 0) root.box = {Vec3f(0), Vec3f(0)};
    const Vec3f low = max(root.box.low, -root.box.low), high = max(root.box.high, -root.box.high);
    const float extent = std::max({1.0f, max_component(low), max_component(high)});
    pad_ = Vec3f(kPad * extent);
    Bvh bvh;
    if ((root.code & shader::kBvhLeaf) == 0)
      place(root.code, bvh.nodes);
    else
      bvh.nodes = {node_of({root, {leaf(0, 0), {Vec3f(0), Vec3f(0)}}})};
    bvh.nodes[0].extent = extent;
    fill(bvh.triangles);
    return bvh;
  }

 private:
  // A leaf as in BvhNode, or an index into splits_; and its box.
  struct Child {
    uint32_t code = 0;
    Bounds box{};
  };

  Child build(uint32_t begin, uint32_t end, uint32_t depth) {
    const uint32_t n = end - begin;
    Bounds box, middles;
    for (uint32_t i = begin; i < end; ++i) {
      box.add(references_[i].box);
      middles.add(references_[i].twice_middle());
    }
    // A node costs more than testing two triangles.
    if (n <= 2 || (n <= kLeafSize && depth == shader::kBvhStack)) return {leaf(begin, n), box};
    const BinMap map(middles, n);
    const Split split = best_split(begin, end, map);
    const bool worth =
        split.axis >= 0 && split.cost + kNodeCost * box.area() < static_cast<float>(n) * box.area();
    if (n <= kLeafSize && !worth) return {leaf(begin, n), box};
    const bool deep = depth + 1 + levels(std::max(split.left, n - split.left)) > shader::kBvhStack;
    const uint32_t middle =
        split.axis < 0 || deep ? halve(begin, end, middles) : part(begin, end, map, split);
    std::array<Child, 2>& children = splits_[middle - 1];  // no other range is split there
    const auto first = [&] { children[0] = build(begin, middle, depth + 1); };
    const auto second = [&] { children[1] = build(middle, end, depth + 1); };
    if (n > kParallelTask)
      tbb::parallel_invoke(first, second);
    else
      first(), second();
    return {middle - 1, box};
  }

  Split best_split(uint32_t begin, uint32_t end, const BinMap& map) const {
    std::array<std::array<Bin, kMaxBins>, 3> bins;
    for (uint32_t i = begin; i < end; ++i)
      for (int axis = 0; axis < 3; ++axis) {
        const Reference& r = references_[i];
        Bin& bin =
            bins[static_cast<size_t>(axis)][static_cast<size_t>(map(r.twice_middle(), axis))];
        bin.box.add(r.box);
        ++bin.count;
      }
    Split best;
    for (int axis = 0; axis < 3; ++axis)
      find_split(bins[static_cast<size_t>(axis)], map.bins, axis, best);
    return best;
  }

  auto at(uint32_t i) { return references_.begin() + static_cast<std::ptrdiff_t>(i); }

  // Both return the first of the right half.
  uint32_t part(uint32_t begin, uint32_t end, const BinMap& map, const Split& split) {
    const auto right = std::partition(at(begin), at(end), [&](const Reference& r) {
      return map(r.twice_middle(), split.axis) < split.bin;
    });
    return static_cast<uint32_t>(right - references_.begin());
  }
  // If no split separates the triangles, or the traversal stack would overflow.
  uint32_t halve(uint32_t begin, uint32_t end, const Bounds& middles) {
    const uint32_t middle = begin + (end - begin) / 2;
    const Vec3f size = middles.high - middles.low;
    int axis = size[1] > size[0] ? 1 : 0;
    if (size[2] > size[axis]) axis = 2;
    if (size[axis] > 0)
      std::nth_element(at(begin), at(middle), at(end),
                       [axis](const Reference& a, const Reference& b) {
                         const float x = a.twice_middle()[axis], y = b.twice_middle()[axis];
                         return x < y || (x == y && a.triangle < b.triangle);
                       });
    return middle;
  }

  BvhNode node_of(const std::array<Child, 2>& split) const {
    const auto& [first, second] = split;
    return {first.box.low - pad_,  first.code, first.box.high + pad_,  second.code,
            second.box.low - pad_, 0,          second.box.high + pad_, 0};
  }

  // Appends a subtree, depth first; returns its index.
  uint32_t place(uint32_t split, std::vector<BvhNode>& out) const {
    const auto index = static_cast<uint32_t>(out.size());
    out.push_back(node_of(splits_[split]));
    const auto child = [&](uint32_t code) {
      return (code & shader::kBvhLeaf) != 0 ? code : place(code, out);
    };
    const uint32_t first = child(splits_[split][0].code);
    const uint32_t second = child(splits_[split][1].code);
    out[index].child0 = first;
    out[index].child1 = second;
    return index;
  }

  void fill(std::vector<BvhTriangle>& out) const {
    std::vector<uint8_t> stops;
    for (const Material& m : scene_.materials)
      stops.push_back(!pane_of(m) && m.alpha_mode == Material::Alpha::opaque);
    out.resize(size_);
    tbb::parallel_for(0u, size_, [&](uint32_t i) {
      const uint32_t t = references_[i].triangle;
      out[i] = {scene_.vertex(t, 0), t, scene_.vertex(t, 1), stops[scene_.triangles[t].material],
                scene_.vertex(t, 2), 0};
    });
  }

  const Scene& scene_;
  const uint32_t size_;
  Vec3f pad_;
  std::vector<Reference> references_;         // of a leaf and of a subtree: consecutive
  std::vector<std::array<Child, 2>> splits_;  // by the triangle before them
};

}  // namespace

Bvh build_bvh(const Scene& scene) {
  if (scene.triangles.size() > kMaxTriangles)
    throw Error(Exit::bad_input, "more than 2^28 triangles");
  return Builder(scene).build();
}

}  // namespace tdpt
