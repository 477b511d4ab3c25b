// Parses arbitrary bytes as a portal file; portals that were read must round-trip.
#include "libcommon/formats/portal.h"

#include "libcommon/testing/files/fuzz.h"

using namespace tdpt;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using testing::require;
  testing::reads([&] {
    const PortalFile a = read_portals(testing::file_of(testing::text_of(data, size)));
    for (const Portal& p : a.portals) {
      for (const Vec3d& v : p.vertices) require(is_finite(v), "a portal is somewhere");
      for (const auto& t : p.triangles)
        for (const uint32_t v : t) require(v < p.vertices.size(), "corners exist");
    }
    portal_bytes(a);
  });
  return 0;
}
