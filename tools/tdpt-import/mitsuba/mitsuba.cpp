#include "tools/tdpt-import/mitsuba/mitsuba.h"

#include <fmt/format.h>

#include <set>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/mitsuba/lights.h"
#include "tools/tdpt-import/mitsuba/sensor.h"
#include "tools/tdpt-import/mitsuba/shapes.h"
#include "tools/tdpt-import/mitsuba/surfaces.h"
#include "tools/tdpt-import/mitsuba/xml.h"

namespace tdpt::foreign {
namespace mitsuba {
namespace {

// What an integrator leaves out of the light.
void read_integrator(const Object& integrator, Source& source) {
  static const std::set<std::string> kWhole = {"adaptive",
                                               "aov",
                                               "bdpt",
                                               "erpt",
                                               "irrcache",
                                               "mlt",
                                               "moment",
                                               "path",
                                               "ppm",
                                               "photonmapper",
                                               "prb",
                                               "pssmlt",
                                               "ptracer",
                                               "sppm",
                                               "stokes",
                                               "vpl",
                                               "volpath",
                                               "prb_basic",
                                               "prb_projective",
                                               "prbvolpath",
                                               "volpath_simple",
                                               "volpathmis"};
  const std::string& type = integrator.type;
  if (type == "direct")
    source.lose_longer_paths(integrator.place, 2);
  else if (!kWhole.contains(type))
    return source.lose(
        integrator.place,
        fmt::format("the {}, which shows other light than all that there is, is left out",
                    described(integrator)));
  source.lose_longer_paths(integrator.place, integrator.integer("max_depth", -1));
  if (integrator.flag("hide_emitters", false))
    source.lose(integrator.place, "lamps that the camera does not see (hide_emitters) are seen");
  for (const Object* inner : integrator.nested("integrator")) read_integrator(*inner, source);
  integrator.ignore({"alpha", "aovs", "auto_cancel_gathering", "bidirectional",
                     "bidirectional_mutation", "block_size", "bsdf_samples",
                     "caustic_lookup_radius", "caustic_lookup_size", "caustic_perturbation",
                     "caustic_photons", "chain_length", "clamping", "debug", "derivatives_only",
                     "direct_samples", "emitter_samples", "first_stage"});  // how it samples
  integrator.ignore({"first_stage_size_reduction", "gather_locally", "global_lookup_radius",
                     "global_lookup_size", "global_photons", "glossy_samples", "gradients",
                     "granularity", "guiding", "initial_radius", "kelemen_style_weights", "lambda",
                     "lens_perturbation", "light_image", "lookup_size", "luminance_samples",
                     "manifold_perturbation", "max_chains"});
  integrator.ignore({"max_error", "max_passes", "max_sample_factor", "multi_chain_perturbation",
                     "mutation_size_high", "mutation_size_low", "num_chains", "overture", "p_large",
                     "p_value", "photon_count", "prob_factor", "quality", "quality_adjustment",
                     "resolution", "rr_depth", "sample_direct", "samples_per_pass"});
  integrator.ignore({"shading_samples", "shadow_map_resolution", "show_weighted", "strict_normals",
                     "timeout", "two_stage", "use_spectral_mis", "verbose", "volume_lookup_size",
                     "volume_photons", "work_units"});
}

}  // namespace
}  // namespace mitsuba

Described read_mitsuba(Source& source, const std::map<std::string, std::string>& parameters) {
  using namespace mitsuba;
  const Document document = parse(source, parameters);
  Described scene;
  Textures textures(scene, source);
  Surfaces surfaces(scene, source, textures);
  Shapes shapes(scene, source, textures, surfaces);
  for (const Object* shape : document.scene->nested("shape")) shapes.add(*shape);
  for (const Object* emitter : document.scene->nested("emitter"))
    if (emitter->type != "area" && !shapes.is_used(*emitter))  // those of shapes
      add_light(*emitter, scene, source, textures);
  for (const Object* sensor : document.scene->nested("sensor")) add_camera(*sensor, scene, source);
  for (const Object* integrator : document.scene->nested("integrator"))
    read_integrator(*integrator, source);
  for (const Object* scattering : document.scene->nested("subsurface"))
    source.lose(scattering->place, "subsurface scattering is left out");
  for (const char* kind :
       {"bsdf", "film", "medium", "phase", "random", "rfilter", "sampler", "texture", "volume"})
    document.scene->nested(kind);  // they wait for a reference to them, or are how to render
  document.scene->ignore({"allow_thread_reordering", "compact_acceleration_structures",
                          "embree_use_robust_intersections", "kd_clip", "kd_empty_space_bonus",
                          "kd_exact_primitive_threshold", "kd_intersection_cost",
                          "kd_max_bad_refines", "kd_max_depth", "kd_min_max_bins",
                          "kd_parallel_build", "kd_retract", "kd_retract_bad_splits",
                          "kd_stop_prims", "kd_traversal_cost"});  // how rays are traced
  shapes.tell_backs();
  return scene;
}

}  // namespace tdpt::foreign
