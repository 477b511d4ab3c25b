// What made a picture, looked up by the hash of its bytes: neither its path nor its time matters.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/tdpt/pipeline.h"

namespace tdpt {

struct Made {
  std::string key;    ///< Pipeline::key
  bool whole = true;  ///< not stopped by a signal
  /// Files written with it, by option: their hashes.
  std::map<std::string, std::string> beside;
};

/// One for each key of which a picture has these bytes; none: tdpt did not make it.
std::vector<Made> made_of(const std::string& hash, const WorkFolder& work);
/// Stores another, replacing that of the same key. Throws OutputError on failure.
void keep(const Made& made, const std::string& hash, const WorkFolder& work);

/// Stores beside a film in a picture's entry what it is of.
void keep_film_of(const Pipeline& p, const std::string& entry);
/// Whether the entry has a film of which `p` makes its picture: with more samples, or as it is.
bool goes_on(const Pipeline& p, const std::string& entry);

/// Of the file at that path; "" if there is none.
std::string hash_of_picture(const std::string& path);
/// Hashes of the existing files that --preview, --stats and --set nonzero name; that of the preview
/// with the exposure, if it is given.
std::map<std::string, std::string> files_written_beside(const RenderArguments& a);

/// Whether the picture exists, complete, as `p` would make it, with all files that belong to it but
/// the preview.
bool is_fresh(const Arguments& a, const Request& request, const Pipeline& p,
              const WorkFolder& work);
/// Whether the preview of that picture is there, with the exposure that is asked for, or none is
/// asked for.
bool preview_is_fresh(const Arguments& a, const Request& request, const Pipeline& p,
                      const WorkFolder& work);

/// The mark by which tdpt-render knows a frame of a shot, in a picture; empty for other files.
std::string frame_mark_in(const std::string& path);
/// Throws UsageError if the file exists and is no frame of a shot that tdpt-render has rendered.
void check_is_frame(const std::string& path);

/// Throws UsageError if the file exists and is no picture that tdpt made.
void check_is_ours(const std::string& picture, const WorkFolder& work);

}  // namespace tdpt
