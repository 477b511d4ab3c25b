#include "libcommon/cli/ending.h"

#include "libcommon/base/output_file.h"

namespace tdpt::cli {

void deliver(const std::vector<Deliverable>& files) {
  Phases untold;
  deliver(files, untold);
}

void deliver(const std::vector<Deliverable>& files, Phases& phases) {
  std::vector<OutputFile> made;
  for (const Deliverable& file : files) {
    if (file.path.empty()) continue;
    made.push_back({file.path, file.make()});
    phases.done(&file == &files.front() ? "write" : "pictures");
  }
  write_outputs(made);
  phases.done("write");
}

}  // namespace tdpt::cli
