// The device renderer, as its scalar build on the CPU, makes the same picture as the renderer in
// doubles: block by block with independent random numbers, and nearly pixel by pixel with the same
// ones. Errors of some per cent in its tables are detected.
#include <gtest/gtest.h>

#include <bit>

#include "libcommon/testing/statistics/power.h"
#include "libcommon/testing/statistics/z_failure.h"
#include "tools/tdpt-render/testing/device.h"
#include "tools/tdpt-render/testing/stages.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::agreement_test {

constexpr int kWidth = 32, kHeight = 24, kBlock = 4;

struct Runs {
  uint64_t first_seed = 1, runs = 16, spp = 3;
  int max_depth = 8;
  double beta = 1;
};

RenderResult render_once(const Integrator& integrator, const Runs& runs, uint64_t seed,
                         SampleRenderer& renderer) {
  Job settings;
  settings.limits.spp = runs.spp;
  settings.max_depth = runs.max_depth;
  settings.beta = runs.beta;
  settings.seed = testing::fresh(seed);
  return render(renderer, integrator, settings);
}

testing::BlockRuns blocks(SampleRenderer& renderer, const Integrator& integrator,
                          const Runs& runs) {
  testing::BlockRuns all;
  for (uint64_t seed = runs.first_seed; seed < runs.first_seed + runs.runs; ++seed) {
    const RenderResult r = render_once(integrator, runs, seed, renderer);
    EXPECT_EQ(r.tally.not_finite, 0u);
    std::vector<double> run(size_t{kWidth / kBlock} * (kHeight / kBlock));
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        run[static_cast<size_t>(y / kBlock * (kWidth / kBlock) + x / kBlock)] +=
            luminance(r.picture.pixels[static_cast<size_t>(y * kWidth + x)]) / (kBlock * kBlock);
    all.add(run);
  }
  return all;
}

// One of at most 100 comparisons in a test.
testing::Agreement asked(testing::Agreement (*how)(const testing::BlockRuns&,
                                                   const testing::BlockRuns&),
                         const testing::BlockRuns& found, const testing::BlockRuns& known,
                         const Runs& runs) {
  testing::Agreement a = how(found, known);
  a.least = testing::kFalseAlarm / 100;
  testing::tell_answer(a, runs.runs * runs.spp);
  return a;
}

// With the same random numbers the means agree to some hundredths of a per cent; `blocks_too`: with
// independent ones, block by block.
void expect_agreement(const Stage& stage, const Runs& runs,
                      const std::vector<const Integrator*>& chosen = {&nee, &tdpt_guided},
                      bool blocks_too = false) {
  const Vista vista = stage.vista(kWidth, kHeight);
  CpuRenderer cpu(vista);
  ScalarRenderer scalar(vista);
  Runs others = runs;
  others.first_seed += 1000;
  for (const Integrator* integrator : chosen) {
    const testing::BlockRuns by_cpu = blocks(cpu, *integrator, runs),
                             paired = blocks(scalar, *integrator, runs);
    const std::string what = stage.name + ", " + integrator->name + " of the device";
    const testing::Agreement same = asked(testing::compare_paired, paired, by_cpu, runs);
    EXPECT_TRUE(testing::holds(same, what + ", paired", paired, by_cpu, kWidth / kBlock));
    std::printf("%-10s %-11s depth %2d: paired %+.5f %% p %.1e\n", stage.name.c_str(),
                integrator->name, runs.max_depth, 100 * same.relative, same.p_drift);
    if (!blocks_too) continue;
    const testing::BlockRuns by_scalar = blocks(scalar, *integrator, others);
    const testing::Agreement free = asked(testing::compare, by_scalar, by_cpu, runs);
    EXPECT_TRUE(testing::holds(free, what, by_scalar, by_cpu, kWidth / kBlock));
  }
}

TEST(device_agreement, rooms_with_crossing_portals) {
  expect_agreement(two_rooms_stage(), {}, {&bdpt, &tdpt_ref, &tdpt_guided}, true);
}
TEST(device_agreement, for_every_limit_of_depth) {
  for (const int depth : {2, 3})
    expect_agreement(two_rooms_stage(), {.max_depth = depth}, {&nee, &tdpt_org});
  expect_agreement({"ceiling", read_gltf(furnace_path()), {portal_in_the_furnace()}},
                   {.max_depth = 1});
}
TEST(device_agreement, without_a_limit_of_depth) {
  expect_agreement(culling_stage(), {.max_depth = kMaxDepth});
}
TEST(device_agreement, by_the_power_heuristic) {
  expect_agreement(door_stage(), {.beta = 2}, {&bdpt, &tdpt_ref});
}
TEST(device_agreement, all_materials) {
  expect_agreement(materials_stage(), {});
}
TEST(device_agreement, lamps_without_surface) {
  expect_agreement(lamps_stage(), {});
}
TEST(long_device_agreement, of_every_integrator_on_every_stage) {
  for (const Stage& stage : {two_rooms_stage(), door_stage(), materials_stage(), lamps_stage(),
                             sky_stage(), culling_stage(), everything_stage(), solids_stage()})
    expect_agreement(stage, {.runs = 32, .spp = 8}, integrators(), true);
  for (const int depth : {1, 2, 3, 4})
    expect_agreement(everything_stage(), {.max_depth = depth}, integrators());
}

