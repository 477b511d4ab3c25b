// make_scenes TESTDATA: writes the scenes of TESTDATA/scenes, TESTDATA/encodings and
// TESTDATA/malformed.
#include <cstdio>
#include <exception>

#include "libcommon/base/output_file.h"
#include "libcommon/testing/files/malformed.h"
#include "libcommon/testing/files/reencode.h"
#include "libcommon/testing/rooms/rooms.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_scenes TESTDATA\n");
    return 2;
  }
  try {
    for (const auto& scene : tdpt::testing::make_scenes())
      tdpt::write_output(std::string(argv[1]) + "/scenes/" + scene.file, scene.bytes);
    for (const auto& [name, bytes] : tdpt::testing::encoded_rooms())
      tdpt::write_output(std::string(argv[1]) + "/encodings/" + name, bytes);
    for (const auto& scene : tdpt::testing::malformed_scenes())
      tdpt::write_output(std::string(argv[1]) + "/malformed/" + scene.file, scene.bytes);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "make_scenes: %s\n", e.what());
    return 4;
  }
  return 0;
}
