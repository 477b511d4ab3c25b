// Files that a scene names. A scene may be untrusted, so it has access only to itself and to files
// in its own folder or below.
#pragma once
#include <string>

#include "libcommon/base/error.h"

namespace tdpt {

/// A name or URI that may be followed but leads to nothing; `what_is`, for a sentence about it: "a
/// file that is not there".
struct NothingThere : InputError {
  NothingThere(const InputError& error, std::string what_) : InputError(error), what_is(what_) {}
  std::string what_is;
};

/// The scene that names a file: its name in messages, and its folder; empty: it comes from standard
/// input and may name none.
struct Namer {
  std::string file, folder;
};

struct LocalFile {
  std::string path;  ///< the folder joined with the name
  std::string real;  ///< with symbolic links resolved
};

/// The file called `name`, a path relative to the scene's folder. Throws InputError if it lies
/// outside that folder, also by links, and NothingThere if it is missing. An existing file must be
/// a regular one.
LocalFile local_file(const Namer& namer, const std::string& name, const std::string& place);

/// The folder of the scene `path`; "" for standard input.
std::string folder_of(const std::string& path);

}  // namespace tdpt