// Coloured glass of which only the front exists, lit from within by the sky and by a lamp
// infinitely far away: light from there has passed no glass.
Stage open_glass_stage() {
  Scene scene = read_bytes(testing::glossy_rooms({}));
  scene = without_lamps(open_end(scene, 2.09));
  Material glass = clear_pane();
  glass.solid = true;
  glass.roughness = 0.5f;
  glass.absorption = {0.5f, 2, 8};
  scene = with_sheet(scene, glass, {1.5, 0.2, -0.8}, {0, 0, 1.6}, {0, 1.6, 0});
  PunctualLight sun;
  sun.kind = PunctualLight::Kind::directional;
  sun.direction = normalize(Vec3d{-1, -0.2, 0.1});
  sun.intensity = Rgb(2);
  scene.lights.push_back(sun);
  return {"open_glass", under(scene, one_colour_sky(Rgb(1))), {kWideWindow}};
}

TEST(device_agreement, what_is_infinitely_far_is_in_no_absorbing_solid) {
  expect_agreement(open_glass_stage(), {}, {&nee, &tdpt_org});
}

TEST(device_agreement, sky_sun_and_windows) {
  expect_agreement(sky_stage(), {});
}

// All that a film holds: the picture, its halves, its layers and its alpha.
std::vector<std::vector<Rgb>> planes_of(SampleRenderer& renderer, const Integrator& integrator) {
  Job settings;
  settings.limits.spp = 4;
  settings.max_depth = 8;
  settings.seed = 3;
  settings.alpha = settings.halves = settings.layers = true;
  const RenderResult r = render(renderer, integrator, settings);
  std::vector<std::vector<Rgb>> planes{r.picture.pixels, r.progress->film.half(0).pixels,
                                       r.progress->film.half(1).pixels};
  for (size_t i = 0; i < kTechniques; ++i)
    if (r.progress->film.has_layer(i)) planes.push_back(r.progress->film.layer(i).pixels);
  std::vector<Rgb>& alpha = planes.emplace_back();
  for (const float a : r.picture.alpha) alpha.emplace_back(a);
  return planes;
}

// Largest share of a plane's pixels that differ by more than a thousandth, of the pixel or of the
// mean, with the same samples and paths. Integrators that resample connections choose others on a
// device.
double share_that_differs(SampleRenderer& device, const Integrator& integrator) {
  CpuRenderer cpu(device.vista);
  const std::vector<std::vector<Rgb>> a = planes_of(cpu, integrator),
                                      b = planes_of(device, integrator);
  double most = 0;
  for (size_t plane = 0; plane < a.size(); ++plane) {
    float mean = 0;
    for (const Rgb& p : a[plane]) mean += luminance(p) / static_cast<float>(a[plane].size());
    double differ = 0;
    for (size_t i = 0; i < a[plane].size(); ++i) {
      const Rgb &p = a[plane][i], &q = b[plane][i];
      differ += max_component(max(p - q, q - p)) > 1e-3f * std::max(max_component(p), mean);
    }
    most = std::max(most, differ / static_cast<double>(a[plane].size()));
  }
  return most;
}

TEST(device_closeness, all_but_few_pixels_are_those_of_the_cpu) {
  Stage opaque = culling_stage();  // coverage and skies are drawn by other numbers
  opaque.scene.materials[0].alpha_mode = Material::Alpha::opaque;
  for (const Stage& stage :
       {two_rooms_stage(), door_stage(), lamps_stage(), solids_stage(), opaque}) {
    const Vista vista = stage.vista(kWidth, kHeight);
    ScalarRenderer scalar(vista);
    for (const Integrator* integrator : {&pt, &nee}) {
      if (integrator == &nee && stage.scene.sky) continue;
      const double share = share_that_differs(scalar, *integrator);
      std::printf("%-10s %-11s %.4f of the pixels differ\n", stage.name.c_str(), integrator->name,
                  share);
      EXPECT_LT(share, 0.02) << stage.name << " " << integrator->name;
    }
  }
}

