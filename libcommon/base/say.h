// Messages for people, on stderr. A failed write (full disk, terminal gone) is ignored, so that it
// ends no work; fmt::print would throw.
#pragma once
#include <cstdio>
#include <string>

#include <fcntl.h>
#include <unistd.h>

namespace tdpt {

inline void say(const std::string& line) {
  std::fputs((line + "\n").c_str(), stderr);
}

/// Opens the standard streams that are closed as empty ones, so that no file that the program opens
/// takes their place.
inline void open_standard_streams() {
  int fd = 0;
  while (fd >= 0 && fd <= 2) fd = ::open("/dev/null", O_RDWR);
  if (fd > 2) ::close(fd);
}

}  // namespace tdpt
