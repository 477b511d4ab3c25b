// A glTF file in memory: its JSON, its buffers, and those sections that other sections refer to by
// index. All indices lie within their sections. Internal to this room and to the portal format.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "libcommon/base/error.h"
#include "libcommon/scene/gltf/value.h"

namespace tdpt::gltf {

// Types of components.
constexpr int kI8 = 5120, kU8 = 5121, kI16 = 5122, kU16 = 5123, kU32 = 5125, kFloat = 5126;
size_t bytes_of_component(int type);

enum class ElementType { scalar, vec2, vec3, vec4, mat2, mat3, mat4 };
size_t components_of(ElementType type);

/// Values that replace those of an accessor's bufferView.
struct Sparse {
  size_t count = 0;
  size_t index_view = 0, index_offset = 0, value_view = 0, value_offset = 0;
  int index_type = kU32;
};

struct Accessor {
  size_t view = kNone;  ///< kNone: zeros
  size_t offset = 0, count = 0;
  int component_type = kFloat;
  ElementType type = ElementType::scalar;
  bool normalized = false;
  std::optional<Sparse> sparse{};
};

/// EXT_meshopt_compression or KHR_meshopt_compression of a bufferView.
struct Meshopt {
  const char* extension = "";
  size_t buffer = 0, offset = 0, length = 0, stride = 0, count = 0;
  enum class Mode { attributes, triangles, indices } mode = Mode::attributes;
  enum class Filter { none, octahedral, quaternion, exponential } filter = Filter::none;
};

struct BufferView {
  size_t buffer = 0, offset = 0, length = 0, stride = 0;  ///< stride 0: tightly packed
  std::optional<Meshopt> meshopt{};
};

using Attributes = std::map<std::string, size_t>;  ///< accessors by name; those that are read

/// KHR_draco_mesh_compression of a primitive.
struct Draco {
  size_t view = 0;
  std::map<std::string, uint32_t> ids;  ///< Draco's ids of attributes, by their names
  auto operator<=>(const Draco&) const = default;
};

constexpr size_t kTriangles = 4, kStrip = 5, kFan = 6;  // modes; points and lines are below

struct Primitive {
  size_t mode = kTriangles;
  size_t indices = kNone, material = kNone;
  Attributes attributes{};
  std::vector<Attributes> targets{};
  std::optional<Draco> draco{};
  bool is_surface() const { return mode >= kTriangles; }
};

/// The accessor of an attribute, or kNone.
size_t find_attribute(const Attributes& attributes, const std::string& name);

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;
  std::vector<double> weights;
};

/// The lens of a camera.
struct Lens {
  std::string name;
  bool perspective = false;
  double yfov = 0, aspect = 0;  ///< aspect 0: none is given
};

/// A light of EXT_lights_ies at a node.
struct Luminaire {
  size_t light = kNone;
  double multiplier = 1;
  Vec3d colour{1};
};

struct Node {
  std::string name;
  std::vector<size_t> children;
  size_t mesh = kNone, camera = kNone, skin = kNone;
  size_t lamp = kNone, area_light = kNone;  ///< of KHR_lights_punctual, EXT_lights_area
  Luminaire luminaire;
  bool hidden = false;  ///< by KHR_node_visibility
  std::array<size_t, 3> instances{kNone, kNone,
                                  kNone};  ///< accessors of translations, rotations and scales
  std::vector<double> matrix;              ///< empty: the three below count
  Vec3d translation{}, scale{1};
  std::array<double, 4> rotation{0, 0, 0, 1};
  std::vector<double> weights;  ///< of morph targets
  bool holds_light() const {
    return lamp != kNone || luminaire.light != kNone || area_light != kNone;
  }
};

struct Skin {
  std::vector<size_t> joints;
  size_t matrices = kNone;  ///< accessor of inverse bind matrices
};

/// What moves a property of a node.
struct Channel {
  size_t node = 0;
  enum class Path { translation, rotation, scale, weights } path = Path::translation;
  size_t input = 0, output = 0;  ///< accessors
  enum class Way { linear, step, spline } way = Way::linear;
};

struct Animation {
  std::string name;  ///< distinct
  std::vector<Channel> channels;
};

/// A note on materials and area lights.
constexpr const char* kFaint = "a radiance below 1e-30 counts as none";

/// What is approximated or left out, and the names of the parts of the file that it concerns.
class Notes {
 public:
  void add(const std::string& sentence, const std::string& name) { names_[sentence].insert(name); }
  /// "iridescence is left out: material "a", materials[2], materials[4] and 5 more".
  std::vector<std::string> sentences() const;

 private:
  std::map<std::string, std::set<std::string>> names_;  // by sentence
};

struct Document {
  std::string file;    ///< name in messages
  std::string folder;  ///< for external files; empty: none may be read
  std::string bytes;   ///< the file; buffers point into it
  Json json;
  std::string hash;                ///< over the file and the external buffers
  std::vector<std::string> files;  ///< paths of external buffers
  Notes notes;                     ///< on its animations and compressed meshes

