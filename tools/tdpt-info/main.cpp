// tdpt-info: what a file is, how it was made, and whether it is intact.
#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/progress.h"
#include "libcommon/cli/cli.h"
#include "libcommon/formats/light_tables.h"
#include "tools/tdpt-info/knowledge.h"

namespace tdpt {
namespace {

constexpr cli::Program kProgram{
    "tdpt-info",     "Tells what a file is, how it was made, and whether it is intact.",
    nullptr,         cli::Result::text,
    cli::kLibraries, cli::kCommit,
    cli::kNone};

struct Arguments {
  std::vector<std::string> files;
  std::string dump;
};

void declare_options(cli::Options& options, Arguments& a) {
  options.common.output.clear();
  options.arguments("files", a.files, "Any files of these programs; - is standard input");
  options.choice("--dump", a.dump, light_table_names(),
                 "Print a table of a light grid as CSV instead, for programs of one's own",
                 cli::Effect::report);
}

int dump(const Arguments& a, const cli::Common& common) {
  std::vector<cli::Common::Input> files;
  common.print(light_table_text(read_light(a.files, files), a.dump));
  return 0;
}

// Describes all files; the first damaged one decides the exit code.
int run(const Arguments& a, const cli::Common& common) {
  if (!a.dump.empty()) return dump(a, common);
  int code = 0;
  for (const std::string& path : a.files) {
    try {
      const Knowledge known = knowledge_of(path);
      common.print(common.json ? json_of(known) + "\n" : text_of(known));
    } catch (const InputError& e) {
      if (a.files.size() == 1) throw;
      say(fmt::format("{}: {}", common.tool, e.what()));
      if (code == 0) code = static_cast<int>(e.code);
    }
  }
  return code;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
