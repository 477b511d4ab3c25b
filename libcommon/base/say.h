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

/// Opens the standard streams that are closed, so that no file that the program opens takes their
/// place: the wrong way round, so that whoever reads or writes one still fails.
inline void open_standard_streams() {
  for (int fd = 0; fd <= 2; ++fd)
    if (::fcntl(fd, F_GETFD) < 0) (void)::open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY);
}

}  // namespace tdpt
