// What the parts of Tungsten's reader share: checked access to JSON, where every error names its
// place and every key that is read is taken, and the scene that they fill in.
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>

#include "tools/tdpt-import/described.h"

namespace tdpt::foreign::tungsten {

using Json = nlohmann::ordered_json;

/// The keys of the objects that were looked into: those of others are not missed.
struct Account {
  Source& source;
  std::unordered_map<const Json*, Key> keys{};  ///< by their values
  std::unordered_set<const Json*> objects{};
};

/// A value and its place, such as "primitives[3].transform".
class Node {
 public:
  Node(const Json& json, Account& account, std::string where)
      : json_(&json), account_(&account), where_(std::move(where)) {}

  const Json& json() const { return *json_; }
  Place place() const { return {source().path(), where_}; }
  Source& source() const { return account_->source; }
  template <class... A>
  void lose(fmt::format_string<const A&...> sentence, const A&... values) const {
    source().lose(place(), fmt::format(sentence, values...));
  }
  template <class... A>
  [[noreturn]] void fail(fmt::format_string<const A&...> message, const A&... values) const {
    Source::fail(place(), fmt::format(message, values...));
  }

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

  /// Takes keys that do not change the picture, or whose loss is named otherwise; all of them if no
  /// names are given.
  void ignore(std::initializer_list<const char*> names = {}) const;

 private:
  void enter_keys() const;

  const Json* json_;
  Account* account_;
  std::string where_;
};

/// The map of a node's "transform"; the identity without one.
Affine transform_of(const Node& node);

struct Context {
  Described& scene;
  std::map<std::string, Node> named_surfaces{};
  std::map<std::string, size_t> materials{}, images{}, meshes{};
};

/// Enters the surfaces of a scene by their names.
void name_surfaces(Context& in, const Node& bsdfs);
/// Index of the material that a "bsdf" means: by name, or on the spot.
size_t material(Context& in, const std::optional<Node>& bsdf);
/// A constant, a file's name or a texture.
Colour colour(Context& in, const Node& node);

}  // namespace tdpt::foreign::tungsten
