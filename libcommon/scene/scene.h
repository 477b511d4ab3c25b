// A scene as the tools see it: triangles in a canonical frame, materials, cameras.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libcommon/base/error.h"
#include "libcommon/math/vec.h"
#include "libcommon/scene/lamp_units.h"
#include "libcommon/scene/scene_defaults.h"
#include "libcommon/scene/sky.h"
#include "shaders/shared/path/surface_layout.h"

namespace tdpt {

/// Canonical frame: canonical = (metres - centre) * scale. `scale` is a power of two such that the
/// longest side of the bounding box becomes a length in (1, 2]; `centre` is the middle of the box.
/// Rays are traced in it, so a scene in other units or far from the origin loses nothing; areas and
/// distances in it are NOT metres. Radiance is the same in both.
struct Frame {
  Vec3d centre{};
  double scale = 1;
  Vec3d to_canonical(const Vec3d& metres) const { return (metres - centre) * scale; }
  Vec3d to_metres(const Vec3d& canonical) const { return canonical / scale + centre; }
};

/// A decoded image: 8 bits per channel RGBA, row 0 at the top (v = 0).
struct Image {
  int width = 0, height = 0;
  std::vector<uint8_t> texels;  ///< 4 * width * height
};

/// One use of an image: which one, how it is wrapped round, and which coordinates reach it.
/// Bilinear between texels unless `nearest`.
struct TextureMap {
  enum class Wrap : uint8_t { repeat, mirror, clamp };
  int32_t image = -1;  ///< into Scene::images; -1: no texture
  bool srgb = false;   ///< RGB is encoded as sRGB (alpha never is)
  bool nearest = false;
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  uint8_t uv_set = 0;  ///< Scene::uv[uv_set]
  std::array<float, 6> transform{1, 0, 0,
                                 0, 1, 0};  ///< u' = t0 u + t1 v + t2, v' = t3 u + t4 v + t5
  explicit operator bool() const { return image >= 0; }
};

/// glTF 2.0 metallic-roughness with specular, ior, transmission, volume, clear coat, sheen and
/// emissive strength. Factors are those of the record; a texture multiplies its factor. What the
/// record tells in flags and of panes, surface_material() fills in. The default is diffuse grey.
struct Material : shader::SurfaceMaterial {
  Material() : shader::SurfaceMaterial{} {
    base_color = Rgb(0.8f);
    roughness = 1, ior = 1.5f, normal_scale = coat_normal_scale = 1;
    specular_color = Rgb(1.0f);
  }

  std::string name;
  bool double_sided = false;

  /// Nothing but base_color and emission matters: no lobe, texture or alpha beyond them.
  bool plain = true;

  float alpha = 1;  ///< factor of coverage
  enum class Alpha : uint8_t { opaque, mask, blend } alpha_mode = Alpha::opaque;
  float alpha_cutoff = 0.5f;  ///< mask: absent below it
  bool solid = false;         ///< encloses a volume: refracts. Otherwise it is a thin sheet.
  bool sheened() const { return sheen_color.x > 0 || sheen_color.y > 0 || sheen_color.z > 0; }
  bool coloured = false;  ///< some vertex colour of its surfaces is not white

