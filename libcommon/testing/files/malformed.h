// Malformed scenes: each has one error and is refused with one message.
#pragma once
#include <string>
#include <vector>

namespace tdpt::testing {

struct MalformedScene {
  std::string file;  ///< file name
  std::string bytes;
  std::string expected;  ///< "place: message" as read_gltf must report it after "FILE:"
};

std::vector<MalformedScene> malformed_scenes();

}  // namespace tdpt::testing
