// Which elements of a file's sections the picture depends on. Internal to this room, to the files
// that check.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

class Uses {
 public:
  /// From now on the elements of this section count; none is used as yet.
  void count(const std::string& section, size_t size) { used_[section].resize(size); }
  /// False when it was marked already, or is not there.
  bool mark(const std::string& section, size_t index);
  /// Every element of a section that is not counted is used.
  bool has(const std::string& section, size_t index) const;
  const std::vector<bool>& of(const std::string& section) { return used_[section]; }

 private:
  std::map<std::string, std::vector<bool>> used_;
};

/// Whether an attribute of a primitive or morph target is one of those that are read.
bool is_read_attribute(const std::string& name);

/// What stands in for an element of a section that is wrong and not used.
nlohmann::json harmless(const std::string& section);

/// Marks the elements that those of other sections refer to, which must have been checked.
void mark_parts_of_meshes(Uses& uses, const nlohmann::json& root);
void mark_parts_of_textures(Uses& uses, const nlohmann::json& root);
void mark_views(Uses& uses, const nlohmann::json& root);
void mark_buffers(Uses& uses, const nlohmann::json& root);

}  // namespace tdpt::gltf
