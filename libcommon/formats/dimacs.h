// Maximum-flow problems in DIMACS form (.max), with the geometry of their nodes in comments.
// Written by ffgraph; read by mincut and by every DIMACS solver. Grammar: man 5 max.
#pragma once
#include <string>
#include <vector>

#include "libcommon/flow/cut_facts.h"
#include "libcommon/formats/cut.h"

namespace tdpt {

/// Statistics of ffgraph's walks for one patch.
struct PatchWalks {
  double begun = 0;              ///< light walks that begin there
  double light = 0;              ///< hits of light walks
  std::vector<double> camera{};  ///< hits of the walks of each camera
};

/// Node k of `network` is node k + 1 of the file; Patch::node is the number in the file. The sink
/// of `network` is that of the first camera.
struct DimacsFile : PatchFile {
  FlowNetwork network;
  /// The sinks of the other cameras: the last nodes, from which no arc leads. To a solver they are
  /// dead ends.
  std::vector<uint32_t> more_sinks;
  double scale = 1;               ///< capacity of one etendue sample
  bool has_patches = false;       ///< false: a plain DIMACS file, of which only `hash` is known
  std::vector<PatchWalks> walks;  ///< per patch; empty: unknown
};

/// The network between the light and one camera, 0 the first: without the sinks of the others
/// [DimacsFile], and with its own for `sink`. Its nodes are those of the file's but the last ones.
PatchNetwork network_between(const DimacsFile& file, size_t camera);

/// Throws InputError with the line for anything but a maximum-flow problem with integer capacities:
/// fractions, negative capacities, sums beyond kLargestCapacitySum, nodes out of range, missing or
/// duplicate terminals, a wrong number of arcs.
DimacsFile read_dimacs(const std::string& path);
std::string dimacs_text(const DimacsFile& file);

}  // namespace tdpt
