// The files of a scene, what is lost of them, and the account of their keys.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"

namespace tdpt::foreign {

/// A place in a file, as messages name it.
struct Place {
  std::string file;   ///< as displayed
  std::string where;  ///< "line 45", "primitives[3].emission"
};

class Source;

/// A key of the scene's files: a member of an object, a parameter, an attribute. It is entered when
/// it is parsed and taken by whoever reads its value [Source::enter].
class Key {
 public:
  Key() = default;  ///< of no file
  void take() const;

 private:
  friend class Source;
  Source* source_ = nullptr;
  size_t number_ = 0;
};

/// Reads the scene's files and remembers them, and collects what is lost.
class Source {
 public:
  /// `path`: the scene file; its folder is all that is read.
  explicit Source(const std::string& path, bool allow_missing = false);

  const std::string& path() const { return path_; }
  /// The scene file itself.
  const std::string& text() const { return text_; }

  /// Contents of the file called `name` by the scene, relative to its folder or to one of the
  /// search paths. Backslashes count as slashes. Throws InputError naming `place` if it lies
  /// outside the scene's folder or is missing.
  std::string read(const std::string& name, const Place& place);
  /// Reads a picture or a mesh in the same way. If it is missing and this is allowed, it is named
  /// as lost; a picture of one grey texel, or nothing, stands in for it.
  std::string read_picture(const std::string& name, const Place& place);
  std::optional<std::string> read_mesh(const std::string& name, const Place& place);
  /// Whether there is such a file.
  bool has(const std::string& name, const Place& place);
  /// Name in messages of a file that read() was given: beside the scene's own path.
  std::string shown_name(const std::string& name) const;
  /// A folder, relative to that of the scene, which read() tries before the others. One outside
  /// is named as lost and not searched.
  void search(const std::string& folder, const Place& place);

  /// Says that something of the scene is lost. The same sentence again only counts.
  void lose(const Place& place, const std::string& sentence);

  /// Names paths of more than so many edges as lost, unless they hold next to no light.
  void lose_longer_paths(const Place& place, double edges);
  /// Enters a key into the account. `sentence` is what is lost if nobody takes it; empty: nothing.
  /// `holder` is the key in whose value this one stands: if nobody takes that, nobody misses this.
  Key enter(const Key& holder, const Place& place, const std::string& sentence);
  /// Names the keys that nobody took as lost.
  void lose_unread();

  struct Loss {
    std::string sentence;
    Place first;
    size_t times = 1;
  };
  const std::vector<Loss>& losses() const { return losses_; }
  struct File {
    std::string path, hash;
  };
  /// All that were read, the scene first.
  const std::vector<File>& files() const { return files_; }

  [[noreturn]] static void fail(const Place& place, const std::string& message) {
    throw InputError(place.file, place.where, message);
  }

 private:
  friend class Key;
  LocalFile found(const std::string& name, const Place& place) const;
  std::optional<std::string> read_if_there(const std::string& name, const Place& place,
                                           const char* otherwise);

  std::string path_, folder_, text_;
  bool allow_missing_;
  std::vector<std::string> searched_;
  std::vector<Loss> losses_;
  std::map<std::string, size_t> lost_;
  std::vector<File> files_;
  struct Unread {
    size_t holder;
    Place place;
    std::string sentence;
  };
  std::map<size_t, Unread> unread_;  // of keys that nobody took yet, in their order in the files
  size_t entered_ = 0;
};

}  // namespace tdpt::foreign
