#include "libcommon/cli/outputs.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"

namespace tdpt::cli {
namespace {

/// Identity of the file at a path, whether it exists or not.
struct FileIdentity {
  std::optional<std::pair<dev_t, ino_t>> file;
  std::filesystem::path full;  ///< with links and dots resolved; empty for standard streams

  bool operator==(const FileIdentity& other) const {
    return (file && file == other.file) || (!full.empty() && full == other.full);
  }
};

// `stream`: what "-" stands for. It counts as the file that it is redirected to; a terminal, a pipe
// or /dev/null counts as no file.
FileIdentity place_of(const std::string& path, int stream) {
  FileIdentity place;
  struct stat info {};
  if (path == "-") {
    if (::fstat(stream, &info) == 0 && S_ISREG(info.st_mode))
      place.file = {info.st_dev, info.st_ino};
    return place;
  }
  if (::stat(path.c_str(), &info) == 0) place.file = {info.st_dev, info.st_ino};
  std::error_code ignored;
  place.full = std::filesystem::weakly_canonical(std::filesystem::absolute(path, ignored), ignored);
  return place;
}

}  // namespace

void check_outputs(const std::vector<NamedFile>& outputs) {
  std::vector<FileIdentity> taken;
  for (const NamedFile& output : outputs) {
    if (output.path == "-" && output.option != "-o")
      throw UsageError(output.option + " -: cannot go to the standard output, name a file");
    const FileIdentity place = place_of(output.path, STDOUT_FILENO);
    if (std::find(taken.begin(), taken.end(), place) != taken.end())
      throw UsageError("two outputs would be written to " + output.path);
    check_output(output.path);
    taken.push_back(place);
  }
}

void check_outputs(const std::vector<NamedFile>& outputs, const std::vector<std::string>& inputs) {
  for (const NamedFile& output : outputs)
    for (const std::string& input : inputs)
      if (place_of(input, STDIN_FILENO) == place_of(output.path, STDOUT_FILENO))
        throw UsageError(output.option + " " + output.path + " would replace the input " +
                         display_name(input));
}

std::string png_beside(const std::string& picture) {
  if (picture == "-") throw UsageError("--preview puts a PNG beside the picture: give -o FILE");
  const size_t dot = picture.find_last_of('.');
  const size_t slash = picture.find_last_of('/');
  const bool has_suffix = dot != std::string::npos && (slash == std::string::npos || dot > slash);
  return (has_suffix ? picture.substr(0, dot) : picture) + ".png";
}

}  // namespace tdpt::cli
