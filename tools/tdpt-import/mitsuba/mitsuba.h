// A Mitsuba scene as elements of its XML, and what the chapters of the reader share: the scene that
// they fill in and what they made of its objects so far.
#pragma once
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/source.h"

namespace tdpt::foreign::mitsuba {

/// An element of the XML: a parameter (`<float name="radius" value="2"/>`), an object with
/// parameters and objects as its children (`<bsdf type="diffuse">`), or a reference to an object.
/// Asking for an element marks it as read; unread ones are named as lost.
struct Element {
  Source* source;
  std::string tag;  ///< a reference has the tag of its object
  Place place;
  bool old = false;          ///< its file is for Mitsuba 0.x
  std::string name{};        ///< in snake_case; may be empty for objects
  std::string type{}, id{};  ///< of an object; a reference has the id of its object
  std::map<std::string, std::string> attributes{};
  Affine map{};                     ///< the value of a transform
  bool is_animated = false;         ///< `map` is its first transform
  const Element* object = nullptr;  ///< itself, what a reference names, or null for a parameter
  std::vector<const Element*> children{};
  Key key{};       ///< taken when the element is asked for
  Key contents{};  ///< taken when a child is asked for; until then no child is missed

  [[noreturn]] void fail(const std::string& message) const { Source::fail(place, message); }
  void lose(const std::string& sentence) const { source->lose(place, sentence); }
  /// "bitmap "wood"" in messages.
  std::string described() const;

  /// Parses a number; fails unless it is finite and below `most`.
  double finite(const std::string& word, double most = 1e300) const;
  /// An attribute, which must be there, as text and as numbers.
  const std::string& attribute(const std::string& attribute = "value") const;
  /// The same; empty if there is none.
  std::string optional(const std::string& attribute) const;
  /// The attributes x, y and z, `otherwise` where one lacks, or a value of one or three numbers.
  Vec3d xyz(double otherwise) const;
  std::vector<double> numbers(const std::string& attribute = "value") const;
  Vec3d three(const std::string& attribute = "value") const;

  /// The last child of that name.
  const Element* find(const std::string& name) const;
  /// The same; it must have one of these tags, separated by spaces.
  const Element* find(const std::string& name, const std::string& tags) const;
  double number(const std::string& name, double otherwise) const;
  int integer(const std::string& name, int otherwise) const;
  bool flag(const std::string& name, bool otherwise) const;
  std::string text(const std::string& name, const std::string& otherwise) const;
  std::string needed_text(const std::string& name) const;
  std::optional<Vec3d> vector(const std::string& name) const;
  /// The transform of that name, or the identity. An animated one is named as lost.
  Affine transform(const std::string& name) const;
  /// The objects with this tag, named or not.
  std::vector<const Element*> nested(const std::string& kind) const;
  /// Marks children as read that do not change the picture, or whose loss is named otherwise.
  /// Spaces separate `names`.
  void ignore(const std::string& names) const;
  void ignore_all() const;
};

/// Parts of a text between any of `separators`, without empty ones.
std::vector<std::string> split(const std::string& text, const std::string& separators = " ,\t\r\n");
/// The text with a to z for A to Z.
std::string lower_case(std::string text);
/// Whether `word` is one of `words`, which spaces separate.
bool is_one_of(const std::string& word, const std::string& words);

/// The map of one step of a transform: translate, rotate, scale, lookat, matrix. Empty: no such
/// step.
std::optional<Affine> map_of_step(const Element& step);
/// The inverse; `place` is named if there is none.
Affine inverse(const Affine& map, const Place& place);
/// The map without translation, its axes at length 1; fails if one has no length.
Affine axes_of(const Affine& map, const Place& place);

/// Parses a scene: defaults and $names, includes, search paths, ids and references. Throws
/// InputError for malformed files, unknown ids, and objects that hold themselves. The first element
/// is the scene; addresses stay.
std::deque<Element> parse(Source& source, const std::map<std::string, std::string>& parameters);

constexpr const char* kMedia = "media (fog, absorption, scattering) are left out";

/// What a colour belongs to. In Mitsuba 3 a spectrum of equal energy is white as a reflectance and
/// yellowish as a light.
enum class Role { surface, light };

/// The material of a bsdf.
struct Surface {
  size_t material = 0;
  bool turned = false;     ///< the material is that of the surface's back
  bool one_sided = false;  ///< Mitsuba's is black on its back
};

struct Context {
  Described& scene;
  std::map<std::string, size_t> images{}, meshes{};
  std::map<std::pair<const Element*, Role>, Colour> textures{};
  std::map<std::pair<const Element*, const Element*>, Surface> surfaces{};  ///< of bsdf and medium
  std::map<std::string, size_t> default_materials{};
  std::set<size_t> meshes_with_normals{};  ///< in their files
  std::map<size_t, size_t> green_down{};   ///< materials with their normal maps turned
  std::set<const Element*> portals{};      ///< emitters of shapes
  size_t visited_shapes = 0;
};

// Numbers and colours as linear Rec.709, with or without a texture.

inline float single(double v) {
  return static_cast<float>(v);
}
float mean(const Rgb& c);
bool is_grey(const Rgb& c);

/// The value of that name of an object; `otherwise` without one.
Colour colour(Context& in, const Element& object, const std::string& name, const Rgb& otherwise,
              Role role = Role::surface);
Number number(Context& in, const Element& object, const std::string& name, double otherwise);
/// The same where a texture cannot stand: it is named as lost and `otherwise` taken.
Rgb plain_colour(Context& in, const Element& object, const std::string& name, const Rgb& otherwise,
                 Role role = Role::surface);
double plain_number(Context& in, const Element& object, const std::string& name, double otherwise);
/// The colour of a texture object.
Colour texture(Context& in, const Element& object, Role role);
/// Index of the image in the file that an object's "filename" names.
size_t image(Context& in, const Element& object);

/// The surface of a bsdf around a medium, or around nullptr.
Surface surface(Context& in, const Element& bsdf, const Element* interior);

/// Adds a shape of the scene, with all that it holds.
void add_shape(Context& in, const Element& shape);

}  // namespace tdpt::foreign::mitsuba
