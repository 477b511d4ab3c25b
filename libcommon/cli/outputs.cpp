#include "libcommon/cli/outputs.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/words.h"

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

namespace {

enum class Stands { as_target, as_prerequisite };

// GNU Make takes blanks, # and :, and the wildcards of file names, literally after a backslash;
// backslashes before such a one are doubled. A target with % would be a pattern, a prerequisite
// with | an order-only one. = and & begin an assignment and a group of targets, unless a function
// returns them. ~ is a home directory at the beginning only.
std::string make_name(const std::string& name, Stands stands) {
  const std::string_view quoted = stands == Stands::as_target ? " #:*?[]%" : " #:*?[]|";
  std::string text = name.starts_with('~') ? "./" : "";
  size_t backslashes = 0;
  for (const char c : name) {
    if (quoted.find(c) != std::string_view::npos) text += std::string(backslashes, '\\') + '\\';
    if (c == '=' || c == '&')
      text += std::string("$(if ,,") + c + ")";
    else if (c == '$')
      text += "$$";
    else
      text += c;
    backslashes = c == '\\' ? backslashes + 1 : 0;
  }
  return text;
}

}  // namespace

std::vector<std::string> without_short_forms(int argc, const char* const* argv) {
  std::vector<std::string> words;
  bool options = true;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    options &= word != "--";
    const bool file = word.starts_with("-MF"), target = word.starts_with("-MQ");
    if (!options || !(file || target)) {
      words.push_back(word);
      continue;
    }
    words.emplace_back(file ? "--set.dependencies" : "--set.dependencies-target");
    if (word.size() > 3) words.push_back(word.substr(3));
  }
  return words;
}

void check_make_name(const std::string& name) {
  const bool member = name.ends_with(')') && name.find('(') != std::string::npos;
  if (member || name.ends_with('\\') || name.find_first_of(";\t\n\r") != std::string::npos)
    throw UsageError("-MF: Make has no way to write the name " + shown(name, 200));
}

std::string make_rule(const std::string& target, const std::vector<std::string>& read) {
  std::vector<std::string> files;
  for (const std::string& file : read)
    if (file != "-" && std::find(files.begin(), files.end(), file) == files.end())
      files.push_back(file);
  std::string text = make_name(target, Stands::as_target) + ":";
  for (const std::string& file : files)
    text += " \\\n  " + make_name(file, Stands::as_prerequisite);
  text += "\n";
  for (const std::string& file : files) text += "\n" + make_name(file, Stands::as_target) + ":\n";
  return text;
}

}  // namespace tdpt::cli
