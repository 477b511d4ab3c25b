#include "tools/mincut/verify.h"

#include <fmt/format.h>

#include "libcommon/base/error.h"

namespace tdpt {
namespace {
template <class... Args>
[[noreturn]] void refute(fmt::format_string<Args...> text, Args&&... args) {
  throw Error(Exit::internal, "the solver's answer does not hold: " +
                                  fmt::format(text, std::forward<Args>(args)...));
}
}  // namespace

void verify_max_flow(const FlowNetwork& network, const MaxFlow& result) {
  if (result.flow.size() != network.arcs.size())
    refute("{} flows, expected {}", result.flow.size(), network.arcs.size());
  if (result.source_side.size() != network.nodes)
    refute("{} sides, expected {}", result.source_side.size(), network.nodes);
  if (!result.source_side[network.source]) refute("the source is not on its own side");
  if (result.source_side[network.sink]) refute("the sink is on the source's side");
  std::vector<int64_t> surplus(network.nodes, 0);
  int64_t cut = 0;
  for (size_t i = 0; i < network.arcs.size(); ++i) {
    const FlowArc& a = network.arcs[i];
    const int64_t f = result.flow[i];
    if (f < 0 || f > a.capacity)
      refute("arc {} carries {}, expected 0 to {}", i + 1, f, a.capacity);
    surplus[a.from] -= f;
    surplus[a.to] += f;
    if (result.source_side[a.from] && !result.source_side[a.to]) cut += a.capacity;
  }
  for (uint32_t v = 0; v < network.nodes; ++v)
    if (v != network.source && v != network.sink && surplus[v] != 0)
      refute("node {} keeps {}, expected 0", v + 1, surplus[v]);
  if (surplus[network.sink] != result.value)
    refute("{} arrives at the sink, expected {}", surplus[network.sink], result.value);
  if (cut != result.value) refute("the cut holds {}, expected the flow {}", cut, result.value);
}

}  // namespace tdpt
