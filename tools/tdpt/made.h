// Who made a picture: known by its bytes, so wherever it lies and whatever the clock says.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/tdpt/pipeline.h"

namespace tdpt {

struct Made {
  Words identity;     ///< of the request that made it
  std::string key;    ///< Pipeline::key
  bool whole = true;  ///< not stopped by a signal
  /// What was written with it, by option: hashes of the files.
  std::map<std::string, std::string> beside;
};

/// By each request that has made a picture of these bytes; none where they are not known.
std::vector<Made> made_of(const std::string& hash, const WorkFolder& work);
/// Keeps one more, or in the place of what the same request has made before. Throws OutputError
/// where it cannot be kept.
void keep(const Made& made, const std::string& hash, const WorkFolder& work);

/// What a picture's entry holds beside a checkpoint: what that is of.
struct Unfinished {
  std::string key;  ///< Pipeline::key
};
void keep(const Unfinished& unfinished, const std::string& entry);
std::optional<Unfinished> unfinished_in(const std::string& entry);

/// Of the file at that path; "" where there is none.
std::string hash_of_picture(const std::string& path);
/// Hashes of the files that --preview, --stats and --set nonzero name, where they are there.
std::map<std::string, std::string> files_written_beside(const RenderArguments& a);

/// Whether the picture is there, whole, as `p` would make it, and all that goes with it.
bool is_fresh(const Arguments& a, const Request& request, const Pipeline& p,
              const WorkFolder& work);

/// Throws UsageError where the picture is there and another command made it, or nobody known.
void check_owner(const Request& request, const WorkFolder& work);

}  // namespace tdpt
