#include "tools/tdpt/cache.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <vector>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"

namespace tdpt {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTag =
    "Signature: 8a477f597d28d172789f06886806bc55\n"
    "# This is the cache of tdpt; `tdpt --clean` empties it.\n";
constexpr size_t kMostKnown = 10000;  // of known-KEY files, some hundred bytes each

// Whether the name is `prefix` and a hash.
bool is_keyed(const std::string& name, const char* prefix) {
  const std::string_view key =
      std::string_view(name).substr(std::min(std::strlen(prefix), name.size()));
  return name.starts_with(prefix) && key.size() == 32 &&
         key.find_first_not_of("0123456789abcdef") == key.npos;
}

bool is_entry(const std::string& name) {
  return is_keyed(name, "portals-") || is_keyed(name, "film-") || is_keyed(name, "picture-");
}

bool is_known(const std::string& name) {
  return is_keyed(name, "known-");
}

bool is_of_run(const std::string& name) {
  return name.starts_with("run-") || name.starts_with(".tdpt-");
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

struct Entry {
  fs::path path;
  fs::file_time_type when;
  uint64_t bytes;
};

// Entries whose names satisfy `is`, the oldest first.
std::vector<Entry> all_in(const std::string& folder, bool (*is)(const std::string&)) {
  std::vector<Entry> all;
  std::error_code failed;
  for (const auto& one : fs::directory_iterator(folder, failed)) {
    if (!is(one.path().filename().string())) continue;
    const auto when = one.last_write_time(failed);
    if (!failed) all.push_back({one.path(), when, size_of(one.path())});
  }
  std::sort(all.begin(), all.end(), [](const Entry& a, const Entry& b) { return a.when < b.when; });
  return all;
}

}  // namespace

std::string Cache::usual_path() {
  for (const auto& [variable, below] :
       {std::pair("XDG_CACHE_HOME", "/tdpt"), {"HOME", "/.cache/tdpt"}})
    if (const char* value = std::getenv(variable); value && *value == '/')
      return std::string(value) + below;
  throw UsageError("neither XDG_CACHE_HOME nor HOME says where caches are: give --work FOLDER");
}

std::string Cache::use(const std::string& name) const {
  std::error_code failed, ignored;
  fs::create_directories(path_, failed);
  if (!failed && !is_ours()) {
    check_has_no_others();
    write_output(path_of("CACHEDIR.TAG"), kTag);
  }
  const std::string path = failed ? path_ : path_of(name);
  if (!failed) fs::create_directory(path, failed);
  if (failed) throw OutputError(path, "cannot be made: " + failed.message());
  fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);
  return path;
}

void Cache::check_has_no_others() const {
  std::error_code failed;
  if (is_ours() || !fs::exists(path_, failed)) return;
  for (const auto& file : fs::directory_iterator(path_, failed))
    if (file.path().filename() != "CACHEDIR.TAG" &&
        !file.path().filename().string().starts_with(".tdpt-") && !is_ours())  // a starting run's
      throw UsageError("--work " + path_ +
                       ": has other things in it, expected a folder of its own");
  if (failed) throw OutputError(path_, "cannot be listed: " + failed.message());
}

bool Cache::is_ours() const {
  try {
    return read_file(path_of("CACHEDIR.TAG")).starts_with(kTag);
  } catch (const InputError&) {
    return false;
  }
}

void Cache::know(const std::string& hash, const std::string& key) const {
  if (knows(hash, key)) return;
  const std::string path = path_of("known-" + hash);
  std::error_code failed;
  write_output(path, (fs::exists(path, failed) ? read_file(path) : "") + key + "\n");
}

bool Cache::knows(const std::string& hash, const std::string& key) const {
  std::error_code failed;
  const std::string path = path_of("known-" + hash);
  if (hash.empty() || !is_ours() || !fs::exists(path, failed)) return false;
  return key.empty() || ("\n" + read_file(path)).find("\n" + key + "\n") != std::string::npos;
}

void Cache::shrink_to(uint64_t most) const {
  if (!is_ours()) return;
  std::error_code ignored;
  const std::vector<Entry> entries = all_in(path_, is_entry);
  uint64_t bytes = 0;
  for (const Entry& one : entries) bytes += one.bytes;
  for (const Entry& one : entries) {
    if (bytes <= most) break;
    fs::remove_all(one.path, ignored);
    bytes -= one.bytes;
  }
  const std::vector<Entry> known = all_in(path_, is_known);
  for (size_t i = 0; i + kMostKnown < known.size(); ++i) fs::remove(known[i].path, ignored);
  const auto hour_ago = fs::file_time_type::clock::now() - std::chrono::hours(1);
  for (const Entry& run : all_in(path_, is_of_run))
    if (run.when < hour_ago) fs::remove_all(run.path, ignored);
}

}  // namespace tdpt
