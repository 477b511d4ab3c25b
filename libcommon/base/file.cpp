#include "libcommon/base/file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "libcommon/base/words.h"

namespace tdpt {

std::string display_name(const std::string& path) {
  return path == "-" ? "(standard input)" : path;
}

namespace {

constexpr size_t kBlock = 1 << 16;

// Whether a stream that begins so may never end: binary data of no kind that is read here
// (/dev/zero), or one line over and over (yes).
bool is_noise(std::string_view beginning) {
  for (const char* magic : {"glTF", "\x76\x2f\x31\x01", " BDV", "#?"})  // glTF, EXR, VDB, HDR
    if (beginning.starts_with(magic)) return false;
  const size_t line = std::min(beginning.find('\n'), beginning.size() - 1) + 1;
  return beginning.find('\0') != beginning.npos ||
         (beginning.size() == kBlock && line < kBlock / 2 &&
          beginning.substr(line) == beginning.substr(0, kBlock - line));
}

}  // namespace

std::string read_file(const std::string& path) {
  const bool standard_input = path == "-";
  std::FILE* file = standard_input ? stdin : std::fopen(path.c_str(), "rb");
  if (!file) throw InputError(path, "", std::string("cannot be opened: ") + std::strerror(errno));
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> closer(standard_input ? nullptr : file,
                                                         std::fclose);
  struct stat info {};
  const bool known = ::fstat(::fileno(file), &info) == 0;
  if (known && S_ISDIR(info.st_mode))
    throw InputError(display_name(path), "", "is a folder, expected a file");
  const bool ends = known && S_ISREG(info.st_mode);
  const auto expect_room = [&](uint64_t size) {
    if (size > memory_limit())
      throw InputError(display_name(path), "",
                       "is larger than the " + size_words(memory_limit()) + " of --max-memory");
  };
  std::string bytes;
  if (ends) {
    expect_room(static_cast<uint64_t>(info.st_size));
    bytes.reserve(static_cast<size_t>(info.st_size));
  }
  char buffer[kBlock];
  for (size_t n; (n = std::fread(buffer, 1, sizeof buffer, file)) > 0;) {
    // A string that grows is there twice while it is copied.
    const bool grows = bytes.size() + n > bytes.capacity();
    expect_room(bytes.size() + n + (grows ? bytes.capacity() : 0));
    const bool is_first = bytes.empty();
    bytes.append(buffer, n);
    if (is_first && !ends && is_noise(bytes)) break;
  }
  if (std::ferror(file))
    throw InputError(display_name(path), "",
                     std::string("cannot be read: ") + std::strerror(errno));
  return bytes;
}

namespace {

constexpr std::string_view kPrefixes = "KMGT";

uint64_t three_quarters_of_the_machine() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), size = ::sysconf(_SC_PAGESIZE);
  if (pages <= 0 || size <= 0) return uint64_t{1} << 32;
  return static_cast<uint64_t>(pages) * static_cast<uint64_t>(size) / 4 * 3;
}

std::atomic<uint64_t>& limit() {
  static std::atomic<uint64_t> bytes{three_quarters_of_the_machine()};
  return bytes;
}

}  // namespace

uint64_t memory_limit() {
  return limit();
}

void limit_memory(uint64_t bytes) {
  limit() = bytes;
}

std::string size_words(uint64_t bytes) {
  if (bytes < 1024) return counted(bytes, "byte");
  double size = static_cast<double>(bytes) / 1024;
  size_t prefix = 0;
  for (; size >= 1000 && prefix + 1 < kPrefixes.size(); ++prefix) size /= 1024;
  return fmt::format("{} {}iB", number_words(size), kPrefixes[prefix]);
}

std::optional<uint64_t> parse_size(std::string_view text) {
  double value = 0;
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value, std::chars_format::fixed);
  if (error != std::errc() || last - end > 1) return {};
  if (end != last) {
    const size_t prefix = kPrefixes.find(*end);
    if (prefix == kPrefixes.npos) return {};
    value = std::ldexp(value, 10 * (static_cast<int>(prefix) + 1));
  }
  if (!(value >= 1 && value < 0x1p63)) return {};
  return static_cast<uint64_t>(value);
}

namespace {

// Empty where it is no excess.
std::string excess_of(const std::string& what, uint64_t bytes) {
  if (bytes <= limit()) return "";
  return fmt::format("{} take {} of memory, expected at most the {} of --max-memory", what,
                     size_words(bytes), size_words(limit()));
}

}  // namespace

void expect_memory(const std::string& file, const std::string& place, const std::string& what,
                   uint64_t bytes) {
  if (const std::string excess = excess_of(what, bytes); !excess.empty())
    throw InputError(file, place, excess);
}

void expect_memory(const std::string& what, uint64_t bytes) {
  if (const std::string excess = excess_of(what, bytes); !excess.empty()) throw UsageError(excess);
}

namespace {

namespace fs = std::filesystem;

bool is_below(const fs::path& file, const fs::path& folder) {
  const auto [rest, unused] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return rest == folder.end();
}

[[noreturn]] void nothing(const Namer& namer, const std::string& where, const std::string& message,
                          const std::string& what_is) {
  throw NothingThere(InputError(namer.file, where, message), what_is);
}

}  // namespace

LocalFile local_file(const Namer& namer, const std::string& name, const std::string& where) {
  const auto fail = [&](const std::string& message) {
    throw InputError(namer.file, where, message);
  };
  const std::string quoted = "\"" + shown(name) + "\"";
  const size_t colon = name.find(':'), slash = name.find_first_of("/?#");
  bool outside = name.empty() || name.front() == '/' ||
                 name.find_first_of(std::string_view("\\\0", 2)) != name.npos ||
                 (colon != name.npos && colon < slash);
  std::error_code error;
  const fs::path folder = fs::canonical(namer.folder, error);
  outside = outside || !is_below((folder / name).lexically_normal(), folder);
  if (outside) fail(quoted + " is not a file in the scene's folder, which is all that is read");
  if (namer.folder.empty())
    fail(quoted + " is another file, expected a scene in one piece on standard input");
  const fs::path file = fs::canonical(folder / name, error);
  if (error)
    nothing(namer, where, quoted + " cannot be opened: " + error.message(),
            "a file that is missing, " + quoted);
  if (!is_below(file, folder))
    fail(quoted + " leads out of the scene's folder, which is all that is read");
  if (!fs::is_regular_file(file, error)) fail(quoted + " is no regular file");
  return {(fs::path(namer.folder) / name).lexically_normal().string(), file.string()};
}

std::string folder_of(const std::string& path) {
  if (path == "-") return "";
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

bool nested_too_deep(std::string_view json) {
  int depth = 0;
  bool in_text = false;
  for (size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_text) {
      if (c == '\\') ++i;
      if (c == '"') in_text = false;
    } else if (c == '"') {
      in_text = true;
    } else if (c == '{' || c == '[') {
      if (++depth > 32) return true;
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return false;
}

}  // namespace tdpt
