// Parses arbitrary bytes as a scene; all values of a scene that was read must be in range.
#include "libcommon/scene/scene.h"
#include "libcommon/testing/files/fuzz.h"
#include "libcommon/testing/files/sound_scene.h"

using namespace tdpt;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  testing::reads([&] {
    const Scene scene = read_gltf(testing::file_of(testing::text_of(data, size)));
    testing::require(scene.triangles.size() > 0, "a scene has triangles");
    if (scene.triangles.size() > 4096) return;  // checking every place takes long
    const std::string fault = testing::fault_of(scene);
    testing::require(fault.empty(), fault);
  });
  return 0;
}
