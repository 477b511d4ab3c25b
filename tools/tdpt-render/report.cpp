#include "tools/tdpt-render/report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace tdpt {

std::string stats_json(const Integrator& integrator, const RenderSettings& settings,
                       const RenderResult& result) {
  const Vec3d mean = result.mean();
  nlohmann::ordered_json j;
  j["integrator"] = integrator.name;
  j["spp"] = result.spp;
  j["width"] = result.picture.width;
  j["height"] = result.picture.height;
  j["max_depth"] = settings.max_depth;
  j["seconds"] = result.seconds;
  j["cpu_seconds"] = result.cpu_seconds;
  j["mean"] = {mean.x, mean.y, mean.z};
  j["nonzero"] = result.nonzero();
  const RayCounts& rays = result.tally.rays;
  j["rays"] = {{"closest", rays.closest}, {"shadow", rays.shadow}, {"portal", rays.portal}};
  double total = 0;
  for (double e : result.tally.energy) total += e;
  auto& techniques = j["techniques"] = nlohmann::ordered_json::object();
  for (size_t i = 0; i < kTechniques; ++i)
    if (integrator.techniques.has(static_cast<Technique>(i)))
      techniques[kTechniqueNames[i]] = total > 0 ? result.tally.energy[i] / total : 0.0;
  j["not_finite"] = result.tally.not_finite;
  return j.dump();
}

std::map<std::string, std::string> exr_attributes(const Integrator& integrator,
                                                  const RenderSettings& settings,
                                                  const RenderResult& result,
                                                  const Provenance& provenance) {
  std::map<std::string, std::string> a;
  a["integrator"] = integrator.name;
  a["spp"] = std::to_string(result.spp);
  a["maxDepth"] = std::to_string(settings.max_depth);
  a["seed"] = std::to_string(settings.seed);
  a["mis"] = settings.beta == 1 ? "balance" : "power";
  a["pixelFilter"] = "box, one pixel wide";
  a["colorSpace"] = "scene-linear Rec.709";
  if (!provenance.empty()) a["provenance"] = fmt::format("{}", fmt::join(provenance.lines, "\n"));
  return a;
}

}  // namespace tdpt
