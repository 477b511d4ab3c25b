// A product that a device may fuse with a sum, and a root: cmake/spirv-exact.sh must find them.
#version 460
layout(local_size_x = 1) in;
layout(set = 0, binding = 0, std430) buffer Words { float words[]; };

void main() {
  words[0] = words[1] * words[2];
  words[3] = sqrt(words[4]);
}
