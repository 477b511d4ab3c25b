// Parses arbitrary bytes as a scene of Mitsuba; what was read must hold together.
#include "tools/tdpt-import/described.h"

#include "tools/tdpt-import/testing/sound.h"

using namespace tdpt;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using testing::require;
  // Files that inputs may name; the input itself is another, for includes.
  static const testing::TempFolder folder;
  static const bool written = [] {
    folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    folder.write("a.ply",
                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                 "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                 "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    folder.write("a.png", "");
    folder.write("a.spd", "400 0.5\n700 1\n");
    return true;
  }();
  require(written, "there are files");
  const std::string path = folder.write("a.xml", std::string(testing::text_of(data, size)));
  foreign::Described scene;
  const auto read = [&](const std::map<std::string, std::string>& parameters) {
    foreign::Source source(path);
    scene = foreign::read_mitsuba(source, parameters);
    source.lose_unread();
  };
  if (!testing::reads([&] {
        try {
          read({{"given", "1"}});
        } catch (const UsageError&) {  // it is not used
          read({});
        }
      }))
    return 0;
  foreign::require_sound(scene);
  return 0;
}