  /// By MAP_* [surface_layout.h], which says what each multiplies [mapped.h]; those of normals, in
  /// tangent space, bend: RGB -> [-1,1].
  std::array<TextureMap, MAPS_OF_MATERIAL> maps;
  /// The specular colour's map holds glossiness in A: roughness is 1 - (1 - roughness) A, and the
  /// base colour has 1 less the largest part of the specular colour [specular-glossiness].
  bool glossy_map = false;
};

struct LightProfile;

/// A light without extent (KHR_lights_punctual, EXT_lights_ies), canonical frame.
struct PunctualLight {
  enum class Kind : uint8_t { point, spot, directional } kind = Kind::point;
  std::string name;
  Vec3d position{};  ///< point, spot
  /// spot, directional: unit, the way the light travels; of a profile its pole.
  Vec3d direction{0, 0, -1};
  /// point, spot: radiant intensity in canonical area [W/sr * scale^2], so that intensity / d^2
  /// with canonical d is irradiance [W/m2]. directional: irradiance on a plane across it [W/m2].
  Rgb intensity{};
  double cos_inner = 1, cos_outer = 0;  ///< spot: full light inside, none outside
  /// point, or null: how it shines about `direction`; `intensity` is the greatest.
  std::shared_ptr<const LightProfile> profile;
  Vec3d across{1, 0, 0};  ///< of a profile: unit, orthogonal to `direction`, its zero
};

/// Counter-clockwise seen from the front: normal ~ cross(p1-p0, p2-p0).
struct Triangle {
  std::array<uint32_t, 3> vertex;  ///< into Scene::positions
  uint32_t material;               ///< into Scene::materials
};

/// Pinhole camera; place and axes in the canonical frame, axes unit and orthogonal.
struct Camera {
  std::string name;
  Vec3d position, right, up, forward;
  double yfov = 0.8;  ///< full vertical angle [rad]
  double aspect = 0;  ///< width / height; 0: the scene does not say
  /// Its own rays pass the backs of surfaces that are not double-sided, and those are seen by no
  /// other way either: a cutaway. Light meets them all the same.
  bool culls = false;
  /// What of the file's is wrong with it, an error only for those who take this camera; null:
  /// nothing.
  std::shared_ptr<const InputError> fault{};
};

struct Scene {
  std::string path;  ///< as given, for messages
  std::string hash;  ///< content hash of the file and of all buffers it reads
  /// Of what else decides where its light comes from: the sky, but for its power, and units of its
  /// lamps that are not what they most likely are; empty: nothing.
  std::string sky_hash;
  std::vector<std::string> files;  ///< paths of buffers and images read beside it
  Frame frame;
  std::vector<Vec3f> positions;  ///< canonical
  std::vector<Triangle> triangles;
  std::vector<Material> materials;
  /// From here on triangles stand for the sky, and are none of the file's; only where a tool has
  /// added them.
  uint32_t dome = UINT32_MAX;
  std::vector<PunctualLight> lights;
  bool by_blender = false;         ///< Blender's exporter wrote it
  LampUnits lamp_units;            ///< of `lights` as read, before take_lamps_as()
  std::shared_ptr<const Sky> sky;  ///< none: all around is black
  std::vector<Image> images;
  std::vector<Camera> cameras;
  SceneDefaults defaults;

  // Parallel to positions; empty where no material or mesh of the scene needs them. Vertices of
  // meshes that lack an attribute have zeros there, white as colour.
  std::vector<Vec3f> normals;                  ///< unit; 0 at no corner of a smooth triangle
  std::vector<std::array<float, 4>> tangents;  ///< unit or 0, w = handedness (+1 or -1)
  std::array<std::vector<std::array<float, 2>>, 2> uv;
  std::vector<std::array<float, 4>> colours;  ///< linear RGBA, multiplies base_color and alpha
  /// Per triangle, or empty: not 0 where the interpolated normal differs from the geometric one; 2
  /// where the normals stand on the back and are to be turned round.
  std::vector<uint8_t> smooth;

  std::vector<std::string> warnings;  ///< sentences: what was approximated or left out
  std::vector<std::string> needs;     ///< words: what its materials and lights ask of a renderer

  /// What files carry that were made from it: `hash`, or "hash+sky_hash".
  std::string identity() const { return sky_hash.empty() ? hash : hash + '+' + sky_hash; }
  /// Whether `identity` is that of this scene, whatever the sky.
  bool is_scene_of(const std::string& identity) const;

  Vec3f vertex(uint32_t triangle, int corner) const {
    return positions[triangles[triangle].vertex[corner]];
  }
  const Material& material_of(uint32_t triangle) const {
    return materials[triangles[triangle].material];
  }
  /// Whether it has a back that is not drawn where cameras cull.
  bool single_sided(uint32_t triangle) const {
    return triangle < dome && !material_of(triangle).double_sided;
  }
  /// Camera called `name`; for "" the one that `defaults` name, else the first. Throws InputError
  /// naming those there are, or when it is wrong or stands more than 1e6 times the scene's size
  /// away.
  const Camera& camera(const std::string& name) const;
  /// A sentence about cameras that are wrong, but for the one called `taken`, or about one that
  /// `defaults` name and that there is not; empty: there are none.
  std::string faults_of_cameras_but(const std::string& taken) const;
};

/// Geometric quantities of one triangle, canonical frame, computed in double precision.
struct TriangleShape {
  Vec3d p0, e1, e2;  ///< corner and edges p1-p0, p2-p0
  Vec3d normal;      ///< unit, front side; zero when degenerate
  double area;
};
TriangleShape shape_of(const Scene& scene, uint32_t triangle);

/// Throws InputError when `file` (as the user names it), which carries `identity`, was made from
/// another scene, or from this one under another sky.
void check_made_from(const Scene& scene, const std::string& identity, const std::string& file);

/// For tools that take every surface as diffuse: what transmits light (KHR_materials_transmission)
/// gets a coverage that lets its share pass straight on, so that a pane walls no window up.
void open_glass(Scene& scene);

/// Reads a glTF 2.0 scene (.glb or .gltf, "-": .glb from standard input). Triangles without area
/// are dropped. Throws InputError "file:place: message" for everything that is wrong; never reads
/// outside a buffer, never opens a file outside the scene's folder.
Scene read_gltf(const std::string& path);

}  // namespace tdpt
