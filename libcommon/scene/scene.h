// A scene as the tools see it: triangles in a canonical frame, materials, cameras.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/base/error.h"
#include "libcommon/math/vec.h"
#include "libcommon/scene/sky.h"
#include "libcommon/scene/units.h"
#include "shaders/shared/path/surface_layout.h"

namespace tdpt {

/// Canonical frame: canonical = (metres - centre) * scale. `centre` is the middle of the bounding
/// box (of what stands around the cameras, if the rest lies at the horizon); `scale` is the power
/// of two that brings its longest side into (1, 2]. Rays are traced in it, so units and the origin
/// cost no precision; areas and distances in it are NOT metres. Radiance is the same in both.
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

/// One use of an image: its index, wrapping, and texture coordinates. Bilinear unless `nearest`.
struct TextureMap {
  enum class Wrap : uint8_t { repeat, mirror, clamp };
  int32_t image = -1;  ///< index into Scene::images; -1: no texture
  bool srgb = false;   ///< RGB is sRGB-encoded (alpha never is)
  bool nearest = false;
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  uint8_t uv_set = 0;  ///< Scene::uv[uv_set]
  std::array<float, 6> transform{1, 0, 0,
                                 0, 1, 0};  ///< u' = t0 u + t1 v + t2, v' = t3 u + t4 v + t5
  explicit operator bool() const { return image >= 0; }
};

/// glTF 2.0 metallic-roughness with specular, ior, transmission, volume, clear coat, sheen and
/// emissive strength. The base record holds the factors; a texture multiplies its factor. Flags and
/// pane values in the record are filled in by surface_material(). The default is diffuse grey.
struct Material : shader::SurfaceMaterial {
  Material() : shader::SurfaceMaterial{} {
    base_color = Rgb(0.8f);
    roughness = 1, ior = 1.5f, normal_scale = coat_normal_scale = 1;
    specular_color = Rgb(1.0f);
  }

  std::string name;
  bool double_sided = false;

  /// Only base_color and emission matter: no other lobe, no texture, no alpha.
  bool plain = true;

  float alpha = 1;  ///< factor of the coverage
  enum class Alpha : uint8_t { opaque, mask, blend } alpha_mode = Alpha::opaque;
  float alpha_cutoff = 0.5f;  ///< mask: below it the surface is absent
  bool solid = false;         ///< encloses a volume and refracts; otherwise a thin sheet
  bool sheened() const { return sheen_color.x > 0 || sheen_color.y > 0 || sheen_color.z > 0; }
  bool coloured = false;  ///< some vertex colour on its surfaces is not white

  /// Indexed by MAP_* [surface_layout.h]; mapped.h says what each multiplies. Normal maps are in
  /// tangent space, RGB -> [-1,1].
  std::array<TextureMap, MAPS_OF_MATERIAL> maps;
  /// A of the specular colour's map is glossiness: roughness is 1 - (1 - roughness) A, and the base
  /// colour is multiplied by 1 - the largest component of the specular colour
  /// [specular-glossiness].
  bool glossy_map = false;
};

// Window panes: thin, smooth, colourless and uniform sheets. Light that is not reflected continues
// straight, so a ray may pass the pane with the probability of transmission. So not only rays that
// scatter at the glass but also connections, shadow rays and portals work through a glazed window.

struct Pane {
  float share = 0;        ///< of the light that is not reflected, transmitted; 0: not a pane
  float f0 = 0, f90 = 0;  ///< reflectance at normal and at grazing incidence (Schlick)

