// A scene of another renderer, described in glTF's terms: what the readers fill in and gltf/
// writes.
//
// Coordinates are the source's, of any unit and either handedness; gltf/ turns and mirrors the
// scene as a whole. Radiance is in W/m2/sr, colours are linear Rec.709, angles in radians.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "tools/tdpt-import/source.h"

namespace tdpt::foreign {

/// Triangles. `normals` and `uv` have one entry per position, or none. The front of a triangle is
/// where its corners run counter-clockwise as coordinates of a right-handed frame. No normals:
/// flat. uv as in glTF: (0, 0) is the upper left corner of an image, v grows downwards.
struct Mesh {
  std::vector<Vec3f> positions, normals{};
  std::vector<std::array<float, 2>> uv{};
  std::vector<std::array<uint32_t, 3>> triangles{};
};

/// A picture: a file in one of the formats that images.h decodes, or texels of the reader's own.
struct Image {
  std::string
      name;  ///< its file, relative to the scene's folder, or a word for an image without one
  std::string bytes{};  ///< the file's bytes, unless there are `texels`
  int width = 0, height = 0;
  std::vector<Rgb> texels{};  ///< linear, row by row from the top left
};

/// How a number or colour varies over a surface.
struct Texture {
  enum class Wrap { repeat, mirror, clamp };
  size_t image = 0;
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  bool nearest = false;
  /// Texels of 8-bit files are decoded from sRGB (colours) or used as they are (numbers, "raw").
  bool srgb = true;
  /// A number is taken from the mean of red, green and blue, or their luminance, or from alpha.
  bool luminance = false, alpha = false;
  /// Image coordinates (u', v') = (m[0] u + m[1] v + m[2], m[3] u + m[4] v + m[5]) of those of the
  /// mesh, both as in glTF. Must be a rotation after a scale, else gltf/ names it as lost.
  std::array<double, 6> map{1, 0, 0, 0, 1, 0};
  bool green_down = false;  ///< +Y of the normal map is down in the image
};

/// A factor times an optional texture, whose texels first pass through `curve`, if there is one.
struct Colour {
  Rgb factor{1, 1, 1};
  std::optional<Texture> texture{};
  std::function<Rgb(const Rgb&)> curve{};
};
struct Number {
  float factor = 1;
  std::optional<Texture> texture{};
  std::function<float(float)> curve{};
};

/// A surface in glTF's terms; readers make it by the words of materials.h.
struct Material {
  std::string name;
  Colour base{};
  float metallic = 0;
  Number roughness{};  ///< sqrt(alpha)
  float specular = 0;  ///< 0: Lambertian
  Rgb specular_colour{1, 1, 1};
  float ior = 1.5f;
  float transmission = 0;
  bool solid = false;                         ///< transmits into a body, else through a thin sheet
  Rgb attenuation{1, 1, 1};                   ///< left of white after one unit of length
  std::optional<std::array<Rgb, 2>> eta_k{};  ///< a conductor's complex index
  float coat = 0, coat_roughness = 0;
  Number opacity{};                 ///< probability that a ray hits the surface
  std::optional<Texture> normal{};  ///< a tangent-space map, +Y up in the image
  std::optional<Texture> bump{};    ///< heights; times bump_scale in units of length
  double bump_scale = 1;
  bool tinted = false;     ///< a metal that reflects less than all light at grazing angles, too
  bool invisible = false;  ///< shapes of it are left out, unless they emit
};

/// What a surface emits from its front, also from its back if `both_sides`.
struct Emission {
  Colour radiance{{0, 0, 0}, {}, {}};
  bool both_sides = false;
};

/// A mesh at one place. The map may mirror; a mirrored mesh keeps the front that its own
/// coordinates give it, as in glTF.
struct Shape {
  std::string name;
  size_t mesh = 0, material = 0;  ///< indices into Described
  Affine to_world{};
  std::optional<Emission> emission{};
  bool turned = false;  ///< front and back exchanged
};

struct Camera {
  std::string name;
  Affine to_world{};  ///< looks along -z, +y up, +x right; unit axes; may mirror in left-handed
                      ///< sources
  double yfov = 0.5;  ///< full vertical angle
  /// What lies straight ahead stands this far left of and below the middle, in half sizes.
  double shift_x = 0, shift_y = 0;
  int width = 0, height = 0;                   ///< of the picture in pixels
  double lens_radius = 0, focus_distance = 0;  ///< of a thin lens; 0: a pinhole
};

/// A point, a spot or a sun.
struct Lamp {
  enum class Kind { point, spot, sun } kind = Kind::point;
  std::string name;
  Vec3d at{},
      towards{0, 0, -1};  ///< position; direction of a spot and of a sun's light, any length
  Rgb intensity{};        ///< W/sr; of a sun irradiance across its light [W/m2]
  double inner = 0,
         outer = 0;  ///< half angles of the cones in which a spot has its full and any intensity
};

/// Light from all directions.
struct Sky {
  Rgb colour{};  ///< without an image [W/m2/sr]; else its factor
  std::optional<size_t> image{};
  bool srgb = true;  ///< texels of 8-bit files are decoded from sRGB
  enum class Layout { latlong, octahedral } layout = Layout::latlong;
  /// Direction in the map's own frame of a direction of the scene, z = 0 in `t`. In that frame the
  /// texel of d is at u = 0.5 + atan2(d.x, -d.z) / (2 pi), v = acos(d.y) / pi from the top left:
  /// +y is the top row, -z the centre. Octahedral: as pbrt-v4's equal-area squares, +z at the
  /// centre.
  Affine to_map{};
};

struct Described {
  std::string title;  ///< name of the scene
  std::vector<Mesh> meshes{};
  std::vector<Image> images{};
  std::vector<Material> materials{};
  std::vector<Shape> shapes{};
  std::vector<Camera> cameras{};
  std::vector<Lamp> lamps{};
  std::optional<Sky> sky{};
  std::vector<Shape> portals{};  ///< openings for the sky's light, fronts towards the room
};

/// Reads a scene of Mitsuba 0.4 to 0.6, 2 and 3 (XML). `parameters` replace `$name` and the scene's
/// own defaults. Readers throw InputError.
Described read_mitsuba(Source& source, const std::map<std::string, std::string>& parameters);
/// Reads a scene of pbrt-v3 or pbrt-v4; its directives and materials tell the version.
Described read_pbrt(Source& source);
/// Reads a scene of Tungsten (JSON).
Described read_tungsten(Source& source);

}  // namespace tdpt::foreign
