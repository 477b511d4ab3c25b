#include "libcommon/scene/gltf/document.h"

#include <fmt/format.h>
#include <algorithm>

#include "libcommon/base/file.h"
#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"

namespace tdpt::gltf {
namespace {

// Extensions that are read, or approximated with a warning.
constexpr std::array kSupported = {"KHR_materials_emissive_strength",
                                   "KHR_materials_specular",
                                   "KHR_materials_ior",
                                   "KHR_materials_transmission",
                                   "KHR_materials_volume",
                                   "KHR_materials_clearcoat",
                                   "KHR_materials_sheen",
                                   "KHR_materials_iridescence",
                                   "KHR_materials_anisotropy",
                                   "KHR_materials_dispersion",
                                   "KHR_materials_diffuse_transmission",
                                   "KHR_materials_volume_scatter",
                                   "KHR_materials_unlit",
                                   "KHR_lights_punctual",
                                   "EXT_lights_ies",
                                   "EXT_lights_area",
                                   "KHR_mesh_quantization",
                                   "KHR_draco_mesh_compression",
                                   "EXT_meshopt_compression",
                                   "KHR_meshopt_compression",
                                   "EXT_texture_webp",
                                   "EXT_texture_avif",
                                   "KHR_texture_basisu",
                                   "MSFT_texture_dds",
                                   "KHR_texture_transform",
                                   "KHR_materials_pbrSpecularGlossiness",
                                   "KHR_node_visibility",
                                   "EXT_mesh_gpu_instancing"};

void read_version(const Value& root) {
  const Value asset = root["asset"];
  if (!asset)
    asset.fail_because(std::string("is missing, so this is no glTF scene: ") + kAdviceOnOthers);
  const Value version = asset["version"].needed();
  if (const std::string text = version.text(); text != "2" && !text.starts_with("2."))
    version.fail("\"2.0\"");
}

void check_extensions(const Document& d) {
  for (const Value& v : d.root()["extensionsRequired"].items())
    if (const std::string name = v.text(); !is_supported(name))
      d.fail("extensionsRequired",
             fmt::format("\"{}\" is not supported, expected a scene exported without it",
                         shown(name, 60)));
}

// An element of few bytes becomes a large structure.
void expect_memory_of_sections(const Document& d) {
  size_t elements = 0, bytes = 0;
  for (const auto& [section, size] :
       {std::pair("nodes", sizeof(Node)), std::pair("meshes", sizeof(Mesh)),
        std::pair("accessors", sizeof(Accessor)), std::pair("bufferViews", sizeof(BufferView)),
        std::pair("scenes", size_t{0}), std::pair("cameras", sizeof(Lens))}) {
    const size_t count = d.root()[section].size();
    elements += count;
    bytes += count * size;
  }
  expect_memory(d.file, "JSON", fmt::format("{} nodes, meshes, accessors and the like", elements),
                bytes);
}

template <class T>
void read_section(const Document& d, const char* name, std::vector<T>& out,
                  T (*read)(const Value&)) {
  for (const Value& v : d.root()[name].items()) out.push_back(read(v));
}

void load_buffers(Document& d, const Chunks& chunks) {
  std::string all;  // input of the hash, if it covers more than the file
  uint64_t beside = 0;
  const std::vector<Value> buffers = d.root()["buffers"].items();
  for (size_t i = 0; i < buffers.size(); ++i) {
    const std::string where = place("buffers", i);
    const size_t length = buffers[i]["byteLength"].needed().integer(0, 1);
    const Value uri = buffers[i]["uri"];
    std::string_view bytes = chunks.bin;
    const bool in_chunk = i == 0 && chunks.has_bin;
    if (is_meshopt_fallback(buffers[i]) || (!uri && !in_chunk)) {
      uri.text();
      d.buffers.emplace_back();  // for readers that cannot decode
      continue;
    }
    if (uri) {
      std::string file;
      d.owned.push_back(read_uri(d, uri.text(), where + ".uri", file));
      bytes = d.owned.back();
      beside += bytes.size();  // several buffers may refer to the same file
      expect_memory(d.file, where, counted(beside, "byte") + " of buffers", 2 * beside);
      if (!file.empty()) {
        all += d.owned.back();
        d.files.push_back(file);
      }
    }
    if (bytes.size() < length)
      d.fail(where,
             fmt::format("is cut short: {}, expected {}", counted(bytes.size(), "byte"), length));
    d.buffers.push_back(bytes.substr(0, length));
  }
  d.hash = all.empty() ? content_hash(d.bytes) : content_hash(d.bytes + all);
}

Attributes read_attributes(const Value& v) {
  Attributes out;
  for (const auto& [name, accessor] : v.members())
    if (is_read_attribute(name)) out[name] = accessor.index("accessors");
  return out;
}

Primitive read_primitive(const Value& v) {
  Primitive p;
  p.mode = v["mode"].integer(kTriangles, 0, kFan);
  p.indices = v["indices"].index("accessors");
  p.material = v["material"].index("materials");
  p.attributes = read_attributes(v["attributes"].needed());
  p.draco = read_draco(v, p);
  for (const Value& target : v["targets"].items()) p.targets.push_back(read_attributes(target));
  return p.is_surface() ? p : Primitive{p.mode};  // points and lines are not rendered
}

}  // namespace

bool is_supported(const std::string& extension) {
  return std::find(kSupported.begin(), kSupported.end(), extension) != kSupported.end();
}

std::vector<std::string> Notes::sentences() const {
  constexpr size_t kMostSentences = 16, kMostNames = 3;  // a file may have any number
  std::vector<std::string> out;
  for (const auto& [sentence, names] : names_) {
    if (out.size() == kMostSentences) {
      out.push_back(counted(names_.size() - kMostSentences, "more approximation"));
      break;
    }
    std::string list;
    size_t listed = 0;
    for (const std::string& name : names)
      if (listed++ < kMostNames) list += (list.empty() ? "" : ", ") + name;
    if (listed > kMostNames) list += fmt::format(" and {} more", listed - kMostNames);
    out.push_back(sentence + ": " + list);
  }
  return out;
}

std::string DistinctNames::take(const std::string& first, const std::string& second,
                                const std::string& otherwise) {
  for (const std::string& name : {first, second})
    if (!name.empty() && taken_.insert(name).second) return name;
  const std::string base = !first.empty() ? first : !second.empty() ? second : otherwise;
  if (taken_.insert(base).second) return base;
  size_t& k = numbers_[base];  // all numbers below are taken
  std::string name;
  do name = fmt::format("{}.{}", base, ++k);
  while (!taken_.insert(name).second);
  return name;
}

void open_document(const std::string& path, Document& d,
                   const std::vector<std::string>& animations) {
  d.file = display_name(path);
  d.bytes = read_file(path);
  d.folder = folder_of(path);
  const Chunks chunks = split_chunks(d.bytes, d.file);
  d.json = parse_json(chunks.json, d.file);
  read_version(d.root());  // another version may differ in everything else
  expect_memory_of_sections(d);
  read_section(d, "nodes", d.nodes, read_node);
  d.roots = read_roots(d);
  read_section(d, "skins", d.skins, read_skin);
  read_section(d, "cameras", d.cameras, read_lens);
  read_section(d, "accessors", d.accessors, read_accessor);
  read_section(d, "bufferViews", d.views, read_view);
  read_section(d, "meshes", d.meshes, read_mesh);
  read_animations(d, animations);
  check_extensions(d);
  load_buffers(d, chunks);
  decode_draco_primitives(d);
}

BufferView read_view(const Value& v) {
  BufferView out;
  out.buffer = v["buffer"].needed().index("buffers");
  out.offset = v["byteOffset"].integer(0);
  out.length = v["byteLength"].needed().integer(0, 1);
  out.stride = v["byteStride"].integer(0, 4, 252);
  if (out.stride % 4 != 0) v["byteStride"].fail("a multiple of 4");
  out.meshopt = read_meshopt(v, out.stride);
  return out;
}

bool is_read_attribute(const std::string& name) {
  constexpr std::array kRead = {"POSITION",   "NORMAL",     "TANGENT",
                                "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"};
  return name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_") ||
         std::find(kRead.begin(), kRead.end(), name) != kRead.end();
}

size_t find_attribute(const Attributes& attributes, const std::string& name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? kNone : found->second;
}

Mesh read_mesh(const Value& v) {
  Mesh out;
  out.name = v["name"].text();
  out.weights = v["weights"].numbers(0);
  for (const Value& p : v["primitives"].needed().items())
    out.primitives.push_back(read_primitive(p));
  return out;
}

std::string_view buffer_bytes(const Document& d, const std::string& where, size_t index,
                              size_t offset, size_t size) {
  const std::string_view buffer = d.buffers[index];
  if (!buffer.data()) d.fail(place("buffers", index), "has neither a uri nor a binary chunk");
  if (offset > buffer.size() || size > buffer.size() - offset)
    d.fail(where,
           fmt::format("{} from byte {} reach{} beyond buffers[{}] of {}", counted(size, "byte"),
                       offset, size == 1 ? "es" : "", index, counted(buffer.size(), "byte")));
  return buffer.substr(offset, size);
}

std::string_view view_bytes(const Document& d, size_t index) {
  const BufferView& v = d.views[index];
  if (!v.meshopt) return buffer_bytes(d, place("bufferViews", index), v.buffer, v.offset, v.length);
  auto it = d.unpacked.find(index);
  if (it == d.unpacked.end()) it = d.unpacked.emplace(index, unpack_meshopt_view(d, index)).first;
  return it->second;
}

size_t bytes_of_buffers(const Document& d) {
  size_t bytes = 0;
  for (const std::string_view b : d.buffers) bytes += b.size();
  return bytes;
}

size_t most_bytes(const Document& d) {
  return d.bytes.size() + bytes_of_buffers(d) + most_bytes_of_meshopt(d);
}

}  // namespace tdpt::gltf
