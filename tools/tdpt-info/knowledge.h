// What a file is, whatever program made it: its kind is told from its content, never from its name.
// The readers of the stages read it, so a file that is told of is one that they take.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "libcommon/base/provenance.h"

namespace tdpt {

/// Of one file.
struct Knowledge {
  std::string path;
  std::string kind;   ///< "scene", "flow network", "cut", "light grid", "table of a light grid",
                      ///< "portals", "picture", "film", "plan", "environment"
  std::string hash;   ///< of its bytes; what it reads beside itself included for a scene
  std::string scene;  ///< hash of the scene that it was made from; empty: none is told
  /// Plain facts, in order, as JSON values: "12", "\"text\"".
  std::vector<std::pair<std::string, std::string>> facts;
  Provenance provenance;
};

/// Reads it whole. Throws InputError for what is damaged, or none of these.
Knowledge knowledge_of(const std::string& path);

/// For people, a line for each fact.
std::string text_of(const Knowledge& known);
/// One JSON object.
std::string json_of(const Knowledge& known);

}  // namespace tdpt
