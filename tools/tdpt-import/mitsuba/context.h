// What the parts of Mitsuba's reader share: the scene that they fill in and what they made of its
// objects so far.
#pragma once
#include <map>
#include <set>

#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/mitsuba/object.h"

namespace tdpt::foreign::mitsuba {

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
  std::map<std::tuple<const Object*, Role, bool>, Colour> textures{};
  std::map<std::pair<const Object*, const Object*>, Surface> surfaces{};  ///< of bsdf and medium
  std::map<std::string, size_t> default_materials{};
  std::set<size_t> meshes_with_normals{};  ///< in their files
  std::vector<std::pair<const Object*, size_t>>
      bodies{};                           ///< one-sided ones, with their shapes' indices
  std::map<size_t, size_t> green_down{};  ///< materials with their normal maps turned
  std::set<const Object*> portals{};      ///< emitters of shapes
  size_t visited_shapes = 0;
};

// Numbers and colours as linear Rec.709, with or without a texture.

bool is_colour(const Value& value);
/// The colour of a float, rgb, srgb, spectrum or blackbody.
Rgb colour_of(const Value& value, bool old, Role role);
float mean(const Rgb& c);
bool is_grey(const Rgb& c);

/// The value of that name of an object; `otherwise` without one.
Colour colour(Context& in, const Object& object, const std::string& name, const Rgb& otherwise,
              Role role = Role::surface);
Number number(Context& in, const Object& object, const std::string& name, double otherwise);
/// The same where a texture cannot stand: it is named as lost and `otherwise` taken.
Rgb plain_colour(Context& in, const Object& object, const std::string& name, const Rgb& otherwise,
                 Role role = Role::surface);
double plain_number(Context& in, const Object& object, const std::string& name, double otherwise);
/// A texture object itself. `raw`: 8-bit files without a gamma of their own are numbers.
Colour texture(Context& in, const Object& object, Role role, bool raw = false);
/// Index of the image in the file that an object's "filename" names.
size_t image(Context& in, const Object& object);

/// The surface of a bsdf around a medium, or around nullptr.
Surface surface(Context& in, const Object& bsdf, const Object* interior);

/// Adds a shape of the scene, with all that it holds.
void add_shape(Context& in, const Object& shape);
/// When all is read: names bodies that a camera sees from behind.
void lose_backs(const Context& in);

}  // namespace tdpt::foreign::mitsuba
