#include "tools/tdpt-render/integrators/integrator.h"

#include "libcommon/base/error.h"

namespace tdpt {

const std::vector<const Integrator*>& integrators() {
  static const std::vector<const Integrator*> all{&pt, &nee, &bdpt, &tdpt_org, &tdpt_ref};
  return all;
}

const Integrator& integrator_named(const std::string& name) {
  for (const Integrator* integrator : integrators())
    if (name == integrator->name) return *integrator;
  throw UsageError("--integrator: '" + name + "' is not known");
}

}  // namespace tdpt
