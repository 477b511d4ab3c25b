// Splits the container: .glb header and chunks (glTF 2.0, section 4.4).
#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {
namespace {

uint32_t u32_at(std::string_view bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

constexpr uint32_t kJson = 0x4E4F534A, kBin = 0x004E4942;
constexpr size_t kHeader = 12, kChunkHeader = 8;

struct Foreign {
  const char* suffixes;
  const char* advice;
};
constexpr Foreign kForeign[]{
    {".blend ", "export it from Blender: File > Export > glTF 2.0"},
    {".json .pbrt .xml ",
     "if it is one of Tungsten, pbrt or Mitsuba, tdpt-import makes a .glb of it"},
    {".3ds .abc .c4d .dae .fbx .ifc .ma .max .mb .obj .ply .skp .stl .usd .usda .usdc .usdz ",
     "import it into Blender, or the program that made it, and export it as glTF 2.0"}};

/// What to do with a file of another kind, by its name; empty: unknown.
std::string advice_on(const std::string& file) {
  const std::string suffix = suffix_of(file) + ' ';
  for (const Foreign& kind : kForeign)
    if (suffix != " " && std::string_view(kind.suffixes).find(suffix) != std::string_view::npos)
      return kind.advice;
  return "";
}

/// Offset of the chunk after one that ends at `end`. Some writers pad that to a multiple of 4
/// without counting the padding in its length.
size_t next_chunk(std::string_view bytes, size_t end) {
  const size_t aligned = (end + 3) / 4 * 4;
  const auto is_bin = [&](size_t at) {
    return bytes.size() >= kChunkHeader && at <= bytes.size() - kChunkHeader &&
           u32_at(bytes, at + 4) == kBin;
  };
  return !is_bin(end) && is_bin(aligned) ? aligned : end;
}

}  // namespace

Chunks split_chunks(std::string_view bytes, const std::string& file,
                    std::vector<std::string>& warnings) {
  const auto fail = [&](const std::string& where, const std::string& message) {
    throw InputError(file, where, message);
  };
  if (bytes.empty()) fail("", "is empty, expected a glTF 2.0 scene");
  if (!bytes.starts_with("glTF")) {
    const size_t first = bytes.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
    const bool is_json = first != bytes.npos && bytes[first] == '{';
    const std::string advice = advice_on(file);
    if (!advice.empty() && !(is_json && bytes.find("\"asset\"") != bytes.npos))
      fail("", "is no glTF scene: " + advice);
    if (!is_json)
      fail("", "is no glTF scene, expected \"glTF\" (.glb) or \"{\" (.gltf) at its start");
    return {bytes, {}, false};
  }
  if (bytes.size() < kHeader)
    fail("header", fmt::format("is cut short after {} bytes, expected {}", bytes.size(), kHeader));
  const uint32_t version = u32_at(bytes, 4), length = u32_at(bytes, 8);
  if (version != 2) fail("header", fmt::format("version is {}, expected 2", version));
  if (length > bytes.size())
    fail("header",
         fmt::format("the file is cut short: {} bytes, expected {}", bytes.size(), length));
  if (length < bytes.size())
    warnings.push_back(fmt::format("the file has {} bytes, but declares {}: the rest is left out",
                                   bytes.size(), length));
  bytes = bytes.substr(0, length);

  Chunks chunks;
  size_t at = kHeader;
  // Anything after the binary chunk is ignored.
  for (size_t k = 0; k < 2 && at < bytes.size(); ++k) {
    const std::string where = place("chunk", k);
    const size_t left = bytes.size() - at;
    if (left < kChunkHeader) {
      if (k > 0 && left < 4) break;  // padding
      fail(where, fmt::format("is cut short: {}, expected a header of {}",
                              tdpt::counted(left, "byte"), kChunkHeader));
    }
    const uint32_t size = u32_at(bytes, at), type = u32_at(bytes, at + 4);
    if (size > left - kChunkHeader)
      fail(where, fmt::format("declares {}, but {} are left in the file",
                              tdpt::counted(size, "byte"), left - kChunkHeader));
    if (size % 4 != 0)
      warnings.push_back(fmt::format("{} of the file has {}, expected a multiple of 4", where,
                                     tdpt::counted(size, "byte")));
    const std::string_view content = bytes.substr(at + kChunkHeader, size);
    if (k == 0) {
      if (type != kJson) fail(where, "is not JSON, expected the JSON chunk first");
      chunks.json = content;
    } else if (type == kBin) {
      chunks.bin = content;
      chunks.has_bin = true;
    }
    at = next_chunk(bytes, at + kChunkHeader + size);
  }
  while (!chunks.json.empty() && chunks.json.back() == '\0') chunks.json.remove_suffix(1);
  if (chunks.json.empty()) fail("chunk[0]", "is missing or empty, expected the JSON chunk");
  return chunks;
}

}  // namespace tdpt::gltf
