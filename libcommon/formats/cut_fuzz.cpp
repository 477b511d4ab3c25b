// Parses arbitrary bytes as a cut; a cut that was read must round-trip.
#include "libcommon/formats/cut.h"

#include "libcommon/testing/files/fuzz.h"

using namespace tdpt;

namespace {

void expect_same(const CutFile& a, const CutFile& b) {
  using testing::require;
  require(a.scene_hash == b.scene_hash && a.cameras == b.cameras && a.bottleneck == b.bottleneck &&
              a.sides == b.sides && a.cuts.size() == b.cuts.size() &&
              a.arcs.size() == b.arcs.size() && a.patches.size() == b.patches.size(),
          "a cut comes back");
  for (size_t i = 0; i < a.arcs.size(); ++i)
    require(a.arcs[i].from == b.arcs[i].from && a.arcs[i].to == b.arcs[i].to &&
                a.arcs[i].capacity == b.arcs[i].capacity,
            "arcs come back");
  for (size_t i = 0; i < a.patches.size(); ++i)
    require(a.patches[i].node == b.patches[i].node && a.patches[i].faces == b.patches[i].faces &&
                a.patches[i].sky == b.patches[i].sky,
            "a patch comes back");
  for (size_t c = 0; c < a.cuts.size(); ++c)
    require(a.cuts[c].flow == b.cuts[c].flow && a.cuts[c].conductance == b.cuts[c].conductance &&
                a.cuts[c].camera == b.cuts[c].camera,
            "figures come back");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  CutFile a;
  if (testing::reads([&] { a = read_cut(testing::file_of(testing::text_of(data, size))); }))
    expect_same(a, read_cut(testing::file_of(cut_text(a))));
  return 0;
}
