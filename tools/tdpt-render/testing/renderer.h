// For tests: the renderer under test. Tests compiled with TDPT_BY_SCALAR use the device's renderer
// instead of the CPU's.
#pragma once
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/variant.h"
#ifdef TDPT_BY_SCALAR
#include "tools/tdpt-render/testing/device.h"
#endif

namespace tdpt {

#ifdef TDPT_BY_SCALAR
inline constexpr bool kByScalar = true;
#else
inline constexpr bool kByScalar = false;
#endif

inline std::shared_ptr<SampleRenderer> renderer_under_test(const Vista& vista) {
#ifdef TDPT_BY_SCALAR
  return std::make_shared<ScalarRenderer>(vista);
#else
  return std::make_shared<CpuRenderer>(vista);
#endif
}

/// The layers of the film by technique.
inline std::map<std::string, Picture> layers_of(const RenderResult& result) {
  std::map<std::string, Picture> layers;
  for (size_t i = 0; i < kTechniques; ++i)
    if (result.progress->film.has_layer(i))
      layers[kTechniqueNames[i]] = result.progress->film.layer(i);
  return layers;
}

/// For the scalar build, which takes ten times as long per sample: a few.
inline std::vector<const Integrator*> integrators_under_test() {
  if (kByScalar) return {&pt, &tdpt_guided};
  return integrators();
}

}  // namespace tdpt
