// Names more buffers than some devices bind at once, and one that it is not given: for what is refused.
#version 460
layout(local_size_x = 1) in;
#define ALL(F) \
  F(1, 0) F(2, 1) F(3, 2) F(4, 3) F(5, 4) F(6, 5) F(7, 6) F(8, 7) F(9, 8) F(10, 9) F(11, 10) \
  F(12, 11) F(13, 12) F(14, 13) F(15, 14) F(16, 15) F(17, 16) F(18, 17) F(19, 18) F(20, 19) \
  F(21, 20) F(22, 21) F(23, 22) F(24, 23) F(25, 24) F(26, 25) F(27, 26) F(28, 27) F(29, 28) \
  F(30, 29) F(31, 30) F(32, 31)
#define BUFFER(n, before) layout(set = 0, binding = n, std430) buffer Words##n { uint words##n; };
#define COPY(n, before) words##n = words##before;
BUFFER(0, )
ALL(BUFFER)

void main() {
  ALL(COPY)
}
