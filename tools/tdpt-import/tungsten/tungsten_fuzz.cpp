// Parses arbitrary bytes as a Tungsten scene; what was read must hold together.
#include "tools/tdpt-import/described.h"

#include "tools/tdpt-import/testing/sound.h"

using namespace tdpt;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  foreign::Described scene;
  if (testing::reads([&] {
        foreign::Source source(testing::file_of(testing::text_of(data, size)));
        scene = foreign::read_tungsten(source);
        source.lose_unread();
      }))
    foreign::require_sound(scene);
  return 0;
}
