// The folder that tdpt keeps its work in: a cache, shared by runs side by side and by all scenes.
//
//   CACHEDIR.TAG       tells backup programs what this is (bford.info/cachedir), and us the version
//                      of the format; without it nothing is removed from a folder, which may be
//                      anybody's
//   portals-KEY/       what the four stages made; KEY: hash of all that shapes it
//   picture-KEY/       what an unfinished picture left; KEY: hash of the picture's path
//   known-KEY          of a picture, who made it; of a scene, which files it reads; KEY: hash of
//   its
//                      bytes
//
// A run holds the entries that it works with, by a lock on the file `lock` in each, so that no
// other writes or removes them.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

namespace tdpt {

/// An entry, held while this object lives, and with it by the process: the system lets it go
/// whenever that ends.
class HeldEntry {
 public:
  HeldEntry() = default;
  HeldEntry(std::string path, int descriptor) : path_(std::move(path)), fd_(descriptor) {}
  HeldEntry(HeldEntry&& other) noexcept;
  HeldEntry& operator=(HeldEntry&& other) noexcept;
  ~HeldEntry();
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int fd_ = -1;
};

class WorkFolder {
 public:
  explicit WorkFolder(std::string path) : path_(std::move(path)) {}

  /// Without --work: where the user's caches are by the XDG base directory specification. Throws
  /// UsageError where nothing says where that is.
  static std::string usual_path();

  std::string path_of(const std::string& name) const { return path_ + "/" + name; }

  enum class For { writing, reading };
  /// The entry of that name, made where it is not there, as is the folder. Throws OutputError where
  /// that fails. While another run holds it, `waits` is
  /// called now and then, and may throw. For writing it is held alone.
  HeldEntry hold(const std::string& name, For what, const std::function<void()>& waits) const;

  /// Makes the folder where it is not there. Throws OutputError where that fails, and UsageError
  /// for a folder that has other things in it.
  void make() const;

  /// What is known of the bytes with that hash; nothing where nothing is.
  std::optional<std::string> known(const std::string& hash) const;
  /// Whether it is kept: not where there is no folder yet, or no room in it.
  bool know(const std::string& hash, const std::string& text) const;

  /// Whether it is one, and not some folder of that name. Throws InputError, as all that asks this,
  /// for one of another version.
  bool is_ours() const;
  /// Removes what was used longest ago, and nobody holds, until all is no larger than `bytes`. Does
  /// nothing to a folder that is not ours.
  void shrink_to(uint64_t bytes) const;

 private:
  std::string path_;
};

}  // namespace tdpt
