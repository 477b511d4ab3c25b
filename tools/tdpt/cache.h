// The folder where tdpt keeps its results: a cache, shared by concurrent runs and by all scenes.
//
//   CACHEDIR.TAG       marks a cache for backup programs (bford.info/cachedir); without it nothing
//                      is removed from a folder, which may be anybody's
//   portals-KEY/       what the four stages made; KEY: hash of everything that affects it
//   film-KEY/          samples of a picture, to which others are added; KEY: hash of everything
//                      that affects a sample
//   picture-KEY/       samples of a picture whose end is not yet known, or frames of a shot
//   known-HASH         keys of what made a file with this hash of its bytes, one per line
//   run-NAME/          files of a run, until it ends
//
// Each file appears when it is whole, and depends on the key alone: runs need not know of each
// other, and at worst make the same thing twice.
#pragma once
#include <cstdint>
#include <string>
#include <utility>

namespace tdpt {

class Cache {
 public:
  explicit Cache(std::string path) : path_(std::move(path)) {}

  /// Default for --work: the user's cache folder by the XDG base directory specification. Throws
  /// UsageError if there is none.
  static std::string usual_path();

  std::string path_of(const std::string& name) const { return path_ + "/" + name; }
  /// Creates the entry of that name, and the folder, if necessary, and marks it as just used.
  /// Returns its path. Throws OutputError if that fails, and UsageError for a folder with other
  /// contents.
  std::string use(const std::string& name) const;

  /// Throws UsageError for a folder with other contents, OutputError for what is no folder. None is
  /// none.
  void check_has_no_others() const;

  /// Stores that bytes with this hash were made as `key` says. Throws OutputError.
  void know(const std::string& hash, const std::string& key) const;
  /// Whether that is stored; of any key if it is empty.
  bool knows(const std::string& hash, const std::string& key) const;

  /// Removes entries, least recently used first, until the total is at most `bytes`, and what
  /// killed runs left. Does nothing to a folder that is not tdpt's.
  void shrink_to(uint64_t bytes) const;

 private:
  bool is_ours() const;
  std::string path_;
};

}  // namespace tdpt
