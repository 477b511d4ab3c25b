// The folder where tdpt keeps its results: a cache, shared by concurrent runs and by all scenes.
//
//   CACHEDIR.TAG       marks a cache for backup programs (bford.info/cachedir), and holds the
//                      version of the format; without it nothing is removed from a folder, which
//                      may be anybody's
//   portals-KEY/       what the four stages made; KEY: hash of everything that affects it
//   picture-KEY/       the film of a picture; KEY: hash of the picture's path
//   known-KEY          of a picture, who made it; of a scene, which files it reads; KEY: hash of
//                      its bytes
//
// A run locks the file `lock` in each entry that it uses, so that no other run writes or removes
// it.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

namespace tdpt {

/// An entry, locked while this object lives; when the process ends the system releases it.
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

  /// Default for --work: the user's cache folder by the XDG base directory specification. Throws
  /// UsageError if there is none.
  static std::string usual_path();

  std::string path_of(const std::string& name) const { return path_ + "/" + name; }

  enum class For { writing, reading };
  /// Locks the entry of that name, creating it and the folder if necessary. Throws OutputError if
  /// that fails. While another run holds it, `waits` is called now and then, and may throw. A lock
  /// for writing is exclusive.
  HeldEntry hold(const std::string& name, For what, const std::function<void()>& waits) const;

  /// Creates the folder if necessary. Throws OutputError if that fails, and UsageError for a folder
  /// with other contents.
  void make() const;
  /// Throws UsageError for a folder with other contents, OutputError for what is no folder. None is
  /// none.
  void check_has_no_others() const;

  /// What is stored for bytes with that hash; nothing if unknown.
  std::optional<std::string> known(const std::string& hash) const;
  /// Stores it. Returns whether that succeeded: not without a folder, or room in it.
  bool know(const std::string& hash, const std::string& text) const;

  /// Whether the folder is tdpt's, and not another of that name. Throws InputError, as do all
  /// functions that use this, if it has another version.
  bool is_ours() const;
  /// Removes unlocked entries, least recently used first, until the total is at most `bytes`. Does
  /// nothing to a folder that is not ours.
  void shrink_to(uint64_t bytes) const;

 private:
  std::string path_;
};

}  // namespace tdpt
