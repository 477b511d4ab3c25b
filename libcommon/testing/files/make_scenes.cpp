// make_scenes FOLDER: writes the scenes of testdata/scenes into FOLDER/scenes.
#include <cstdio>
#include <exception>
#include <filesystem>

#include "libcommon/base/output_file.h"
#include "libcommon/testing/rooms/rooms.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_scenes FOLDER\n");
    return 2;
  }
  try {
    for (const auto& scene : tdpt::testing::make_scenes())
      tdpt::write_output(std::filesystem::path(argv[1]) / "scenes" / scene.file, scene.bytes);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "make_scenes: %s\n", e.what());
    return 4;
  }
  return 0;
}
