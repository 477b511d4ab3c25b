// Parses arbitrary bytes as a Tungsten scene.
#include "tools/tdpt-import/tungsten/tungsten.h"

#include "libcommon/testing/files/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace tdpt;
  testing::reads([&] {
    foreign::Source source(testing::file_of(testing::text_of(data, size)));
    foreign::read_tungsten(source);
  });
  return 0;
}
