// Any bytes as a scene; wherever one looks at what is read, it is in range.
#include "libcommon/scene/scene.h"
#include "libcommon/testing/files/fuzz.h"
#include "libcommon/testing/files/sound_scene.h"

using namespace tdpt;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  testing::reads([&] {
    const Scene scene = read_gltf(testing::file_of(testing::text_of(data, size)));
    testing::require(scene.triangles.size() > 0, "a scene has triangles");
    if (scene.triangles.size() > 4096) return;  // looking everywhere takes long
    const std::string fault = testing::fault_of(scene);
    testing::require(fault.empty(), fault);
  });
  return 0;
}
