#include "tools/tdpt-import/source.h"

#include <algorithm>
#include <filesystem>

#include "libcommon/base/file.h"
#include "libcommon/base/hash.h"
#include "libcommon/base/local_file.h"
#include "libcommon/base/shown.h"

namespace tdpt::foreign {
namespace {

namespace fs = std::filesystem;

std::string with_slashes(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

}  // namespace

Source::Source(const std::string& path) : path_(path), folder_(folder_of(path)) {
  text_ = read_file(path);
  files_.push_back({path, content_hash(text_)});
}

std::string Source::found(const std::string& name, const Place& place, std::string& real) const {
  const Namer namer{place.file, folder_};
  for (auto folder = searched_.rbegin(); folder != searched_.rend(); ++folder) {
    try {
      const LocalFile file = local_file(
          namer, (fs::path(*folder) / with_slashes(name)).lexically_normal().string(), place.where);
      real = file.real;
      return file.path;
    } catch (const NothingThere&) {
    }
  }
  const LocalFile file = local_file(namer, with_slashes(name), place.where);
  real = file.real;
  return file.path;
}

std::string Source::read(const std::string& name, const Place& place) {
  std::string real;
  const std::string file = found(name, place, real);
  std::string bytes;
  try {
    bytes = read_file(real);
  } catch (const InputError&) {
    fail(place, "\"" + shown(name) + "\" cannot be read");
  }
  if (std::none_of(files_.begin(), files_.end(), [&](const File& f) { return f.path == file; }))
    files_.push_back({file, content_hash(bytes)});
  return bytes;
}

bool Source::has(const std::string& name, const Place& place) {
  try {
    std::string real;
    found(name, place, real);
    return true;
  } catch (const NothingThere&) {
    return false;
  }
}

std::string Source::shown_name(const std::string& name) const {
  return shown((fs::path(folder_ == "." ? "" : folder_) / with_slashes(name)).string(), 200);
}

void Source::search(const std::string& folder, const Place& place) {
  const fs::path normal = fs::path(with_slashes(folder)).lexically_normal();
  if (normal.is_absolute() || (!normal.empty() && *normal.begin() == ".."))
    return lose(place, "the search path \"" + shown(folder) +
                           "\" leads out of the scene's folder and is not searched");
  searched_.push_back(normal.string());
}

void Source::lose(const Place& place, const std::string& sentence) {
  const auto [it, is_new] = lost_.try_emplace(sentence, losses_.size());
  if (is_new)
    losses_.push_back({sentence, place});
  else
    ++losses_[it->second].times;
}

}  // namespace tdpt::foreign
