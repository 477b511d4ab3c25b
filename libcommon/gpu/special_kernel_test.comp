// words[0] is the constant 1 of specialisation, and one more where constant 0 says so.
#version 460
layout(local_size_x = 1) in;
layout(constant_id = 0) const bool adds = false;
layout(constant_id = 1) const uint number = 7;
layout(set = 0, binding = 0, std430) buffer Words { uint words[]; };

void main() {
  words[0] = adds ? number + 1 : number;
}
