// A glTF file, parsed and checked so far that its parts can be accessed safely: JSON of the right
// types, indices within their arrays, buffers in memory. Internal to this room.
#pragma once
#include <fmt/format.h>
#include <tiny_gltf.h>
#include <deque>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"

namespace tdpt::gltf {

struct Document {
  std::string file;                       ///< name in messages
  std::string folder;                     ///< for external files; empty: none may be read
  nlohmann::json json;                    ///< checked by check_json()
  tinygltf::Model model;                  ///< without buffers and images
  std::vector<std::string_view> buffers;  ///< of their declared byteLength; null: fallbacks
  std::string hash;                       ///< over the file and the external buffers
  std::string bytes;                      ///< the file; buffers point into it
  std::deque<std::string> owned;          ///< decoded and external buffers
  std::vector<std::string> files;         ///< paths of external buffers
  std::set<std::string> extensions;       ///< those that extensionsUsed names
  mutable std::map<size_t, std::string> unpacked;  ///< compressed bufferViews decoded so far
  mutable size_t bytes_unpacked = 0;               ///< sum over all of them
  std::vector<std::string> warnings;               ///< sentences: errors that change no picture
  /// Names of the animations to apply, set before the file is opened; none: all.
  std::vector<std::string> wanted_animations;

  [[noreturn]] void fail(const std::string& place, const std::string& message) const {
    throw InputError(file, place, message);
  }
};

/// "accessors[3]": place of an element in messages.
std::string place(const char* section, size_t index);

/// "1 material is", "3 materials are".
std::string counted(size_t n, const std::string& noun, const std::string& one,
                    const std::string& many);

/// Makes names unique.
class DistinctNames {
 public:
  /// The first of the two names that is not empty and not taken. If there is none, the first that
  /// is not empty, or `otherwise`, with a number: "door.1".
  std::string take(const std::string& first, const std::string& second,
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

 private:
  std::set<std::string> taken_;
  std::map<std::string, size_t> numbers_;
};

/// Reads and checks `path` ("-": standard input) into `document`. Throws InputError.
void open_document(const std::string& path, Document& document);

/// The chunks of a .glb, or the text of a .gltf and no binary chunk. Throws InputError.
struct Chunks {
  std::string_view json, bin;
  bool has_bin = false;
};
/// Adds a sentence to `warnings` for container errors that do not prevent reading.
Chunks split_chunks(std::string_view bytes, const std::string& file,
                    std::vector<std::string>& warnings);

/// Parses the JSON of a glTF file. Throws InputError if it is malformed or nested too deeply.
nlohmann::json parse_json(std::string_view text, const std::string& file);

/// Checks types, ranges and references of every field that this room reads; integers written as 3.0
/// become 3. Throws InputError with the place of the first wrong field. Animations get distinct
/// names; those that are not among `animations` (empty: all are wanted) move nothing. The result:
/// sentences about what changes no picture.
std::vector<std::string> check_json(nlohmann::json& json, const std::string& file,
                                    const std::vector<std::string>& animations);

/// The bytes behind a URI: a base64 data URI, or a file in the scene's folder or below. Throws
/// InputError if it points elsewhere, NothingThere if it is missing or cannot be decoded.
/// `file_read`: path of the file; empty for a data URI.
std::string read_uri(const Document& document, const std::string& uri, const std::string& place,
                     std::string& file_read);

/// Whether this extension is read, or approximated with a warning.
bool is_supported(const std::string& extension);

/// Whether a required extension has no effect on pictures: metadata, interaction, physics, sound,
/// performance hints.
bool changes_no_picture(const std::string& extension);

/// Whether extensionsUsed names it.
bool uses_extension(const Document& document, const std::string& name);

/// The bytes of a bufferView, decoded if it is compressed by EXT_meshopt_compression. Throws
/// InputError if it exceeds its buffer or cannot be decoded.
std::string_view view_bytes(const Document& document, size_t view);

/// `size` bytes of a buffer; throws InputError, naming `place`, if it has fewer.
std::string_view buffer_bytes(const Document& document, const std::string& place, size_t buffer,
                              size_t offset, size_t size);

/// Upper bound on the bytes that accessors can read: those of the file, its buffers and their
/// decompressed contents.
size_t most_bytes(const Document& document);

/// "%20" becomes a blank, and so on.
std::string percent_decode(std::string_view text);

}  // namespace tdpt::gltf
