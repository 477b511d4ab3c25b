#include "libcommon/scene/gltf/document.h"

#include <fmt/format.h>
#include <algorithm>

#include "libcommon/base/file.h"
#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/scene/gltf/compression.h"

namespace tdpt::gltf {

namespace {

using Json = nlohmann::json;

// glTF needs no deeper nesting, and recursive readers would overflow the stack.
constexpr int kDeepest = 64;

/// Maximum number of brackets open at once. Counted before parsing: nlohmann's parser callback
/// could report it, but takes quadratic time in the length of arrays.
int depth_of(std::string_view text) {
  int depth = 0, deepest = 0;
  bool in_text = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_text && c == '\\')
      ++i;
    else if (c == '"')
      in_text = !in_text;
    else if (in_text)
      continue;
    else if (c == '[' || c == '{')
      deepest = std::max(deepest, ++depth);
    else if (c == ']' || c == '}')
      --depth;
  }
  return deepest;
}

void check_extensions(Document& d) {
  if (!d.json.contains("extensionsRequired")) return;
  for (const Json& e : d.json["extensionsRequired"]) {
    const std::string name = e.get<std::string>();
    if (changes_no_picture(name))
      d.warnings.push_back(name + " is required, but changes no picture: passed over");
    else if (!is_supported(name))
      d.fail("extensionsRequired",
             fmt::format("\"{}\" is not supported, expected a scene exported without it",
                         shown(name, 60)));
  }
}

void load_buffers(Document& d, const Chunks& chunks) {
  std::string all;  // input of the hash, if it covers more than the file
  uint64_t beside = 0;
  const Json buffers = d.json.value("buffers", Json::array());
  for (size_t i = 0; i < buffers.size(); ++i) {
    const std::string where = place("buffers", i);
    const auto length = buffers[i]["byteLength"].get<uint64_t>();
    std::string_view bytes;
    const bool in_chunk = i == 0 && chunks.has_bin, has_uri = buffers[i].contains("uri");
    if (is_meshopt_fallback(buffers[i]) || (!has_uri && !in_chunk)) {
      d.buffers.emplace_back();  // for readers that cannot decode
      continue;
    }
    if (has_uri) {
      std::string file;
      d.owned.push_back(read_uri(d, buffers[i]["uri"].get<std::string>(), where + ".uri", file));
      bytes = d.owned.back();
      beside += bytes.size();  // several buffers may refer to the same file
      expect_memory(d.file, where, tdpt::counted(beside, "byte") + " of buffers", 2 * beside);
      if (!file.empty()) {
        all += d.owned.back();
        d.files.push_back(file);
      }
    } else {
      bytes = chunks.bin;
    }
    if (bytes.size() < length)
      d.fail(where, fmt::format("is cut short: {}, expected {}",
                                tdpt::counted(bytes.size(), "byte"), length));
    d.buffers.push_back(bytes.substr(0, length));
  }
  d.hash = all.empty() ? content_hash(d.bytes) : content_hash(d.bytes + all);
}

bool no_image(tinygltf::Image*, const int, std::string*, std::string*, int, int,
              const unsigned char*, int, void*) {
  return true;
}

// An element of few bytes becomes a large structure.
void check_elements(const Document& d) {
  using namespace tinygltf;
  size_t elements = 0, bytes = 0;
  for (const auto& [section, size] :
       {std::pair("nodes", sizeof(Node)), std::pair("meshes", sizeof(Mesh)),
        std::pair("accessors", sizeof(Accessor)), std::pair("bufferViews", sizeof(BufferView)),
        std::pair("scenes", sizeof(tinygltf::Scene)), std::pair("cameras", sizeof(Camera))}) {
    const auto found = d.json.find(section);
    if (found == d.json.end()) continue;
    elements += found->size();
    bytes += found->size() * size;
  }
  expect_memory(d.file, "JSON", fmt::format("{} nodes, meshes, accessors and the like", elements),
                bytes);
}

// Builds tinygltf's model from the checked JSON. It gets no buffers, which it would copy, no
// images, for which it would read outside of a buffer, and no indices, since it refuses those
// stored by Draco.
void load_model(Document& d) {
  check_elements(d);
  Json reduced = Json::object();
  for (const char* section :
       {"asset", "scene", "scenes", "nodes", "meshes", "accessors", "bufferViews", "cameras"})
    if (d.json.contains(section)) reduced[section] = d.json[section];
  if (reduced.contains("meshes"))
    for (Json& mesh : reduced["meshes"])
      for (Json& p : mesh["primitives"]) p.erase("indices"), p.erase("extensions");
  const std::string text = reduced.dump();
  if (text.size() > std::numeric_limits<unsigned>::max()) d.fail("JSON", "is larger than 4 GiB");
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(no_image, nullptr);
  std::string error, warning;
  bool loaded = false;
  try {
    loaded = loader.LoadASCIIFromString(&d.model, &error, &warning, text.data(),
                                        static_cast<unsigned>(text.size()), "");
  } catch (const Json::exception& e) {
    error = e.what();
  }
  if (!loaded)
    d.fail("JSON", "is no valid glTF: " + shown(error.substr(0, error.find_first_of("\r\n")), 200));
  for (size_t m = 0; m < d.model.meshes.size(); ++m)
    for (size_t k = 0; k < d.model.meshes[m].primitives.size(); ++k)
      d.model.meshes[m].primitives[k].indices =
          d.json["meshes"][m]["primitives"][k].value("indices", -1);
}

}  // namespace