  explicit operator bool() const { return share > 0; }
  /// Probability that a ray hits the pane: 1 - share (1 - F); cos is its cosine to the normal.
  double opacity(double cos) const {
    const double m = 1 - std::abs(cos);
    const double f = f0 + (double{f90} - f0) * m * m * m * m * m;
    return 1 - share * (1 - f);
  }
};

inline Pane pane_of(const Material& m) {
  const auto grey = [](const Rgb& c) { return c.x == c.y && c.y == c.z; };
  const bool textured = m.maps[MAP_BASE] || m.maps[MAP_METALLIC_ROUGHNESS] || m.maps[MAP_NORMAL] ||
                        m.maps[MAP_SPECULAR] || m.maps[MAP_SPECULAR_COLOR] ||
                        m.maps[MAP_TRANSMISSION];
  if (!(m.transmission > 0) || m.solid || m.coloured || m.metallic != 0 || m.roughness >= 0.01f ||
      textured || m.alpha_mode != Material::Alpha::opaque || max_component(m.emission) > 0 ||
      !grey(m.base_color) || !grey(m.specular_color) || m.coat > 0 || m.sheened())
    return {};
  const float r = (m.ior - 1) / (m.ior + 1);
  const float f0 = std::min(r * r * m.specular_color.x, 1.0f) * m.specular;
  return {m.transmission * m.base_color.x, f0, m.ior == 1 ? 0.0f : m.specular};
}

/// Radiance [W/m2/sr] of emission. Below, it vanishes in single precision before it reaches the
/// camera, and counts as none; above, it overflows.
constexpr double kFaintestEmission = 1e-30, kBrightestEmission = 1e30;

struct LightProfile;

/// A light without extent (KHR_lights_punctual, EXT_lights_ies), canonical frame.
struct PunctualLight {
  enum class Kind : uint8_t { point, spot, directional } kind = Kind::point;
  std::string name;
  Vec3d position{};  ///< point, spot
  /// spot, directional, with a profile: unit, the direction in which light travels.
  Vec3d direction{0, 0, -1};
  /// point, spot: radiant intensity in canonical area [W/sr * scale^2], so that intensity / d^2
  /// with canonical d is irradiance [W/m2]. directional: perpendicular irradiance [W/m2].
  Rgb intensity{};
  double cos_inner = 1, cos_outer = 0;  ///< spot: full intensity inside, none outside
  /// point, may be null: distribution about `direction`; `intensity` is its maximum.
  std::shared_ptr<const LightProfile> profile;
  Vec3d across{1, 0, 0};  ///< with a profile: unit, orthogonal to `direction`, azimuth 0
};

/// A light with an extent (EXT_lights_area): triangles of a material that no other surface has.
struct AreaLight {
  uint32_t material;  ///< into Scene::materials
  double area;        ///< [m2]
};

/// Counter-clockwise seen from the front: normal ~ cross(p1-p0, p2-p0).
struct Triangle {
  std::array<uint32_t, 3> vertex;  ///< into Scene::positions
  uint32_t material;               ///< into Scene::materials
};

/// Pinhole camera; position and axes in the canonical frame, axes unit and orthogonal.
struct Camera {
  std::string name;
  Vec3d position, right, up, forward;
  double yfov = 0.8;  ///< full vertical angle [rad]
  double aspect = 0;  ///< width / height; 0: the scene does not say
  /// Its rays pass through the backs of surfaces that are not double-sided, and no other technique
  /// shows those backs either: a cutaway. Light walks still hit them.
  bool culls = false;
};

/// A moment of a scene's animations.
struct Pose {
  std::optional<double> seconds{};        ///< none: not asked for, the beginning
  std::vector<std::string> animations{};  ///< names of those that are applied; none: all
  bool is_given() const { return seconds || !animations.empty(); }
};

struct AnimationFacts {
  std::string name;    ///< distinct
  double seconds = 0;  ///< time of its last key that moves something
};

// Rendering defaults stored in a scene and used unless the command line says otherwise: picture
// size, camera and environment.

struct SceneDefaults {
  std::string place;  ///< where the file sets them, "scenes[0].extras"

  std::string environment;       ///< a file's name, "R,G,B" [W/m2/sr] or "none"; empty: not set
  std::string environment_file;  ///< path of that file; empty: no file, or not readable
  /// Why it cannot be read; thrown only when it is used. Null: no error.
  std::shared_ptr<const InputError> environment_fault{};
  std::optional<double> rotation, scale;  ///< of that environment: [deg], factor

  int width = 0, height = 0;  ///< pixels; 0: not set
  std::string camera;         ///< a camera's name; empty: not set

  /// Whether an environment is set, other than "none".
  bool has_environment() const { return !environment.empty() && environment != "none"; }
  std::string place_of(const char* key) const { return place + "." + key; }
};

struct Scene {
  std::string path;  ///< as given, for messages
  std::string hash;  ///< content hash of the file and of all buffers it reads
  /// Hash of other inputs that decide where the scene's light comes from: the sky, without its
  /// power, and lamp units other than the inferred ones; empty: none.
  std::string sky_hash;
  /// Hash of where its animations have put what light meets or comes from, cameras aside; empty if
  /// they move nothing. Equal at two times: only cameras moved between them.
  std::string pose_hash;
  bool moves = false;                      ///< some animation moves something
  std::vector<AnimationFacts> animations;  ///< of the file, whether applied or not
  std::vector<std::string> files;          ///< paths of buffers and images read beside it
  Frame frame;
  std::vector<Vec3f> positions;  ///< canonical
  std::vector<Triangle> triangles;
  std::vector<Material> materials;
  /// Triangles from here on stand for the sky and are not in the file; only if a tool has added
  /// them.
  uint32_t dome = UINT32_MAX;
  std::vector<PunctualLight> lights;
  std::vector<AreaLight> area_lights;
  bool by_blender = false;         ///< written by Blender's exporter
  LampUnits lamp_units;            ///< of both kinds of lights as read, before take_lamps_as()
  std::shared_ptr<const Sky> sky;  ///< null: black surroundings
  std::vector<Image> images;
  std::vector<Camera> cameras;
  SceneDefaults defaults;

