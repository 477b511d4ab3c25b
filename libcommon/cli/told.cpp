#include "libcommon/cli/told.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cstdlib>

namespace tdpt::cli {
namespace {

/// Locked while open: stages of several scenes may run at once.
class LockedFile {
 public:
  explicit LockedFile(const char* path)
      : fd_(open(path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NONBLOCK, 0666)) {
    struct stat is {};
    locked_ = fd_ >= 0 && fstat(fd_, &is) == 0 && S_ISREG(is.st_mode) && flock(fd_, LOCK_EX) == 0;
  }
  ~LockedFile() {
    if (fd_ >= 0) close(fd_);
  }
  LockedFile(const LockedFile&) = delete;
  LockedFile& operator=(const LockedFile&) = delete;

  bool read(std::string& text) const {
    if (!locked_) return false;
    char part[4096];
    for (;;) {
      const ssize_t n = ::read(fd_, part, sizeof part);
      if (n <= 0) return n == 0;
      text.append(part, static_cast<size_t>(n));
    }
  }
  void append(const std::string& text) const {
    // If this fails, the message is printed again later.
    if (::write(fd_, text.data(), text.size()) < 0) return;
  }

 private:
  int fd_;
  bool locked_;
};

}  // namespace

bool is_news(const std::string& file, const std::string& sentence) {
  const char* path = std::getenv("TDPT_TOLD");
  if (!path || !*path) return true;
  std::string line = file + ": " + sentence;
  std::replace(line.begin(), line.end(), '\n', ' ');
  line += '\n';
  const LockedFile told(path);
  std::string known = "\n";
  if (!told.read(known)) return true;
  if (known.find('\n' + line) != known.npos) return false;
  told.append(line);
  return true;
}

}  // namespace tdpt::cli
