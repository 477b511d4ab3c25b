// The end that the programs share: every file of a run is made before the first is written, they
// are written together, and the summary says what the run cost.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "libcommon/base/phases.h"
#include "libcommon/base/threads.h"
#include "libcommon/cli/cli.h"

namespace tdpt::cli {

/// A file to deliver. Where `path` is empty none was asked for, and `make` is not called.
struct Deliverable {
  std::string path;
  std::function<std::string()> make;  ///< its bytes
};

/// Makes and writes `files`, the result first, and the dependency file of the run
/// [write_outputs, base/output_file.h]: what cannot be made or written leaves none of them behind.
void deliver(const std::vector<Deliverable>& files, const Common& common);
/// The same, told as the phases "write" and, of what lies beside the result, "pictures".
void deliver(const std::vector<Deliverable>& files, const Common& common, Phases& phases);

/// Prints `summary`, a JSON object, where --json says, with what the run cost: "phases",
/// "cpu_seconds" and "peak_bytes".
template <class Json>
void report(const Common& common, Json summary, const Phases& phases) {
  summary["phases"] = phases;
  summary["cpu_seconds"] = cpu_seconds();
  summary["peak_bytes"] = peak_memory();
  common.summary(summary.dump());
}

}  // namespace tdpt::cli
