#include "tools/tdpt/work_folder.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/formats/format_version.h"

namespace tdpt {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTag =
    "Signature: 8a477f597d28d172789f06886806bc55\n"
    "# This is the cache of tdpt; `tdpt --clean` empties it.\n";
constexpr const char* kVersionKey = "# Version of its format: ";
constexpr int kVersion = 1;
constexpr size_t kMostKnown = 10000;  // of known-KEY files, some hundred bytes each

[[noreturn]] void fail(const std::string& path, int error) {
  throw OutputError(path, std::string("cannot be made: ") + std::strerror(error));
}

enum class Locked { yes, by_another, never };  // never: the file system has no locks

Locked lock(int fd, int how) {
  while (::flock(fd, how | LOCK_NB) != 0) {
    if (errno == EINTR) continue;
    return errno == EWOULDBLOCK ? Locked::by_another : Locked::never;
  }
  return Locked::yes;
}

std::string lock_in(const std::string& entry) {
  return entry + "/lock";
}

// Whether the path still leads to the open file: it may have been removed and created anew.
bool is_still_there(int fd, const std::string& path) {
  struct stat open {
  }, there{};
  return ::fstat(fd, &open) == 0 && ::stat(path.c_str(), &there) == 0 &&
         open.st_ino == there.st_ino && open.st_dev == there.st_dev;
}

// Whether the name is `prefix` and a hash.
bool is_keyed(const std::string& name, const char* prefix) {
  const std::string_view key =
      std::string_view(name).substr(std::min(std::strlen(prefix), name.size()));
  return name.starts_with(prefix) && key.size() == 32 &&
         key.find_first_not_of("0123456789abcdef") == key.npos;
}

bool is_entry(const std::string& name) {
  return is_keyed(name, "portals-") || is_keyed(name, "picture-");
}

uint64_t size_of(const fs::path& folder) {
  uint64_t bytes = 0;
  std::error_code failed;
  if (!fs::is_directory(folder, failed)) return 0;
  for (const auto& file : fs::recursive_directory_iterator(folder, failed)) {
    const uintmax_t size = file.is_regular_file(failed) ? file.file_size(failed) : 0;
    if (!failed) bytes += size;
  }
  return bytes;
}

struct Used {
  fs::path path;
  fs::file_time_type when;
  uint64_t bytes;
};

// Entries whose names satisfy `is`, the oldest first.
std::vector<Used> all_in(const std::string& folder, bool (*is)(const std::string&)) {
  std::vector<Used> all;
  std::error_code failed;
  for (const auto& one : fs::directory_iterator(folder, failed)) {
    if (!is(one.path().filename().string())) continue;
    const auto when = one.last_write_time(failed);
    if (!failed) all.push_back({one.path(), when, size_of(one.path())});
  }
  std::sort(all.begin(), all.end(), [](const Used& a, const Used& b) { return a.when < b.when; });
  return all;
}

void remove_unless_held(const fs::path& path) {
  const std::string file = lock_in(path.string());
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (fd < 0) return;
  std::error_code ignored;
  if (lock(fd, LOCK_EX) == Locked::yes && is_still_there(fd, file)) fs::remove_all(path, ignored);
  ::close(fd);
}

}  // namespace

HeldEntry::HeldEntry(HeldEntry&& other) noexcept
    : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)) {}

HeldEntry& HeldEntry::operator=(HeldEntry&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(fd_, other.fd_);
  return *this;
}

HeldEntry::~HeldEntry() {
  if (fd_ >= 0) ::close(fd_);
}

std::string WorkFolder::usual_path() {
  for (const auto& [variable, below] :
       {std::pair("XDG_CACHE_HOME", "/tdpt"), {"HOME", "/.cache/tdpt"}})
    if (const char* value = std::getenv(variable); value && *value == '/')
      return std::string(value) + below;
  throw UsageError("neither XDG_CACHE_HOME nor HOME says where caches are: give --work FOLDER");
}

