// Merges parts of a picture.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libcommon/cli/cli.h"
#include "libcommon/film/film_file.h"

namespace tdpt {

/// Reads films one by one and adds them; the data for resuming a rendering is dropped. `first`: the
/// bytes of the first. Throws InputError.
FilmFile merged(std::string first, const std::vector<std::string>& paths);

/// Throws InputError that lists missing samples; `file` names what was merged.
void check_whole(const FilmFile& film, const std::string& file);

/// One JSON object, the keys of exrmerge(1). `film`: merged of so many; none if a picture is shown.
/// `exposure`: of the preview, if there is one.
std::string summary_json(const Picture& picture, const std::optional<FilmFile>& film, size_t films,
                         std::optional<double> exposure);

cli::Decisions decisions_of(const FilmFile& film);

}  // namespace tdpt
