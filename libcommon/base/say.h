// Lines for people, on stderr. Nobody may be there to read them, on a full disk or a terminal that
// is gone: that ends no work (fmt::print would throw).
#pragma once
#include <cstdio>
#include <string>

#include <fcntl.h>
#include <unistd.h>

namespace tdpt {

inline void say(const std::string& line) {
  std::fputs((line + "\n").c_str(), stderr);
}

/// A program that is started without standard streams gets empty ones, so that no file it opens
/// takes their place.
inline void open_standard_streams() {
  int fd = 0;
  while (fd >= 0 && fd <= 2) fd = ::open("/dev/null", O_RDWR);
  if (fd > 2) ::close(fd);
}

}  // namespace tdpt
