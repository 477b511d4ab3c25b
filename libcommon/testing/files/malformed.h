// Malformed scenes: each is wrong in one way, and is refused with one message.
#pragma once
#include <string>
#include <vector>

namespace tdpt::testing {

struct MalformedScene {
  std::string file;  ///< file name
  std::string bytes;
  std::string expected;  ///< "place: message" as read_gltf must put it, after "FILE:"
};

std::vector<MalformedScene> malformed_scenes();

}  // namespace tdpt::testing
