// What the page of a shot shows, gathered for report_shot.py.
#pragma once
#include <string>

#include "tools/tdpt/request.h"

namespace tdpt {

/// The renderer's statistics of frames, beside them.
std::string stats_beside(const std::string& frames);

/// Throws UsageError if the file exists and is no frame of a shot that tdpt-render has rendered.
void check_is_frame(const std::string& path);
/// Throws UsageError for a file that is no statistics of a frame, and would be replaced by one.
void check_is_stats(const std::string& path);

/// Writes the statistics of a frame, which lie in the file `noisy`, to `path`, with those of the
/// filter in the file `filter`.
void write_filtered_stats(const std::string& noisy, const std::string& filter,
                          const std::string& path);

/// Writes into `folder`, which there is: strip.png, small pictures of frames side by side, as many
/// as a page bears, and shot.json, which names them and has the statistics of all frames, as far as
/// they are of these pictures. All frames must be there. Throws InputError, OutputError.
void gather_shot(const Arguments& a, const Request& request, const std::string& folder);

}  // namespace tdpt