void WorkFolder::make() const {
  std::error_code failed;
  fs::create_directories(path_, failed);
  if (failed) fail(path_, failed.value());
  if (is_ours()) return;
  check_has_no_others();
  write_output(path_ + "/CACHEDIR.TAG", fmt::format("{}{}{}\n", kTag, kVersionKey, kVersion));
}

void WorkFolder::check_has_no_others() const {
  std::error_code failed;
  if (is_ours() || !fs::exists(path_, failed)) return;
  for (const auto& file : fs::directory_iterator(path_, failed))
    if (file.path().filename() != "CACHEDIR.TAG" &&
        !file.path().filename().string().starts_with(".tdpt-"))  // a starting run's
      throw UsageError("--work " + path_ +
                       ": has other things in it, expected a folder of its own");
  if (failed) throw OutputError(path_, "cannot be listed: " + failed.message());
}

bool WorkFolder::is_ours() const {
  const std::string path = path_ + "/CACHEDIR.TAG";
  std::string tag;
  try {
    tag = read_file(path);
  } catch (const InputError&) {
    return false;
  }
  if (!tag.starts_with(kTag)) return false;
  const size_t at = tag.find(kVersionKey);
  if (at == tag.npos) return true;  // the first version
  const std::string version = tag.substr(at + std::strlen(kVersionKey));
  check_version(path, "", version.substr(0, version.find('\n')), kVersion);
  return true;
}

HeldEntry WorkFolder::hold(const std::string& name, For what,
                           const std::function<void()>& waits) const {
  make();
  const std::string path = path_of(name);
  const int how = what == For::writing ? LOCK_EX : LOCK_SH;
  // It may be removed and created anew in between; after many tries it is something else.
  for (int tries = 0;; ++tries) {
    if (::mkdir(path.c_str(), 0777) != 0 && errno != EEXIST) fail(path, errno);
    const std::string file = lock_in(path);
    const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (fd < 0 && errno == ENOENT && tries < 1000) continue;
    if (fd < 0) fail(path, errno);
    HeldEntry entry(path, fd);
    while (lock(fd, how) == Locked::by_another) {
      waits();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    if (!is_still_there(fd, file)) continue;
    ::utimensat(AT_FDCWD, path.c_str(), nullptr, 0);  // marks it as just used
    return entry;
  }
}

std::optional<std::string> WorkFolder::known(const std::string& hash) const {
  if (!is_ours()) return {};
  const std::string path = path_ + "/known-" + hash;
  try {
    std::string text = read_file(path);
    ::utimensat(AT_FDCWD, path.c_str(), nullptr, 0);
    return text;
  } catch (const InputError&) {
    return {};
  }
}

bool WorkFolder::know(const std::string& hash, const std::string& text) const {
  if (!is_ours()) return false;
  try {
    write_output(path_ + "/known-" + hash, text);
    return true;
  } catch (const OutputError&) {
    return false;
  }
}

void WorkFolder::shrink_to(uint64_t most) const {
  if (!is_ours()) return;
  const std::vector<Used> entries = all_in(path_, is_entry);
  uint64_t bytes = 0;
  for (const Used& one : entries) bytes += one.bytes;
  for (const Used& one : entries) {
    if (bytes <= most) break;
    remove_unless_held(one.path);
    std::error_code failed;
    if (!fs::exists(one.path, failed)) bytes -= one.bytes;
  }
  const std::vector<Used> known =
      all_in(path_, [](const std::string& name) { return is_keyed(name, "known-"); });
  std::error_code ignored;
  const auto hour_ago = fs::file_time_type::clock::now() - std::chrono::hours(1);
  for (const Used& left :
       all_in(path_, [](const std::string& name) { return name.starts_with(".tdpt-"); }))
    if (left.when < hour_ago) fs::remove(left.path, ignored);
  for (size_t i = 0; i + kMostKnown < known.size(); ++i) fs::remove(known[i].path, ignored);
}

}  // namespace tdpt
