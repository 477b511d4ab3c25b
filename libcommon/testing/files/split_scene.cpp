// split_scene IN.glb OUT.glb: subdivides each triangle of a scene into four.
#include <cstdio>
#include <exception>

#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/testing/files/split.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: split_scene IN.glb OUT.glb\n");
    return 2;
  }
  try {
    tdpt::write_output(argv[2], tdpt::testing::split_in_four(tdpt::read_file(argv[1])));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "split_scene: %s\n", e.what());
    return 4;
  }
  return 0;
}
