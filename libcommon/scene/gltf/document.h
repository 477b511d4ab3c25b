// A glTF file taken apart and checked so far that its parts can be walked without fear: JSON of the
// right types, references inside their arrays, buffers in memory. Internal to this room.
#pragma once
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

namespace tdpt::gltf {

/// What is wrong with cameras that nodes of the scene hold, by their index: who takes one throws
/// it.
using CameraFaults = std::map<int, std::shared_ptr<const InputError>>;

struct Document {
  std::string file;                       ///< what messages call it
  std::string folder;                     ///< external files lie in it; empty: none may be read
  nlohmann::json json;                    ///< checked by check_json()
  tinygltf::Model model;                  ///< without buffers and images
  std::vector<std::string_view> buffers;  ///< of the byteLength they declare; else empty: not used
  std::string hash;                       ///< of the file and the external buffers
  std::string bytes;                      ///< the file; buffers point into it
  std::deque<std::string> owned;          ///< decoded and external buffers
  std::vector<std::string> files;         ///< paths of external buffers
  std::set<std::string> extensions;       ///< those that extensionsUsed names
  mutable std::map<size_t, std::string> unpacked;  ///< compressed bufferViews that were asked for
  mutable size_t bytes_unpacked = 0;               ///< of all of them
  std::vector<std::string> warnings;  ///< sentences: what is wrong and changes no picture
  CameraFaults camera_faults;

  [[noreturn]] void fail(const std::string& place, const std::string& message) const {
    throw InputError(file, place, message);
  }
};

/// "accessors[3]", the place of an element in messages.
std::string place(const char* section, size_t index);

/// "1 material is", "3 materials are".
std::string counted(size_t n, const std::string& noun, const std::string& one,
                    const std::string& many);

/// The warning about `faults` errors, of which `first` is one, in what nothing needs.
std::string unused_sentence(const std::string& file, const std::string& first, size_t faults);

/// Reads and checks `path` ("-": standard input) into `document`. Throws InputError.
void open_document(const std::string& path, Document& document);

/// The chunks of a .glb, or the whole text of a .gltf and no binary part. Throws InputError.
struct Chunks {
  std::string_view json, bin;
  bool has_bin = false;
};
/// `warnings` get a sentence for what is wrong with the container and can be read nonetheless.
Chunks split_chunks(std::string_view bytes, const std::string& file,
                    std::vector<std::string>& warnings);

/// What check_json() found.
struct Checked {
  std::vector<std::string> warnings;
  std::vector<bool> buffers;  ///< those that the scene needs
  CameraFaults cameras;
};

/// JSON of a glTF file. Throws InputError for what is none, or nested beyond any use.
nlohmann::json parse_json(std::string_view text, const std::string& file);

/// Types, ranges and references of every field this room reads; integers written as 3.0 become 3.
/// Throws InputError with the place of the first field that is wrong and may change the picture;
/// what nothing in the scene uses is replaced where it is wrong, and so are cameras.
Checked check_json(nlohmann::json& json, const std::string& file);

/// A URI that may be followed, but leads to nothing; `what_is`: "a file that is not there", for a
/// sentence about it.
struct NothingThere : InputError {
  NothingThere(const InputError& error, std::string what_) : InputError(error), what_is(what_) {}
  std::string what_is;
};

/// The bytes a URI stands for: a base64 data URI or a file in the scene's folder or below. Throws
/// InputError when it points elsewhere, NothingThere when it is not there or cannot be decoded.
/// `file_read`: path of the file; empty for a data URI.
std::string read_uri(const Document& document, const std::string& uri, const std::string& place,
                     std::string& file_read);

/// Whether we read this extension, or approximate what it asks for with a warning.
bool is_supported(const std::string& extension);

/// Whether an extension that a file requires means nothing to a picture: metadata, what can be
/// chosen or touched, physics, sound, hints for speed.
bool changes_no_picture(const std::string& extension);

/// Whether extensionsUsed names it.
bool uses_extension(const Document& document, const std::string& name);

/// The bytes of a bufferView, decoded where EXT_meshopt_compression says that it is compressed.
/// Throws InputError when it reaches beyond its buffer or cannot be decoded.
std::string_view view_bytes(const Document& document, size_t view);

/// `size` bytes of a buffer; throws InputError, naming `place`, where it has fewer.
std::string_view buffer_bytes(const Document& document, const std::string& place, size_t buffer,
                              size_t offset, size_t size);

/// More bytes than accessors can read: those of the file, its buffers and what they hold
/// compressed.
size_t most_bytes(const Document& document);

}  // namespace tdpt::gltf
