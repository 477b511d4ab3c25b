// Who made a picture: known by its bytes, so wherever it lies and whatever the clock says.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "tools/tdpt/pipeline.h"

namespace tdpt {

struct Made {
  Words identity;     ///< of the request that made it
  std::string key;    ///< Pipeline::key
  bool whole = true;  ///< not stopped by a signal
  /// What was written with it, by option: hashes of the files.
  std::map<std::string, std::string> beside;
};

/// Of the picture at that path; nothing where its bytes are not known. Throws InputError where it
/// cannot be read.
std::optional<Made> made_of(const std::string& picture, const WorkFolder& work);

std::string text_of(const Made& made);
/// Nothing for what is none.
std::optional<Made> parse_made(const std::string& text);

/// Hashes of the files that --preview, --stats and --nonzero name, where they are there.
std::map<std::string, std::string> files_written_beside(const RenderArguments& a);

/// Whether the picture is there, whole, as `p` would make it, and all that goes with it.
bool is_fresh(const Arguments& a, const Request& request, const Pipeline& p,
              const WorkFolder& work);

/// What a run that was stopped left in the picture's entry: of whom that picture is, then.
std::optional<Made> unfinished(const Pipeline& p, const WorkFolder& work);

/// Throws UsageError where the picture is there and another command made it, or nobody known.
void check_owner(const Request& request, const Pipeline& p, const WorkFolder& work);

}  // namespace tdpt
