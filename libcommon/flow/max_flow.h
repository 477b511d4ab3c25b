// Maximum flow and minimum cut of a network with integer capacities (Boykov-Kolmogorov, Boost).
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

namespace tdpt {

struct FlowArc {
  uint32_t from, to;
  int64_t capacity;  ///< 0 or more
};

/// Nodes are 0 .. nodes-1; the sum of all capacities is below kLargestCapacitySum.
struct FlowNetwork {
  uint32_t nodes = 0, source = 0, sink = 0;
  std::vector<FlowArc> arcs;
};

inline constexpr int64_t kLargestCapacitySum = INT64_MAX / 4;

struct MaxFlow {
  int64_t value = 0;
  std::vector<int64_t> flow;         ///< on each arc of the network
  std::vector<uint8_t> source_side;  ///< per node: 1 if a residual path from the source reaches it
};

/// The arcs of a network laid out for the solver: most of the work, and the same for networks that
/// differ in capacities only.
class FlowGraph {
 public:
  explicit FlowGraph(const FlowNetwork& network);

  /// The minimum cut nearest to the source. `network`: with the arcs of the constructor's, and any
  /// capacities. Thread-safe.
  MaxFlow solve(const FlowNetwork& network) const;

 private:
  struct Layout;
  std::shared_ptr<const Layout> layout_;
};

/// The minimum cut nearest to the source.
MaxFlow max_flow(const FlowNetwork& network);

}  // namespace tdpt
