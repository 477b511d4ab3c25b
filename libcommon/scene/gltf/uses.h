// Tracks which elements of a file's sections the picture depends on. Internal to this room and to
// the files that check.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

class Uses {
 public:
  /// Starts tracking the elements of this section; all are unused at first.
  void count(const std::string& section, size_t size) { used_[section].resize(size); }
  /// False if it was marked already, or does not exist.
  bool mark(const std::string& section, size_t index);
  /// Every element of a section that is not tracked counts as used.
  bool has(const std::string& section, size_t index) const;
  const std::vector<bool>& of(const std::string& section) { return used_[section]; }

 private:
  std::map<std::string, std::vector<bool>> used_;
};

/// Whether this attribute of a primitive or morph target is read at all.
bool is_read_attribute(const std::string& name);

/// The replacement for a wrong, unused element of a section.
nlohmann::json harmless(const std::string& section);

/// Marks what meshes refer to in other sections. Meshes must have been checked.
void mark_parts_of_meshes(Uses& uses, const nlohmann::json& root);
void mark_parts_of_textures(Uses& uses, const nlohmann::json& root);
void mark_views(Uses& uses, const nlohmann::json& root);
void mark_buffers(Uses& uses, const nlohmann::json& root);

}  // namespace tdpt::gltf
