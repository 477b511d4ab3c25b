// The reader of pbrt's scenes: the words and parameter lists of its files (tokens.cpp),
// transformations and spectra (values.cpp), textures, materials (surfaces.cpp), shapes, lights and
// cameras. The directives (pbrt.cpp) put them together.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "libcommon/math/vec.h"
#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/images.h"

namespace tdpt::foreign::pbrt {

// ---- Words of scene files ----

/// `bytes` as they are, or inflated if they are compressed by gzip. Throws InputError with `name`
/// for broken streams.
std::string unpacked(std::string bytes, const std::string& name);

struct Token {
  enum class Kind { word, quoted, open, close, end } kind = Kind::word;
  std::string text;  ///< without quotes
};

/// The tokens of one file.
class Tokens {
 public:
  /// `text` must outlive this.
  Tokens(std::string_view text, std::string file)
      : text_(text), file_(std::move(file)), ahead_(scanned()) {}

  /// What next() returns next.
  const Token& peek() const { return ahead_; }
  Token next();
  /// Where the last token of next() was.
  Place place() const { return {file_, fmt::format("line {}", last_line_)}; }
  /// The finite number that `token`, the last one, is.
  double number_of(const Token& token) const;
  template <class... A>
  [[noreturn]] void fail(fmt::format_string<const A&...> message, const A&... values) const {
    Source::fail(place(), fmt::format(message, values...));
  }

 private:
  Token scanned();
  std::string rest_of_string();

  std::string_view text_;
  std::string file_;
  size_t at_ = 0, line_ = 1, ahead_line_ = 1, last_line_ = 1;
  Token ahead_;
};

/// "type name" [values] after a directive.
struct Parameter {
  std::string type, name;
  Place place;
  std::vector<double> numbers{};  ///< of a flag 0 or 1
  std::vector<std::string> strings{};
  Key key{};
};

// ---- The scene so far ----

struct Surface {
  Material material{};
  /// Front and back of its shapes are exchanged: a body whose inside is thinner than its outside.
  bool turned = false;
  Key key{};  ///< taken when a shape shows it
};

struct NamedTexture {
  Colour value{};
  bool is_number = false;  ///< the value is grey
  Key key{};               ///< taken when something names the texture
  size_t depth = 0;        ///< textures that are made of others are deeper; 0: not read yet
};

struct Context {
  Context(Source& scene_source, bool is_v4) : source(scene_source), v4(is_v4) {}

  Source& source;
  bool v4;  ///< pbrt-v4, else pbrt-v3
  Described scene{};
  std::optional<Sky> portals_sky{};  ///< of the first infinite light with a portal
  std::map<std::string, NamedTexture> textures{};
  size_t deepest_named = 0;         ///< depth of the textures that the present one is made of
  std::vector<Surface> surfaces{};  ///< of the directives; State::surface is an index
  std::map<std::string, size_t> named_surfaces{};
  std::map<std::string, std::optional<Rgb>> absorbing{};  ///< media: left of white after length 1
  std::map<std::string, size_t> materials{};  ///< of the scene, by surface, medium and alpha
  std::map<std::string, size_t> meshes{};     ///< of the scene, by file or kind of shape
  std::map<std::string, size_t> images{};     ///< of the scene, by file

  /// The picture of this file, read once.
  size_t image(const std::string& name, const Place& place);
  Texels texels(size_t image) const;
};

/// What a spectrum is of. pbrt-v4 scales every spectrum of a light but `rgb` to luminance 1.
enum class Role { reflectance, index, light };

/// What a directive makes: its kind, such as "matte", and its parameters. A parameter is found by
/// name and type, as in pbrt: one of another type counts as absent, and stays unread.
struct Entity {
  Entity(Context& of, std::string its_kind, Place at, Key its_key = {})
      : context(of), kind(std::move(its_kind)), place(std::move(at)), key(its_key) {}

  Context& context;
  std::string kind;
  Place place;
  Key key{};  ///< of the directive; while nobody takes it, nobody misses the parameters
  std::vector<Parameter> all{};

