#include "libcommon/formats/debug_lines.h"

namespace tdpt {

void declare_debug_lines(cli::Options& options, std::string& value) {
  options.choice("--set debug-lines", value, {"edges", "strips"},
                 "Lines in --debug-glb: edges, the default, or thin strips, which renderers show",
                 cli::Effect::told);
}

DebugLines debug_lines(const std::string& value) {
  return value == "strips" ? DebugLines::strips : DebugLines::edges;
}

}  // namespace tdpt
