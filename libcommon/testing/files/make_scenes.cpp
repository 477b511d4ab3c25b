// make_scenes FOLDER: writes the generated scenes into those of FOLDER/scenes, FOLDER/encodings and
// FOLDER/malformed that exist.
#include <cstdio>
#include <exception>
#include <filesystem>

#include "libcommon/base/output_file.h"
#include "libcommon/testing/files/malformed.h"
#include "libcommon/testing/files/reencode.h"
#include "libcommon/testing/rooms/rooms.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_scenes FOLDER\n");
    return 2;
  }
  bool written = false;
  try {
    const auto write = [&](const char* folder, const auto& scenes) {
      const auto path = std::filesystem::path(argv[1]) / folder;
      if (!is_directory(path)) return;
      for (const auto& scene : scenes) tdpt::write_output(path / scene.file, scene.bytes);
      written = true;
    };
    write("scenes", tdpt::testing::make_scenes());
    write("encodings", tdpt::testing::encoded_rooms());
    write("malformed", tdpt::testing::malformed_scenes());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "make_scenes: %s\n", e.what());
    return 4;
  }
  if (!written) std::fprintf(stderr, "make_scenes: %s has no folder for scenes\n", argv[1]);
  return written ? 0 : 4;
}
