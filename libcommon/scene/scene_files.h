// Which files a scene is made of, for programs that ask whether it has changed and read it no
// further.
#pragma once
#include <string>
#include <vector>

namespace tdpt {

/// Names of the files that a glTF scene says it reads beside itself, buffers, images and the
/// environment of its extras, each once, relative to its folder and whether they are there or not.
/// Only its JSON is looked at: a scene that is wrong has none, and its readers say why. Throws
/// InputError where the file itself cannot be read.
std::vector<std::string> files_beside(const std::string& scene);

}  // namespace tdpt
