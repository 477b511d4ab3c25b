// Where a file comes from: for every stage its version, the options that shaped the result and the
// content hashes of its inputs, oldest stage first. No time stamps.
//
// Lines of it have the forms
//   made by TOOL VERSION: TOOL OPTION ...
//   from NAME HASH
// A `from` line belongs to the `made by` line above it.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tdpt {

struct Provenance {
  std::vector<std::string> lines;

  /// Appends the lines of an input's own provenance that are not there yet.
  void inherit(const Provenance& input);
  /// Appends the `made by` line of this run.
  void made_by(const std::string& tool, const std::string& command);
  /// Appends a `from` line; only the file name of `path` is kept, not its folder.
  void from(const std::string& path, const std::string& hash);

  bool empty() const { return lines.empty(); }
};

/// 128-bit content hash (XXH3) of `bytes` as 32 lower-case hexadecimal digits. It detects mix-ups;
/// it is not cryptographic.
std::string content_hash(std::string_view bytes);

/// The same for the file `path`, read in pieces. Throws InputError if it cannot be read.
std::string content_hash_of_file(const std::string& path);

/// What determines a result: names ("scene", "--seed") with values. No name is there twice.
using Fingerprint = std::vector<std::pair<std::string, std::string>>;

/// The first difference: "another scene (1f3a, expected 77ab)"; "" if there is none.
std::string difference(const Fingerprint& found, const Fingerprint& expected);

/// Fingerprints with the same hash are equal.
std::string hash_of(const Fingerprint& fingerprint);

}  // namespace tdpt
