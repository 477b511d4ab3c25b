// Parses arbitrary bytes as a flow network; a network that was read must round-trip.
#include "libcommon/formats/dimacs.h"

#include "libcommon/testing/files/fuzz.h"

using namespace tdpt;

namespace {

void expect_same(const DimacsFile& a, const DimacsFile& b) {
  using testing::require;
  require(a.network.nodes == b.network.nodes && a.network.source == b.network.source &&
              a.network.sink == b.network.sink && a.network.arcs.size() == b.network.arcs.size(),
          "a network comes back");
  for (size_t i = 0; i < a.network.arcs.size(); ++i) {
    const FlowArc &x = a.network.arcs[i], &y = b.network.arcs[i];
    require(x.from == y.from && x.to == y.to && x.capacity == y.capacity, "arcs come back");
  }
  require(a.has_patches == b.has_patches && a.patches.size() == b.patches.size() &&
              a.walks.size() == b.walks.size() && a.scale == b.scale,
          "patches come back");
  for (size_t i = 0; i < a.patches.size(); ++i) {
    const Patch &x = a.patches[i], &y = b.patches[i];
    require(x.node == y.node && x.level == y.level && x.cell == y.cell && x.sky == y.sky &&
                x.samples == y.samples && x.faces == y.faces,
            "a patch comes back");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  DimacsFile a;
  if (testing::reads([&] { a = read_dimacs(testing::file_of(testing::text_of(data, size))); }))
    expect_same(a, read_dimacs(testing::file_of(dimacs_text(a))));
  return 0;
}
