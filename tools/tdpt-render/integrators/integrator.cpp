#include "tools/tdpt-render/integrators/integrator.h"

#include <algorithm>

#include <fmt/format.h>

#include "libcommon/base/error.h"

namespace tdpt {

const Integrator& integrator_named(const std::string& name) {
  if (const Integrator* integrator = find_integrator(name)) return *integrator;
  throw UsageError("--integrator: '" + name + "' is not known");
}

std::string label_of(const Integrator& integrator) {
  const Mixture& m = integrator.mixture;
  std::string label = integrator.name;
  if (m.guiding != Guiding{}) {
    label += fmt::format(" {:g} {:g}", m.guiding.chance[0], m.guiding.chance[1]);
    if (m.has(Technique::portal)) label += fmt::format(" {:g}", m.segments);
  }
  if (m.light_walks < 1) label += fmt::format(", light walks {:g}", m.light_walks);
  return label;
}

namespace {
bool has_smooth_lobe(const Material& m) {
  return !m.plain && (m.roughness < 0.01f || m.maps[MAP_METALLIC_ROUGHNESS]) &&
         (m.metallic > 0 || m.specular > 0 || m.transmission > 0);
}
}  // namespace

std::string light_missed(const Integrator& integrator, const Scene& scene) {
  const TechniqueSet& techniques = integrator.mixture.techniques;
  if (scene.lights.empty() || techniques.has(Technique::bi)) return "";
  const std::string name = integrator.name;
  if (!techniques.has(Technique::direct))
    return name + " meets no lamp without surface: the light of those is missing";
  if (std::none_of(scene.materials.begin(), scene.materials.end(), has_smooth_lobe)) return "";
  if (!techniques.has(Technique::light))
    return name + " misses what smooth surfaces throw of the light of lamps without surface";
  return name + " misses light of lamps without surface that smooth surfaces throw and show again";
}

}  // namespace tdpt
