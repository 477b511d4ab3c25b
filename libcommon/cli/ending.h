// How all programs end: every output file is made before the first is written, they are written
// together, and the summary says what the run cost.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "libcommon/base/phases.h"
#include "libcommon/base/threads.h"
#include "libcommon/cli/cli.h"

namespace tdpt::cli {

/// A file to deliver. If `path` is empty, none was asked for and `make` is not called.
struct Deliverable {
  std::string path;
  std::function<std::string()> make;  ///< its bytes
};

/// Makes and writes `files`, the result first, and the run's dependency file [write_outputs,
/// base/output_file.h]. If one cannot be made or written, none of them is left behind.
void deliver(const std::vector<Deliverable>& files, const Common& common);
/// The same, timed as the phases "write" and, for files beside the result, "pictures".
void deliver(const std::vector<Deliverable>& files, const Common& common, Phases& phases);

/// Prints `summary`, a JSON object, where --json says, adding the cost of the run: "phases",
/// "cpu_seconds" and "peak_bytes".
template <class Json>
void report(const Common& common, Json summary, const Phases& phases) {
  summary["phases"] = phases;
  summary["cpu_seconds"] = cpu_seconds();
  summary["peak_bytes"] = peak_memory();
  common.summary(summary.dump());
}

}  // namespace tdpt::cli
