#include "libcommon/base/local_file.h"

#include <fmt/format.h>
#include <algorithm>
#include <filesystem>

#include "libcommon/base/shown.h"

namespace tdpt {
namespace {

namespace fs = std::filesystem;

bool is_below(const fs::path& file, const fs::path& folder) {
  const auto [rest, unused] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return rest == folder.end();
}

[[noreturn]] void nothing(const Namer& namer, const std::string& where, const std::string& message,
                          const std::string& what_is) {
  throw NothingThere(InputError(namer.file, where, message), what_is);
}

}  // namespace

LocalFile local_file(const Namer& namer, const std::string& name, const std::string& where) {
  const auto fail = [&](const std::string& message) {
    throw InputError(namer.file, where, message);
  };
  const std::string quoted = "\"" + shown(name) + "\"";
  const size_t colon = name.find(':'), slash = name.find_first_of("/?#");
  bool outside = name.empty() || name.front() == '/' ||
                 name.find_first_of(std::string_view("\\\0", 2)) != name.npos ||
                 (colon != name.npos && colon < slash);
  std::error_code error;
  const fs::path folder = fs::canonical(namer.folder, error);
  outside = outside || !is_below((folder / name).lexically_normal(), folder);
  if (outside) fail(quoted + " is not a file in the scene's folder, which is all that is read");
  if (namer.folder.empty())
    fail(quoted + " is another file, expected a scene in one piece on standard input");
  const fs::path file = fs::canonical(folder / name, error);
  if (error)
    nothing(namer, where, quoted + " cannot be opened: " + error.message(),
            "a file that is missing, " + quoted);
  if (!is_below(file, folder))
    fail(quoted + " leads out of the scene's folder, which is all that is read");
  if (!fs::is_regular_file(file, error)) fail(quoted + " is no regular file");
  return {(fs::path(namer.folder) / name).lexically_normal().string(), file.string()};
}

std::string folder_of(const std::string& path) {
  if (path == "-") return "";
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

}  // namespace tdpt
