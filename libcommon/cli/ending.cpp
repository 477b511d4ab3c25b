#include "libcommon/cli/ending.h"

#include "libcommon/base/output_file.h"

namespace tdpt::cli {

void deliver(const std::vector<Deliverable>& files, const Common& common) {
  Phases untold;
  deliver(files, common, untold);
}

void deliver(const std::vector<Deliverable>& files, const Common& common, Phases& phases) {
  std::vector<OutputFile> made;
  for (const Deliverable& file : files) {
    if (file.path.empty()) continue;
    made.push_back({file.path, file.make()});
    phases.done(&file == &files.front() ? "write" : "pictures");
  }
  if (!common.dependencies.empty()) made.push_back({common.dependencies, common.dependency_rule()});
  write_outputs(made);
  phases.done("write");
}

}  // namespace tdpt::cli
