// Parses arbitrary bytes as an OpenEXR picture; a picture that was read must have all its pixels.
#include "libcommon/formats/picture.h"

#include "libcommon/testing/files/fuzz.h"

using namespace tdpt;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using testing::require;
  testing::reads([&] {
    const ExrFile file = parse_exr(testing::text_of(data, size), "input");
    const auto is_whole = [](const Picture& p) {
      return p.width > 0 && p.height > 0 &&
             p.pixels.size() == static_cast<size_t>(p.width) * static_cast<size_t>(p.height);
    };
    require(is_whole(file.picture), "a picture has all its pixels");
    for (const auto& [name, layer] : file.layers)
      require(is_whole(layer) && layer.width == file.picture.width, "a layer has all its pixels");
    provenance_of(file);
  });
  return 0;
}
