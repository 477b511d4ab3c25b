// What the parts of Tungsten's reader share: checked access to JSON, where every error names its
// place and every key that is read is taken, and the scene that they fill in.
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <unordered_map>

#include "tools/tdpt-import/described.h"

namespace tdpt::foreign::tungsten {

using Json = nlohmann::ordered_json;

/// Keys by their values; and for each object the key that its members wait for.
struct Keys {
  std::unordered_map<const Json*, Key> of_member, of_object;

  /// Enters the members of all objects in a value. `name`: the key that holds it.
  void enter(const Json& json, Source& source, const std::string& where, const std::string& name);
};

/// A value and its place, such as "primitives[3].transform".
class Node {
 public:
  Node(const Json& json, Source& source, const Keys& keys, std::string where)
      : json_(&json), source_(&source), keys_(&keys), where_(std::move(where)) {}

  const Json& json() const { return *json_; }
  Place place() const { return {source_->path(), where_}; }
  Source& source() const { return *source_; }
  [[noreturn]] void fail(const std::string& message) const { Source::fail(place(), message); }
  void lose(const std::string& sentence) const { source_->lose(place(), sentence); }

  /// The member of an object; empty if there is none.
  std::optional<Node> find(const char* key) const;
  /// A member that must be there.
  Node needed(const char* key) const;
  Node item(size_t index) const;
  bool is_string() const { return json_->is_string(); }
  bool is_object() const { return json_->is_object(); }
  bool is_array() const { return json_->is_array(); }
  bool is_number() const { return json_->is_number(); }

  double number() const;
  Vec3d vector() const;  ///< three numbers, or one for all
  std::string text() const;

  double number(const char* key, double otherwise) const;
  Vec3d vector(const char* key, const Vec3d& otherwise) const;
  std::string text(const char* key, const std::string& otherwise) const;
  bool flag(const char* key, bool otherwise) const;

  /// Takes keys that do not change the picture, or whose loss is named otherwise. They are
  /// separated by spaces.
  void ignore(const char* keys) const;
  void ignore_all() const;

 private:
  const Json* json_;
  Source* source_;
  const Keys* keys_;
  std::string where_;
};

/// The map of a node's "transform"; the identity without one.
Affine transform_of(const Node& node);

struct Context {
  Described& scene;
  std::map<std::string, Node> named_surfaces{};
  std::map<std::string, size_t> materials{}, images{}, meshes{};
  std::map<Mesh (*)(), size_t> made_meshes{};
};

/// Enters the surfaces of a scene by their names.
void name_surfaces(Context& in, const Node& bsdfs);
/// Index of the material that a "bsdf" means: by name, or on the spot.
size_t material(Context& in, const std::optional<Node>& bsdf);
/// A constant, a file's name or a texture.
Colour colour(Context& in, const Node& node);

}  // namespace tdpt::foreign::tungsten
