// What a file is, whatever program made it: its kind follows from its content, never from its name.
// The stages' own readers read it, so a file that is described is one that they accept.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "libcommon/base/provenance.h"

namespace tdpt {

/// Facts about one file.
struct Knowledge {
  std::string path;
  std::string kind;   ///< "scene", "flow network", "cut", "light grid", "table of a light grid",
                      ///< "portals", "picture", "film", "environment"
  std::string hash;   ///< of its bytes; for a scene with all files it reads
  std::string scene;  ///< hash of the scene it was made from; empty: unknown
  nlohmann::ordered_json facts = nlohmann::ordered_json::object();
  Provenance provenance;
};

/// Reads the whole file. Throws InputError if it is damaged, or of no known kind.
Knowledge knowledge_of(const std::string& path);

/// For people, one fact a line.
std::string text_of(const Knowledge& known);
/// One JSON object.
std::string json_of(const Knowledge& known);

}  // namespace tdpt
