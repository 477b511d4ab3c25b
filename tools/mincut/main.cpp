// mincut: minimum cut of a flow network, verified.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/threads.h"
#include "libcommon/cli/cli.h"
#include "tools/mincut/cut_of.h"
#include "tools/mincut/verify.h"

namespace tdpt {
namespace {

struct Arguments {
  std::string network = "-";
  int64_t cuts = 1;
  CutLimits limits;
};

int run(const Arguments& a, const cli::Common& common) {
  if (a.cuts > 1) throw UsageError("--cuts above 1 is not built yet: leave it at 1");
  check_output(common.output);
  const DimacsFile problem = read_dimacs(a.network);
  const MaxFlow flow = max_flow(problem.network);
  verify_max_flow(problem.network, flow);
  const Provenance provenance = common.provenance({{a.network, problem.hash, problem.provenance}});

  nlohmann::ordered_json summary;
  summary["nodes"] = problem.network.nodes;
  summary["arcs"] = problem.network.arcs.size();
  summary["flow"] = flow.value;
  summary["scale"] = problem.scale;
  if (!problem.has_patches) {
    write_output(common.output, plain_cut_text(problem, flow, provenance));
    common.note(fmt::format("maximum flow {}", flow.value));
  } else {
    CutFile cut = cut_of(problem, flow, a.limits);
    cut.provenance = provenance;
    write_output(common.output, cut_text(cut));
    summary["cut_arcs"] = cut.arcs.size();
    summary["conductance"] = cut.conductance;
    summary["bottleneck"] = cut.bottleneck;
    if (!cut.bottleneck) summary["reason"] = cut.reason;
    common.note(cut.bottleneck ? fmt::format("{} pivot pairs; {:.2g} of the smaller side's light "
                                             "crosses the cut",
                                             cut.arcs.size(), cut.conductance)
                               : "no bottleneck: " + cut.reason);
  }
  summary["cpu_seconds"] = cpu_seconds();
  common.summary(summary.dump());
  return 0;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  using namespace tdpt;
  Arguments a;
  cli::Options options("mincut", "Finds and verifies the minimum cut of a flow network.",
                       "Cut to write; default standard output");
  options.argument("network", a.network,
                   "Network (DIMACS maximum-flow problem); default standard input", false);
  options.option("--cuts", a.cuts, "K",
                 "Bottlenecks to find one behind the other; only 1, the default, is supported", 1,
                 64);
  options.option("--least-area", a.limits.least_area, "SHARE",
                 "Share of the area that the smaller side must have; default 0.03", 0, 0.5);
  options.option("--largest-conductance", a.limits.largest_conductance, "C",
                 "Largest share of the smaller side's light that may cross; default 0.12", 0, 1);
  return options.run_main(argc, argv, [&] { return run(a, options.common); });
}
