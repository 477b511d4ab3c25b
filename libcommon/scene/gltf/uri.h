// Files that a scene names. Internal to this room.
#pragma once
#include <string>
#include <string_view>

#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

/// "%20" becomes a blank, and so on.
std::string percent_decode(std::string_view text);

/// Who names a file: what messages call the scene, and the folder it lies in; empty: it comes from
/// standard input, and may name none.
struct Namer {
  std::string file, folder;
};

struct LocalFile {
  std::string path;  ///< from the folder, as it is named
  std::string real;  ///< without links
};

/// The file called `name`, a path from the scene's folder. Throws InputError where it lies outside
/// of that, also by links, NothingThere where it is missing; what is there is a regular file.
LocalFile local_file(const Namer& namer, const std::string& name, const std::string& place);

/// The folder of the scene `path`; "" for standard input.
std::string folder_of(const std::string& path);

}  // namespace tdpt::gltf
