// An integrator is a set of techniques and the order in which a sample runs them.
#pragma once
#include <string>
#include <vector>

#include "tools/tdpt-render/path/path_sampler.h"

namespace tdpt {

struct Integrator {
  const char* name;
  uint64_t stream;  ///< of random numbers: no two integrators share samples
  TechniqueSet techniques;
  void (*sample)(PathSampler&);
  Guiding guiding{};  ///< how its walks are directed at the portals
};

extern const Integrator pt, nee, bdpt, tdpt_org, tdpt_ref, tdpt_guided;
/// tdpt_guided directed more often, and less often with fewer segments, for `auto` to choose among.
extern const Integrator tdpt_guided_more, tdpt_guided_less;
/// All three, the likeliest first.
const std::vector<const Integrator*>& all_guided();

/// All of them, in the order of the paper.
const std::vector<const Integrator*>& integrators();
/// Throws UsageError for a name that there is not.
const Integrator& integrator_named(const std::string& name);

/// Its name, and if its walks are directed, how, and the share of samples with segments:
/// "tdpt-guided 0.5 0.4 1".
std::string label_of(const Integrator& integrator);

/// A sentence about light that the scene has and none of the integrator's techniques can make
/// (tdpt(7), "Lamps without surface"); empty when there is none to speak of.
std::string light_missed(const Integrator& integrator, const Scene& scene);

}  // namespace tdpt
