// Makes the scenes of testdata/scenes: rooms with a known aperture, closed so that no ray escapes.
#pragma once
#include <string>
#include <vector>

namespace tdpt::testing {

struct NamedScene {
  std::string file;   ///< file name
  std::string bytes;  ///< .glb
};

/// Every scene of testdata/scenes, the same bytes each time.
std::vector<NamedScene> make_scenes();

}  // namespace tdpt::testing
