// Files that are read: whole, within --max-memory, and those that a scene names.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "libcommon/base/error.h"

namespace tdpt {

/// Contents of the file `path`, or of standard input for "-". Of a pipe or device that begins with
/// what no program here can read, which may never end, the beginning alone. Throws InputError if it
/// cannot be read, or if that takes more than memory_limit().
std::string read_file(const std::string& path);

/// How messages name `path`: the path itself, or "(standard input)" for "-".
std::string display_name(const std::string& path);

// --max-memory: the most memory that reading one file may take. Readers check before they allocate,
// wherever the file's size is no bound: compressed data, and data that is referenced many times.

/// Bytes; three quarters of the machine's memory unless set.
uint64_t memory_limit();
/// Call once, before anything is read.
void limit_memory(uint64_t bytes);

/// "1.5 GiB", "700 bytes".
std::string size_words(uint64_t bytes);
/// Bytes of "1500", "200M", "1.5G": K, M, G and T are powers of 1024. Empty for any other text.
std::optional<uint64_t> parse_size(std::string_view text);

/// Throws InputError with `file` and `place` if `what`, a plural noun ("3 x 2 pixels"), takes more
/// bytes than the limit.
void expect_memory(const std::string& file, const std::string& place, const std::string& what,
                   uint64_t bytes);
/// Throws UsageError if what the options ask for, likewise, takes more: "640 x 480 pixels (--width,
/// --height)".
void expect_memory(const std::string& what, uint64_t bytes);

// Files that a scene names. A scene may be untrusted, so it has access only to itself and to files
// in its own folder or below.

/// A name or URI that may be followed but leads to nothing; `what_is`, for a sentence about it: "a
/// file that is not there".
struct NothingThere : InputError {
  NothingThere(const InputError& error, std::string what_) : InputError(error), what_is(what_) {}
  std::string what_is;
};

/// The scene that names a file: its name in messages, and its folder; empty: it comes from standard
/// input and may name none.
struct Namer {
  std::string file, folder;
};

struct LocalFile {
  std::string path;  ///< the folder joined with the name
  std::string real;  ///< with symbolic links resolved
};

/// The file called `name`, a path relative to the scene's folder. Throws InputError if it lies
/// outside that folder, also by links, and NothingThere if it is missing. An existing file must be
/// a regular one.
LocalFile local_file(const Namer& namer, const std::string& name, const std::string& place);

/// The folder of the scene `path`; "" for standard input.
std::string folder_of(const std::string& path);

/// Whether objects and arrays of a foreign JSON are nested more than 32 deep. Ask before parsing:
/// the code that handles the values is recursive.
bool nested_too_deep(std::string_view json);

}  // namespace tdpt