  // Parallel to positions; empty if no material or mesh of the scene needs them. Vertices of meshes
  // that lack an attribute have zeros, or white as colour.
  std::vector<Vec3f> normals;                  ///< unit; 0 if at no corner of a smooth triangle
  std::vector<std::array<float, 4>> tangents;  ///< unit or 0, w = handedness (+1 or -1)
  std::array<std::vector<std::array<float, 2>>, 2> uv;
  std::vector<std::array<float, 4>> colours;  ///< linear RGBA, multiplies base_color and alpha
  /// Per triangle, or empty: not 0 if the interpolated normal differs from the geometric one; 2 if
  /// the normals are on the back and must be flipped.
  std::vector<uint8_t> smooth;

  std::vector<std::string> warnings;  ///< sentences: what was approximated or ignored

  /// Whether it has lights whose numbers are in `lamp_units`.
  bool has_lamps() const { return !lights.empty() || !area_lights.empty(); }

  /// Identity stored in files made from it: "hash", "hash@pose_hash", either with "+sky_hash".
  std::string identity() const;
  /// Whether `identity` belongs to this scene, in any pose and under any sky.
  bool is_scene_of(const std::string& identity) const;
  /// The same in this pose, under any sky.
  bool is_pose_of(const std::string& identity) const;

  Vec3f vertex(uint32_t triangle, int corner) const {
    return positions[triangles[triangle].vertex[corner]];
  }
  const Material& material_of(uint32_t triangle) const {
    return materials[triangles[triangle].material];
  }
  /// Whether its back is invisible to cameras that cull.
  bool single_sided(uint32_t triangle) const {
    return triangle < dome && !material_of(triangle).double_sided;
  }
  /// Camera called `name`; for "" the one that `defaults` name, else the first. Throws InputError,
  /// listing the cameras, if there is none of that name, and if the camera is more than 1e6 times
  /// the scene's size away.
  const Camera& camera(const std::string& name) const;
  /// A sentence about the camera that `defaults` name, if there is none of that name; else empty.
  std::string missing_camera() const;
};

/// Geometric quantities of one triangle, canonical frame, computed in double precision.
struct TriangleShape {
  Vec3d p0, e1, e2;  ///< corner and edges p1-p0, p2-p0
  Vec3d normal;      ///< unit, front side; zero when degenerate
  double area;
};
TriangleShape shape_of(const Scene& scene, uint32_t triangle);

/// Whether the scene of this identity is under a sky.
bool is_under_sky(const std::string& identity);

/// Throws InputError if `file` (as the user named it), which carries `identity`, was made from
/// another scene, or from this one under another sky.
void check_made_from(const Scene& scene, const std::string& identity, const std::string& file);

/// For tools that treat every surface as diffuse: what transmits light (KHR_materials_transmission)
/// gets a coverage below 1 that lets the transmitted share pass straight through, so that a pane
/// does not block a window.
void open_glass(Scene& scene);

/// Reads a glTF 2.0 scene (.glb or .gltf, "-": .glb from standard input). Triangles without area
/// are dropped. Throws InputError "file:place: message" for any error; never reads outside a
/// buffer, never opens a file outside the scene's folder.
Scene read_gltf(const std::string& path, const Pose& pose = {});

/// A scene file that is read once and posed as often as wanted.
class SceneFile {
 public:
  /// Reads and checks the file. `animations`: names of those that are applied; empty: all. Throws
  /// InputError as read_gltf().
  SceneFile(const std::string& path, const std::vector<std::string>& animations);
  ~SceneFile();

  /// The scene at this time [s]; none: its beginning, with a warning if something moves.
  Scene at(std::optional<double> seconds);

  /// What may be known of a moment without reading a mesh.
  struct Glance {
    std::string pose_hash;        ///< Scene::pose_hash
    std::vector<Camera> cameras;  ///< those of the scene at that time, positions in metres
  };
  Glance glance_at(double seconds);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tdpt