  std::vector<std::string_view> buffers;  ///< of their declared byteLength; null: fallbacks
  std::deque<std::string> owned;          ///< decoded and external buffers
  std::vector<BufferView> views;
  std::vector<Accessor> accessors;
  std::vector<Mesh> meshes;
  std::vector<Node> nodes;
  std::vector<size_t>
      roots;  ///< as the default scene lists them; without scenes, nodes without a parent
  std::vector<Skin> skins;
  std::vector<Lens> cameras;
  std::vector<Animation> animations;

  mutable std::map<size_t, std::string> unpacked;  ///< compressed bufferViews decoded so far
  mutable size_t bytes_unpacked = 0;               ///< sum over all of them

  Value root() const { return {file, json}; }
  [[noreturn]] void fail(const std::string& place, const std::string& message) const {
    throw InputError(file, place, message);
  }
};

/// Reads `path` ("-": standard input) into `document`, which must stay where it is. Animations that
/// are not among `animations` (empty: all are wanted) move nothing. Throws InputError.
void open_document(const std::string& path, Document& document,
                   const std::vector<std::string>& animations = {});

/// Makes names unique.
class DistinctNames {
 public:
  /// The first of the two names that is not empty and not taken. If there is none, the first that
  /// is not empty, or `otherwise`, with a number: "door.1".
  std::string take(const std::string& first, const std::string& second,
                   const std::string& otherwise);

 private:
  std::set<std::string> taken_;
  std::map<std::string, size_t> numbers_;
};

/// What to do with a file of another kind.
inline constexpr const char* kAdviceOnOthers =
    "export it as glTF 2.0 from its program, or convert it by tdpt-import (Mitsuba, pbrt, "
    "Tungsten)";

/// The JSON of a .glb or .gltf, and the binary chunk of a .glb.
struct Chunks {
  std::string_view json, bin;
  bool has_bin = false;
};
/// Throws InputError.
Chunks split_chunks(std::string_view bytes, const std::string& file);

/// The bytes behind a URI: a base64 data URI, or a file in the scene's folder or below. Throws
/// InputError if it points elsewhere, NothingThere if it is missing or cannot be decoded.
/// `file_read`: path of the file; empty for a data URI.
std::string read_uri(const Document& document, const std::string& uri, const std::string& place,
                     std::string& file_read);

/// "%20" becomes a blank, and so on.
std::string percent_decode(std::string_view text);

/// Whether this extension is read, or approximated with a warning.
bool is_supported(const std::string& extension);

/// The bytes of a bufferView, decoded if it is compressed. Throws InputError if it exceeds its
/// buffer or cannot be decoded.
std::string_view view_bytes(const Document& document, size_t view);

/// `size` bytes of a buffer; throws InputError, naming `place`, if it has fewer.
std::string_view buffer_bytes(const Document& document, const std::string& place, size_t buffer,
                              size_t offset, size_t size);

/// Sum over all buffers.
size_t bytes_of_buffers(const Document& document);

/// Upper bound on the bytes that accessors can read: those of the file, its buffers and their
/// decompressed contents.
size_t most_bytes(const Document& document);

// Sections of the file, each in the source of what it is used for. They throw InputError with the
// place of the first value that is wrong.

BufferView read_view(const Value& view);
Accessor read_accessor(const Value& accessor);
Lens read_lens(const Value& camera);
Node read_node(const Value& node);
std::vector<size_t> read_roots(const Document& document);
Skin read_skin(const Value& skin);
Mesh read_mesh(const Value& mesh);
/// Needs nodes and accessors. Keeps the channels of the animations that are `wanted` (empty: all),
/// and only the first that moves a given property of a node. Notes those
/// left out.
void read_animations(Document& document, const std::vector<std::string>& wanted);

// Compression.

/// Whether this attribute of a primitive or morph target is read at all.
bool is_read_attribute(const std::string& name);

/// `read`: the primitive but for its extension.
std::optional<Draco> read_draco(const Value& primitive, const Primitive& read);

/// Decodes what Draco compressed, so that its accessors are like any others. Throws InputError.
void decode_draco_primitives(Document& document);

/// Whether a buffer is only a fallback for compressed bufferViews. It may have no bytes.
bool is_meshopt_fallback(const Value& buffer);

/// `stride`: of the bufferView; 0: none.
std::optional<Meshopt> read_meshopt(const Value& view, size_t stride);

/// Decodes a compressed bufferView. Throws InputError if the data are invalid, shorter than the
/// bufferView or, together with everything decoded before, more than the buffers can hold.
std::string unpack_meshopt_view(const Document& document, size_t view);

/// Upper bound on the decoded bytes of all compressed bufferViews.
size_t most_bytes_of_meshopt(const Document& document);

}  // namespace tdpt::gltf
