// A product and a sum that a device may fuse: tools/spirv-exact.sh must find them.
#version 460
layout(local_size_x = 1) in;
layout(set = 0, binding = 0, std430) buffer Words { float words[]; };

void main() {
  words[0] = words[1] * words[2] + words[3];
}