  /// Reads the parameters that stand next in `tokens`; `owner`: "Material "matte"".
  void read(Tokens& tokens, const std::string& owner);

  /// The first of that name and one of these types.
  const Parameter* find(const std::string& name, std::initializer_list<const char*> types) const;
  /// Whether there is one of that name and any type, which is not read by this.
  bool has(const std::string& name) const;

  /// So many numbers; null: there is no such parameter.
  const double* numbers(const std::string& name, std::initializer_list<const char*> types,
                        size_t count) const;
  double number(const std::string& name, double absent) const;
  int integer(const std::string& name, int absent) const;
  bool flag(const std::string& name, bool absent) const;
  std::string text(const std::string& name, const std::string& absent = "",
                   const char* type = "string") const;
  /// Name of a texture; empty: none.
  std::string texture(const std::string& name) const { return text(name, "", "texture"); }
  Vec3d point(const std::string& name, const Vec3d& absent) const;
  /// Any number of tuples of `size` numbers each.
  const std::vector<double>* list(const std::string& name, std::initializer_list<const char*> types,
                                  size_t size = 1) const;
  /// A value of any of pbrt's types for colours, as linear Rec.709.
  std::optional<Rgb> spectrum(const std::string& name, Role role) const;
  /// Index of refraction: a number or a spectrum, whose green value is taken.
  double index(const std::string& name, double absent) const;
  /// A texture or one value.
  Colour colour(const std::string& name, const Rgb& absent, Role role = Role::reflectance) const;
  std::optional<Number> varying(const std::string& name) const;
  Number varying(const std::string& name, double absent) const;

  /// Takes parameters that do not change the picture, or whose loss is named otherwise; all of them
  /// if no names are given.
  void ignore(std::initializer_list<const char*> names = {}) const;

  template <class... A>
  void lose(fmt::format_string<const A&...> sentence, const A&... values) const {
    context.source.lose(place, fmt::format(sentence, values...));
  }
  template <class... A>
  [[noreturn]] void fail(fmt::format_string<const A&...> message, const A&... values) const {
    Source::fail(place, fmt::format(message, values...));
  }
};

// ---- Transformations ----

/// Throws InputError at `place` for a map that flattens space.
Affine inverse(const Affine& a, const Place& place);
/// Throws InputError at `place` for a map that is not finite.
void require_finite(const Affine& a, const Place& place);
Vec3f vec_at(const std::vector<double>& numbers, size_t i);

// ---- What directives make ----

/// "Texture": `type` is "float", "spectrum" or "color".
void add_texture(const Entity& e, const std::string& name, const std::string& type);
/// A file's picture at the coordinates of the mesh, as an "imagemap" has it. `srgb`: see Texture.
Texture picture(const Entity& e, const std::string& file, bool srgb);

Surface surface_of(const Entity& e);

/// What "AreaLightSource" says for the shapes that follow.
struct AreaLight {
  Emission emission{};
  double power = 0;  ///< if above 0, radiance is to be multiplied by this / (pi area) of each face
};
AreaLight area_light(const Entity& e);
void add_light(const Entity& e, const Affine& to_world);

/// pbrt's graphics state: what AttributeBegin saves and AttributeEnd brings back.
struct State {
  Affine to_world{};      ///< current transformation, at the shutter's opening
  bool is_active = true;  ///< transformations apply to the opening
  bool is_reversed = false;
  size_t surface = 0;
  std::optional<AreaLight> area{};
  std::string inside{}, outside{};  ///< media
  /// pbrt-v4's "Attribute": parameters by "shape", "light", "material", "medium" or "texture".
  std::map<std::string, std::vector<Parameter>> attributes{};
};

/// None for a shape that is lost. Shapes of an object with instances do not shine.
std::optional<Shape> shape_of(const Entity& e, const State& state, bool in_object);
/// "MakeNamedMedium".
void add_medium(const Entity& e, const std::string& name);

/// Adds the camera to the scene, or names it as lost. `from_world`: the transformation at "Camera".
void add_camera(const Entity& e, const Entity& film, const Affine& from_world);

}  // namespace tdpt::foreign::pbrt
