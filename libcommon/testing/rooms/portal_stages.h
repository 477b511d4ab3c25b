// Runs the four programs that find portals on a scene, one after the other.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"

namespace tdpt::testing {

struct PortalStages {
  std::string bin;                               ///< folder of the programs
  std::map<std::string, std::string> options{};  ///< additional ones, by program
  int threads = 1;
  std::string sky{};  ///< for the programs that need the light
};

struct StagesRun {
  bool failed = false;
  std::vector<Portal> portals;
  double cpu_seconds = 0;  ///< of all programs together
  double voxel = 0;        ///< of the light grid; 0 without a bottleneck [metres]
  std::string said;        ///< output of portalfit
};

/// Runs them on STEM.glb. They leave STEM.max, .cut, .vdb and .portal.glb, and their messages in
/// STEM.PROGRAM.txt and .json.
StagesRun run_stages(const PortalStages& stages, const std::string& stem);

/// Removes what run_stages leaves, and STEM.glb.
void remove_stages(const std::string& stem);

}  // namespace tdpt::testing