// Faults, each in the device's tables.
class device_agreement_twin : public ::testing::Test {
 protected:
  testing::Agreement of(const char* what, const Integrator& integrator, const Faults& faults) {
    ScalarRenderer scalar(vista_, kEnough, faults);
    CpuRenderer cpu(vista_);
    const testing::BlockRuns found = blocks(scalar, integrator, runs_),
                             known = blocks(cpu, integrator, runs_);
    const testing::Agreement same = asked(testing::compare_paired, found, known, runs_);
    std::printf("%-36s %-11s %+.4f %% p %.1e\n", what, integrator.name, 100 * same.relative,
                same.p_drift);
    return same;
  }
  void expect_caught(const char* what, const Integrator& integrator,
                     const std::function<void(RenderTables&)>& spoil) {
    EXPECT_FALSE(of(what, integrator, {.tables = spoil}).holds()) << what;
  }
  void stand_before(const Stage& stage) {
    stage_ = stage;
    vista_ = stage_.vista(kWidth, kHeight);
  }

  Runs runs_{};
  Stage stage_ = two_rooms_stage();
  Vista vista_ = stage_.vista(kWidth, kHeight);
};

TEST_F(device_agreement_twin, a_density_off_by_2_percent_is_caught) {
  expect_caught("of next events", nee, [](RenderTables& t) {
    for (shader::Emitter& emitter : t.lights.emitters) emitter.pdf_A *= 1.02f;
  });
  expect_caught("of places on lamps, in weights", bdpt, [](RenderTables& t) {
    for (size_t i = 0; i < t.surfaces.faces.size(); ++i) {
      uint32_t& word = t.lights.words[t.lights.settings.first_pdf_A + i];
      word = std::bit_cast<uint32_t>(1.02f * std::bit_cast<float>(word));
    }
  });
  EXPECT_FALSE(
      of("of the film", bdpt, {.parameters = [](auto& p) { p.film_area *= 1.05f; }}).holds());
}

TEST_F(device_agreement_twin, a_density_of_portals_off_by_5_percent_is_caught) {
  stand_before({"window",
                read_gltf(TDPT_TESTDATA "/scenes/window.glb"),
                {rectangle({2.05, 0.2, -0.8}, {0, 0, 1.6}, {0, 1.6, 0})}});
  for (const Integrator* integrator : {&tdpt_ref, &tdpt_guided})
    expect_caught("of portal segments", *integrator, [](RenderTables& t) {
      for (shader::PortalFacet& facet : t.portals.facets) facet.density *= 1.05f;
    });
}

TEST_F(device_agreement_twin, a_cosine_off_by_2_percent_is_caught) {
  expect_caught("of lamps", nee, [](RenderTables& t) {
    for (shader::Emitter& emitter : t.lights.emitters) emitter.normal = emitter.normal * 0.98f;
    for (shader::Face& face : t.surfaces.faces)
      if (t.surfaces.materials[face.material].flags & MATERIAL_EMITS)
        face.normal = face.normal * 0.98f;
  });
}

TEST_F(device_agreement_twin, a_lobe_of_3_percent_more_is_caught) {
  runs_.runs = 40;
  stand_before(solids_stage());
  expect_caught("colours", nee, [](RenderTables& t) {
    for (shader::SurfaceMaterial& m : t.surfaces.materials) m.base_color = m.base_color * 1.03f;
  });
  expect_caught("colours of metals", nee, [](RenderTables& t) {
    for (shader::SurfaceMaterial& m : t.surfaces.materials)
      if (m.metallic > 0) m.base_color = m.base_color * 1.03f;
  });
}

TEST_F(device_agreement_twin, a_sky_or_a_sun_that_is_wrong_is_caught) {
  Stage stage = sky_stage();
  stage.portals.clear();
  stand_before(stage);
  runs_.spp = 48;
  expect_caught("density of the sky by a tenth", nee,
                [](RenderTables& t) { t.lights.settings.sky_pdf_1 *= 1.1f; });
  expect_caught("half of the sun", nee, [](RenderTables& t) {
    for (shader::SkySun& sun : t.lights.suns) sun.radiance = sun.radiance * 0.5f;
  });
}

TEST_F(device_agreement_twin, a_technique_that_is_weighed_but_not_run_is_caught) {
  EXPECT_FALSE(
      of("segments are not connected", tdpt_ref, {.skipped = Step::connect_segments}).holds());
  EXPECT_FALSE(of("sides are not connected", tdpt_ref, {.skipped = Step::connect_sides}).holds());
  EXPECT_FALSE(of("nothing is connected", nee, {.skipped = Step::connect}).holds());
  stand_before(door_stage());
  EXPECT_FALSE(of("lights are not met", pt, {.skipped = Step::meet_lights}).holds());
}

// Twin of the above: a colour off by half a per cent changes nearly every pixel.
TEST_F(device_agreement_twin, pixels_off_by_half_a_percent_are_seen) {
  stand_before(solids_stage());
  ScalarRenderer scalar(vista_, kEnough, Faults{.tables = [](RenderTables& t) {
                          for (shader::SurfaceMaterial& m : t.surfaces.materials)
                            m.base_color = m.base_color * 1.005f;
                        }});
  EXPECT_GT(share_that_differs(scalar, nee), 0.5);
}

}  // namespace tdpt::agreement_test
