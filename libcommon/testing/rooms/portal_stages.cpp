#include "libcommon/testing/rooms/portal_stages.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"

namespace tdpt::testing {
namespace {

const char* const kPrograms[] = {"ffgraph", "mincut", "lightgrid", "portalfit"};

std::string text_of(const std::string& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

double number_in(const std::string& json, const std::string& key) {
  const auto summary = nlohmann::json::parse(json, nullptr, /*allow_exceptions=*/false);
  return summary.is_object() && summary.contains(key) ? summary[key].get<double>() : 0;
}

}  // namespace

StagesRun run_stages(const PortalStages& stages, const std::string& stem) {
  const auto command = [&](const std::string& name, const std::string& files) {
    const auto extra = stages.options.find(name);
    const bool light = name == "ffgraph" || name == "lightgrid";
    return stages.bin + "/" + name + " --json --threads " + std::to_string(stages.threads) + " " +
           (light ? stages.sky + " " : "") + (extra == stages.options.end() ? "" : extra->second) +
           " " + files + " >" + stem + "." + name + ".json 2>" + stem + "." + name + ".txt";
  };
  const std::string commands =
      command("ffgraph", stem + ".glb -o " + stem + ".max") + " && " +
      command("mincut", stem + ".max -o " + stem + ".cut") + " && " +
      command("lightgrid", stem + ".glb " + stem + ".cut -o " + stem + ".vdb") + " && " +
      command("portalfit", stem + ".vdb -o " + stem + ".portal.glb");
  StagesRun run;
  run.failed = std::system(commands.c_str()) != 0;
  try {
    if (!run.failed) run.portals = read_portals(stem + ".portal.glb").portals;
  } catch (const InputError&) {
    run.failed = true;
  }
  for (const char* name : kPrograms)
    run.cpu_seconds += number_in(text_of(stem + "." + name + ".json"), "cpu_seconds");
  run.voxel = number_in(text_of(stem + ".lightgrid.json"), "voxel");
  run.said = text_of(stem + ".portalfit.txt");
  return run;
}

void remove_stages(const std::string& stem) {
  for (const char* end : {".glb", ".max", ".cut", ".vdb", ".portal.glb"})
    std::filesystem::remove(stem + end);
  for (const char* name : kPrograms)
    for (const char* end : {".json", ".txt"}) std::filesystem::remove(stem + "." + name + end);
}

}  // namespace tdpt::testing
