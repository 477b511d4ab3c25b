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

/// A parameter (`<float name="radius" value="2"/>`), an object that has parameters and objects as
/// its children (`<bsdf type="diffuse">`), or a reference to an object. What is asked for counts as
/// read.
struct Element {
  Source* source;
  std::string tag;  ///< of a reference the object's
  Place place;
  bool old = false;          ///< of a file for Mitsuba 0.x
  std::string name{};        ///< in snake_case; may be empty for objects
  std::string type{}, id{};  ///< of an object; id also of what a reference names
  std::map<std::string, std::string> attributes{};
  Affine map{};                     ///< of a transform
  bool is_animated = false;         ///< `map` is its first place
  const Element* object = nullptr;  ///< itself, what a reference names, or null for a parameter
  std::vector<const Element*> children{};
  Key key{};       ///< taken by who asks for the element
  Key contents{};  ///< taken by the first question about its children: before, nobody misses them

  [[noreturn]] void fail(const std::string& message) const { Source::fail(place, message); }
  void lose(const std::string& sentence) const { source->lose(place, sentence); }
  /// "bitmap "wood"" in messages.
  std::string described() const;

  /// A number in one of its texts; `most`: larger ones count as infinite.
  double finite(const std::string& word, double most = 1e300) const;
  /// An attribute, which must be there, as text and as numbers.
  const std::string& attribute(const std::string& attribute = "value") const;
  /// The same; empty without it.
  std::string optional(const std::string& attribute) const;
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
  /// A transform; the identity without one. An animated one is named as lost.
  Affine transform(const std::string& name) const;
  /// Objects of a kind, named or not.
  std::vector<const Element*> nested(const std::string& kind) const;
  /// Takes children that do not change the picture, or whose loss is named otherwise. `names` are
  /// separated by spaces.
  void ignore(const std::string& names) const;
  void ignore_all() const;
};

/// A finite number; std::nullopt for other texts. White space around it is allowed.
std::optional<double> number_of(const std::string& text);
/// Parts of a text between any of `separators`, without empty ones.
std::vector<std::string> split(const std::string& text, const std::string& separators = " ,\t\r\n");
/// A to Z become a to z.
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

/// What a colour is of: Mitsuba 3 lets a spectrum of equal energy reflect white light as white and
/// shine yellowish.
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
  std::map<std::tuple<const Element*, Role, bool>, Colour> textures{};
  std::map<std::pair<const Element*, const Element*>, Surface> surfaces{};  ///< of bsdf and medium
  std::map<std::string, size_t> default_materials{};
  std::set<size_t> meshes_with_normals{};  ///< in their files
  std::map<size_t, size_t> green_down{};   ///< materials with their normal maps turned
  std::set<const Element*> portals{};      ///< emitters of shapes
  size_t visited_shapes = 0;
};

// Numbers and colours as linear Rec.709, with or without a texture.

bool is_colour(const Element& value);
/// The colour of a float, rgb, srgb, spectrum or blackbody.
Rgb colour_of(const Element& value, Role role);
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
/// A texture object itself. `raw`: 8-bit files without a gamma of their own are numbers.
Colour texture(Context& in, const Element& object, Role role, bool raw = false);
/// Index of the image in the file that an object's "filename" names.
size_t image(Context& in, const Element& object);

/// The surface of a bsdf around a medium, or around nullptr.
Surface surface(Context& in, const Element& bsdf, const Element* interior);

/// Adds a shape of the scene, with all that it holds.
void add_shape(Context& in, const Element& shape);

}  // namespace tdpt::foreign::mitsuba
