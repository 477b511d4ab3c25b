#include "libcommon/base/provenance.h"

#include <algorithm>

#include "libcommon/base/shown.h"
#include "tdpt_version.h"

namespace tdpt {
namespace {

// A name or a value may contain line breaks; a line of a text format must not.
std::string in_one_line(const std::string& text) {
  return shown(text, text.size());
}

}  // namespace

void Provenance::inherit(const Provenance& input) {
  for (const std::string& line : input.lines)
    if (line.starts_with("from ") || std::find(lines.begin(), lines.end(), line) == lines.end())
      lines.push_back(line);
}

void Provenance::made_by(const std::string& tool, const std::string& command) {
  lines.push_back("made by " + tool + " " + TDPT_VERSION + ": " + in_one_line(command));
}

void Provenance::from(const std::string& path, const std::string& hash) {
  const std::string name =
      path == "-" ? "(standard input)" : path.substr(path.find_last_of('/') + 1);
  lines.push_back("from " + in_one_line(name) + " " + hash);
}

}  // namespace tdpt
