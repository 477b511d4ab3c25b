#include "tools/tdpt-render/integrators/integrator.h"

#include <algorithm>

#include <fmt/format.h>

#include "libcommon/base/error.h"

namespace tdpt {

const std::vector<const Integrator*>& integrators() {
  static const std::vector<const Integrator*> all{&pt,       &nee,      &bdpt,
                                                  &tdpt_org, &tdpt_ref, &tdpt_guided};
  return all;
}

const std::vector<const Integrator*>& all_guided() {
  static const std::vector<const Integrator*> all{&tdpt_guided, &tdpt_guided_more,
                                                  &tdpt_guided_less};
  return all;
}

const Integrator& integrator_named(const std::string& name) {
  for (const Integrator* integrator : integrators())
    if (name == integrator->name) return *integrator;
  throw UsageError("--integrator: '" + name + "' is not known");
}

std::string label_of(const Integrator& integrator) {
  const auto [light, camera] = integrator.guiding.chance;
  if (light == 0 && camera == 0) return integrator.name;
  return fmt::format("{} {:g} {:g} {:g}", integrator.name, light, camera,
                     integrator.techniques.segments());
}

namespace {
bool has_smooth_lobe(const Material& m) {
  return !m.plain && (m.roughness < 0.01f || m.metallic_roughness_map) &&
         (m.metallic > 0 || m.specular > 0 || m.transmission > 0);
}
}  // namespace

std::string light_missed(const Integrator& integrator, const Scene& scene) {
  const TechniqueSet& set = integrator.techniques;
  if (scene.lights.empty() || set.has(Technique::bi)) return "";
  const std::string name = integrator.name;
  if (!set.has(Technique::direct))
    return name + " meets no lamp without surface: the light of those is missing";
  if (std::none_of(scene.materials.begin(), scene.materials.end(), has_smooth_lobe)) return "";
  if (!set.has(Technique::light))
    return name + " misses what smooth surfaces throw of the light of lamps without surface";
  return name + " misses light of lamps without surface that smooth surfaces throw and show again";
}

}  // namespace tdpt
