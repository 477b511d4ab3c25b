#include "tools/tdpt-import/source.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"

namespace tdpt::foreign {
namespace {

namespace fs = std::filesystem;

std::string with_slashes(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

void drop_byte_order_mark(std::string& bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.erase(0, 3);
}

}  // namespace

Source::Source(const std::string& path, bool allow_missing)
    : path_(path), folder_(folder_of(path)), allow_missing_(allow_missing) {
  text_ = read_file(path);
  files_.push_back({path, content_hash(text_)});
  drop_byte_order_mark(text_);
}

LocalFile Source::found(const std::string& name, const Place& place) const {
  const Namer namer{place.file, folder_};
  for (auto folder = searched_.rbegin(); folder != searched_.rend(); ++folder) {
    try {
      return local_file(namer, (fs::path(*folder) / with_slashes(name)).lexically_normal().string(),
                        place.where);
    } catch (const NothingThere&) {
    }
  }
  return local_file(namer, with_slashes(name), place.where);
}

std::string Source::read(const std::string& name, const Place& place) {
  const auto [path, real] = found(name, place);
  std::string bytes;
  try {
    bytes = read_file(real);
  } catch (const InputError&) {
    fail(place, "\"" + shown(name) + "\" cannot be read");
  }
  if (std::none_of(files_.begin(), files_.end(),
                   [&p = path](const File& f) { return f.path == p; }))
    files_.push_back({path, content_hash(bytes)});
  drop_byte_order_mark(bytes);
  return bytes;
}

std::optional<std::string> Source::read_if_there(const std::string& name, const Place& place,
                                                 const char* otherwise) {
  try {
    return read(name, place);
  } catch (const NothingThere& error) {
    if (!allow_missing_)
      throw InputError(std::string(error.what()) + " (--allow-missing goes on without it)");
  }
  lose(place, "\"" + shown(name) + "\" is missing: " + otherwise);
  return {};
}

std::string Source::read_picture(const std::string& name, const Place& place) {
  const std::string half("\0\0\0\x3f", 4);  // 0.5
  return read_if_there(name, place, "grey of 0.5 in its place, or no normal map")
      .value_or("PF\n1 1\n-1\n" + half + half + half);
}

std::optional<std::string> Source::read_mesh(const std::string& name, const Place& place) {
  return read_if_there(name, place, "what shows it is left out");
}

bool Source::has(const std::string& name, const Place& place) {
  try {
    found(name, place);
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

void Source::lose_longer_paths(const Place& place, double edges) {
  constexpr double kMany = 64;  // longer ones hold 0.1 % of the light in a room of albedo 0.9
  if (edges >= 0 && edges < kMany)
    lose(place, fmt::format("the source leaves out light on paths of more than {0:.0f} edges, this "
                            "program does not: give --max-depth {0:.0f} to tdpt",
                            edges));
}

Key Source::enter(const Key& holder, const Place& place, const std::string& sentence) {
  Key key;
  key.source_ = this;
  key.number_ = ++entered_;
  unread_.emplace_hint(unread_.end(), key.number_, Unread{holder.number_, place, sentence});
  return key;
}

void Key::take() const {
  if (source_) source_->unread_.erase(number_);
}

void Source::lose_unread() {
  for (const auto& [number, key] : unread_)
    if (!key.sentence.empty() && !unread_.contains(key.holder)) lose(key.place, key.sentence);
  unread_.clear();
}

}  // namespace tdpt::foreign
