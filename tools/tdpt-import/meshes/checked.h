// What all mesh readers need: values of either endianness, and the checks that every mesh passes.
#pragma once
#include <bit>
#include <cstring>
#include <string>

#include "tools/tdpt-import/described.h"

namespace tdpt::foreign {

/// The T that begins at `bytes`.
template <class T>
T value_at(const char* bytes, std::endian order = std::endian::little) {
  char in_order[sizeof(T)];
  std::memcpy(in_order, bytes, sizeof(T));
  if (order != std::endian::native)
    for (size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(in_order[i], in_order[sizeof(T) - 1 - i]);
  T value;
  std::memcpy(&value, in_order, sizeof(T));
  return value;
}

/// Throws InputError unless there are triangles, all of them with existing corners, and all
/// positions are finite. Scales normals to length 1; vertices without a usable one take the mean of
/// their triangles. Coordinates of textures that are not finite become 0.
void check(Mesh& mesh, const std::string& name);

}  // namespace tdpt::foreign
