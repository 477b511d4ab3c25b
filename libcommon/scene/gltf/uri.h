// Resolves names of files in a scene. Internal to this room.
#pragma once
#include <string>
#include <string_view>

#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

/// "%20" becomes a blank, and so on.
std::string percent_decode(std::string_view text);

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

}  // namespace tdpt::gltf