Json parse_json(std::string_view text, const std::string& file) {
  if (depth_of(text) > kDeepest)
    throw InputError(file, "JSON", fmt::format("is nested more than {} levels deep", kDeepest));
  try {
    return Json::parse(text.begin(), text.end());
  } catch (const Json::parse_error& e) {
    throw InputError(file, fmt::format("JSON byte {}", e.byte), "is not valid JSON");
  } catch (const Json::exception&) {
    throw InputError(file, "JSON", "holds a number beyond the range of double precision");
  }
}

std::string place(const char* section, size_t index) {
  return fmt::format("{}[{}]", section, index);
}

std::string counted(size_t n, const std::string& noun, const std::string& one,
                    const std::string& many) {
  return tdpt::counted(n, noun) + ' ' + (n == 1 ? one : many);
}

void open_document(const std::string& path, Document& d) {
  d.file = display_name(path);
  d.bytes = read_file(path);
  d.folder = folder_of(path);
  const Chunks chunks = split_chunks(d.bytes, d.file, d.warnings);
  d.json = parse_json(chunks.json, d.file);
  for (std::string& note : check_json(d.json, d.file, d.wanted_animations))
    d.warnings.push_back(std::move(note));
  check_extensions(d);
  for (const Json& e : d.json.value("extensionsUsed", Json::array()))
    d.extensions.insert(e.get<std::string>());
  load_buffers(d, chunks);
  load_model(d);
  decode_draco_primitives(d);
}

bool uses_extension(const Document& d, const std::string& name) {
  return d.extensions.contains(name);
}

std::string_view buffer_bytes(const Document& d, const std::string& where, size_t index,
                              size_t offset, size_t size) {
  const std::string_view buffer = d.buffers[index];
  if (!buffer.data()) d.fail(place("buffers", index), "has neither a uri nor a binary chunk");
  if (offset > buffer.size() || size > buffer.size() - offset)
    d.fail(where, fmt::format("{} from byte {} reach{} beyond buffers[{}] of {}",
                              tdpt::counted(size, "byte"), offset, size == 1 ? "es" : "", index,
                              tdpt::counted(buffer.size(), "byte")));
  return buffer.substr(offset, size);
}

std::string_view view_bytes(const Document& d, size_t index) {
  if (is_meshopt_view(d, index)) {
    auto it = d.unpacked.find(index);
    if (it == d.unpacked.end()) it = d.unpacked.emplace(index, unpack_meshopt_view(d, index)).first;
    return it->second;
  }
  const tinygltf::BufferView& v = d.model.bufferViews[index];
  return buffer_bytes(d, place("bufferViews", index), static_cast<size_t>(v.buffer), v.byteOffset,
                      v.byteLength);
}

size_t most_bytes(const Document& d) {
  size_t bytes = d.bytes.size() + most_bytes_of_meshopt(d);
  for (const std::string_view b : d.buffers) bytes += b.size();
  return bytes;
}

namespace {

int digit_of(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;  // '-' and '_': the URL-safe alphabet
  if (c == '/' || c == '_') return 63;
  return -1;
}

bool decode_base64(std::string_view text, std::string& out) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) return false;
  out.reserve(text.size() / 4 * 3 + 2);
  uint32_t group = 0;
  int bits = 0;
  for (char c : text) {
    const int d = digit_of(c);
    if (d < 0) return false;
    group = (group << 6 | static_cast<uint32_t>(d)) & 0xFFFFFF;
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      out += static_cast<char>((group >> bits) & 255);
    }
  }
  return true;
}

int hex_of(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

[[noreturn]] void nothing(const Namer& namer, const std::string& where, const std::string& message,
                          const std::string& what_is) {
  throw NothingThere(InputError(namer.file, where, message), what_is);
}

}  // namespace

std::string percent_decode(std::string_view text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && hex_of(text[i + 1]) >= 0 &&
        hex_of(text[i + 2]) >= 0) {
      out += static_cast<char>(hex_of(text[i + 1]) * 16 + hex_of(text[i + 2]));
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

std::string read_uri(const Document& document, const std::string& uri, const std::string& where,
                     std::string& file_read) {
  file_read.clear();
  const Namer namer{document.file, document.folder};
  if (uri.starts_with("data:")) {
    const size_t comma = uri.find(',');
    std::string out;
    if (comma == uri.npos || !uri.substr(0, comma).ends_with(";base64") ||
        !decode_base64(std::string_view(uri).substr(comma + 1), out))
      nothing(namer, where, "data URI cannot be decoded, expected \"data:...;base64,\" and base64",
              "a data URI that cannot be decoded");
    return out;
  }
  const std::string name = percent_decode(uri);
  const LocalFile file = local_file(namer, name, where);
  file_read = file.path;
  try {
    return read_file(file.real);
  } catch (const InputError&) {
    const std::string quoted = "\"" + shown(name) + "\"";
    nothing(namer, where, quoted + " cannot be read", "a file that cannot be read, " + quoted);
  }
}

}  // namespace tdpt::gltf
