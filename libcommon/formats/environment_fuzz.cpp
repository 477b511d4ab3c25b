// Parses arbitrary bytes as an environment map; a map that was read must be usable as a light.
#include "libcommon/formats/environment.h"

#include <cmath>

#include "libcommon/testing/files/fuzz.h"

using namespace tdpt;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  testing::reads([&] {
    const Sky::Map map = parse_environment(testing::text_of(data, size), "input");
    for (const Rgb& p : map.texels)
      for (int c = 0; c < 3; ++c)
        testing::require(p[c] >= 0 && std::isfinite(p[c]), "a radiance is not negative");
  });
  return 0;
}
