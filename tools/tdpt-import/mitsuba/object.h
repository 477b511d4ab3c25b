// A Mitsuba scene as objects with named values, before anything is made of them.
#pragma once
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "tools/tdpt-import/source.h"

namespace tdpt::foreign::mitsuba {

struct Object;

struct Attribute {
  std::string text;
  Key key{};
};
using Attributes = std::map<std::string, Attribute>;

/// A child element of an object: a parameter, a nested object or a reference to one.
struct Value {
  Source* source;
  std::string tag;   ///< "float", "rgb"; of an object and a reference to it: the object's
  std::string name;  ///< in snake_case; may be empty for objects
  Place place;
  Attributes attributes{};
  Affine map{};              ///< of a transform
  bool is_animated = false;  ///< `map` is its first place
  const Object* object = nullptr;
  std::string id{};  ///< that a reference names
  Key key{};
  Key contents{};  ///< taken by the first question about its attributes: before, nobody misses them

  [[noreturn]] void fail(const std::string& message) const { Source::fail(place, message); }
  void lose(const std::string& sentence) const { source->lose(place, sentence); }
  /// Whether there is such an attribute that is not empty.
  bool has(const std::string& attribute) const;
  /// An attribute, which must be there.
  const std::string& text(const std::string& attribute = "value") const;
  double number(const std::string& attribute = "value") const;
  std::vector<double> numbers(const std::string& attribute = "value") const;
  Vec3d three(const std::string& attribute = "value") const;
};

/// An element with a type: `<bsdf type="diffuse">`. What is asked for counts as read.
struct Object {
  Source* source;
  std::string tag, type, id;
  Place place;
  bool old = false;  ///< of a file for Mitsuba 0.x
  std::vector<Value> values{};
  Key key{};  ///< taken by the first question about its values

  [[noreturn]] void fail(const std::string& message) const { Source::fail(place, message); }
  void lose(const std::string& sentence) const { source->lose(place, sentence); }
  /// "the bitmap", "the shape "hair"" in messages.
  std::string described() const;

  /// The last value of that name.
  const Value* find(const std::string& name) const;
  /// The same; it must have one of these tags, separated by spaces.
  const Value* find(const std::string& name, const std::string& tags) const;
  double number(const std::string& name, double otherwise) const;
  int integer(const std::string& name, int otherwise) const;
  bool flag(const std::string& name, bool otherwise) const;
  std::string text(const std::string& name, const std::string& otherwise) const;
  std::string needed_text(const std::string& name) const;
  std::optional<Vec3d> vector(const std::string& name) const;
  /// A transform; the identity without one. An animated one is named as lost.
  Affine map(const std::string& name) const;
  /// Nested objects of a kind, named or not.
  std::vector<const Object*> nested(const std::string& kind) const;
  /// Takes values that do not change the picture, or whose loss is named otherwise. `names` are
  /// separated by spaces.
  void ignore(const std::string& names) const;
  void ignore_all() const;
};

/// A finite number; std::nullopt for other texts. White space around it is allowed.
std::optional<double> number_of(const std::string& text);
/// Parts of a text between any of `separators`, without empty ones.
std::vector<std::string> split(const std::string& text, const std::string& separators = " ,\t\r\n");
/// Whether `word` is one of `words`, which spaces separate.
bool is_one_of(const std::string& word, const std::string& words);

/// The map of one step of a transform: translate, rotate, scale, lookat, matrix. Empty: no such
/// step.
std::optional<Affine> map_of_step(const Value& step);
/// The inverse; `place` is named if there is none.
Affine inverse(const Affine& map, const Place& place);
/// The map without translation, its axes at length 1; fails if one has no length.
Affine axes_of(const Affine& map, const Place& place);

struct Document {
  std::deque<Object> objects;     ///< addresses stay
  const Object* scene = nullptr;  ///< its values are what the scene holds
};

/// Parses a scene: defaults and $names, includes, search paths, ids and references. Throws
/// InputError for malformed files, unknown ids, and objects that hold themselves.
Document parse(Source& source, const std::map<std::string, std::string>& parameters);

}  // namespace tdpt::foreign::mitsuba
