#include "tools/tdpt-render/testing/twin.h"

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/math/sequence.h"
#include "shaders/shared/loads.h"
#include "shaders/shared/path/film_units.h"
#include "shaders/shared/path/joins.h"
#include "shaders/shared/path/surface_heads.h"
#include "shaders/shared/scaled.h"
#include "shaders/shared/triangle.h"

namespace tdpt {
namespace shader {
namespace {

// Refers to memory, as a kernel does to its buffers, by the same names.
struct TwinKernels {
  // The scene.
  const BvhNode* bvh_nodes;
  const BvhTriangle* bvh_triangles;
  const Face* faces;
  const FaceCorners* face_corners;
  const CornerAttributes* corner_attributes;
  const SurfaceMaterial* materials;
  const uint* material_maps;
  const SurfaceMap* texture_maps;
  const uint* texel_words;
  const float* surface_curves;
  const uint* coverage_of;
  const Coverage* coverages;
  const uint* light_words;
  const Emitter* light_emitters;
  const Lamp* light_lamps;
  const SkySun* sky_suns;
  const SkyTexel* sky_texels;
  const Panel* light_panels;
  const SkyWindow* sky_windows;
  const WindowFrame* window_frames;
  const LightSettings* settings_of_lights;
  const PortalFacet* portal_facets;
  const PortalPolygon* portal_polygons;
  const PortalCorner* portal_corners;
  const PortalPair* portal_pairs;
  GuideParameters guiding;
  // What it has.
  bool scene_has_layers, scene_has_normals, scene_has_textures, scene_has_colours, scene_has_coats,
      scene_has_sheen, scene_has_transmission, scene_has_absorption, scene_has_panes,
      scene_has_coverage, coverage_has_textures;
  bool scene_has_sky, scene_has_sky_map, scene_has_lamps, scene_has_panels, scene_has_windows,
      scene_prefers;
  bool scene_has_portals, portals_have_pairs, guide_active, camera_culls, power_heuristic,
      film_has_layers, film_is_transparent;
  uint mixture_techniques;
  // The submission.
  RenderParameters render;
  const uint* pool_offsets;
  PathVertex* path_vertices;
  PathBsdf* path_bsdfs;
  PathDensity* path_densities;
  uint* walk_counts;
  uint* walk_last;
  const uint* alive;
  const uint* end_first;
  JoinEnd* join_ends;
  WalkRay* walk_rays;
  Joining* joinings;
  Scattering* scatterings;
  PortalSegment* segments;
  SegmentSide* segment_sides;
  uint* flags;
  const uint* ranks;
  uint* lit_segments;
  uint* lit_first;
  float* estimates;
  uint* film_words;
  StepParameters work;
  uint bucket;

  LOADS(BvhNode, bvh_node, bvh_nodes)
  LOADS(BvhTriangle, bvh_triangle, bvh_triangles)
  LOADS_OF_SURFACES
  LOADS_OF_LIGHTS
  LOADS_OF_PORTALS
  LOADS(uint, pool_offset, pool_offsets)
  LOADS(uint, alive, alive)
  LOADS(uint, end_first, end_first)
  LOADS(uint, walk_last, walk_last)
  LOADS(PathVertex, path_vertex, path_vertices)
  LOADS(PathBsdf, path_bsdf, path_bsdfs)
  LOADS(PathDensity, path_density, path_densities)
  LOADS(WalkRay, walk_ray, walk_rays)
  LOADS(JoinEnd, join_end, join_ends)
  LOADS(Joining, joining, joinings)
  LOADS(Scattering, scattering, scatterings)
  LOADS(PortalSegment, segment, segments)
  LOADS(SegmentSide, segment_side, segment_sides)
  LOADS(uint, rank, ranks)
  LOADS(uint, lit_segment, lit_segments)
  LOADS(uint, lit_first, lit_first)
  LOADS(float, estimate, estimates)

  uint tally_bucket() const { return bucket; }

#define light_settings (*settings_of_lights)

  // Apart: each begins with language.h.
#include "shaders/shared/path/surface.h"

#include "shaders/shared/traversal.h"

#include "shaders/shared/path/sky.h"

#include "shaders/shared/path/lights.h"

#include "shaders/shared/path/panels.h"

#include "shaders/shared/path/window_sky.h"

#include "shaders/shared/path/next_event.h"

#include "shaders/shared/path/portals.h"

#include "shaders/shared/path/guide.h"

#include "shaders/shared/path/film_sum.h"

#include "shaders/shared/path/film.h"

#include "shaders/shared/path/camera.h"

#include "shaders/shared/path/samples.h"

#include "shaders/shared/path/rays.h"

#include "shaders/shared/path/weight.h"

#include "shaders/shared/path/walk.h"

#include "shaders/shared/path/joinings.h"

#include "shaders/shared/path/segments.h"

#include "shaders/shared/path/ends.h"

#undef light_settings

  void run(Step what, uint i) {
    const uint slot = work.first + i;
    switch (what) {
      case Step::begin_light_walks:
        return begin_light_walk(i, slot);
      case Step::begin_camera_walks:
        return begin_camera_walk(i);
      case Step::go_on_light:
        return go_on(FROM_LIGHT, alive[i], i);
      case Step::go_on_camera:
        return go_on(FROM_CAMERA, alive[i], i);
      case Step::trace:
        return trace_ray(i);
      case Step::arrive_light:
        return arrive(FROM_LIGHT, i, work.next + i);
      case Step::arrive_camera:
        return arrive(FROM_CAMERA, i, work.next + i);
      case Step::list_ends:
        return list_end(slot);
      case Step::list_starts:
        return list_start(i);
      case Step::meet_lights:
        return meet_light(slot);
      case Step::begin_segments:
        return begin_segment(i);
      case Step::end_segments:
        return end_segment(i);
      case Step::put_segments:
        return put_segment_together(i);
      case Step::gather_sides:
        return gather_sides(slot, 2 * i);
      case Step::choose_next_events:
        return choose_next_event(slot, i);
      case Step::choose_joins:
        return choose_joins(slot, 2 * i);
      case Step::choose_splats:
        return choose_splat(slot, i);
      case Step::choose_sides:
        return choose_sides(slot, 2 * i);
      case Step::choose_seen:
        return choose_seen(slot, i);
      case Step::choose_segments:
        return choose_segments(slot, 3 * i, work.next);
      case Step::flag_lit:
        return flag_lit(slot, i);
      case Step::list_lit:
        return list_lit(i);
      case Step::estimate_segments:
        return estimate_segments(slot, i);
      case Step::scatter_ends:
        return scatter_end(alive[i], work.first == 0);
      case Step::see:
        return see(alive[i]);
      case Step::join:
        return join(alive[i]);
      case Step::join_sides:
        return join_side(alive[i]);
      case Step::join_segments:
        return join_segment(alive[i]);
      case Step::kSteps:
        return;
    }
  }
};

TwinKernels kernels_of(const RenderTables& t) {
  TwinKernels k{};
  k.bvh_nodes = t.bvh.nodes.data();
  k.bvh_triangles = t.bvh.triangles.data();
  k.faces = t.surfaces.faces.data();
  k.face_corners = t.surfaces.face_corners.data();
  k.corner_attributes = t.surfaces.corner_attributes.data();
  k.materials = t.surfaces.materials.data();
  k.material_maps = t.surfaces.material_maps.data();
  k.texture_maps = t.surfaces.maps.data();
  k.texel_words = t.surfaces.texel_words.data();
  k.surface_curves = t.curves.data();
  k.coverage_of = t.surfaces.coverage.coverage_of.data();
  k.coverages = t.surfaces.coverage.coverages.data();
  k.light_words = t.lights.words.data();
  k.light_emitters = t.lights.emitters.data();
  k.light_lamps = t.lights.lamps.data();
  k.sky_suns = t.lights.suns.data();
  k.sky_texels = t.lights.texels.data();
  k.light_panels = t.lights.panels.data();
  k.sky_windows = t.lights.windows.data();
  k.window_frames = t.lights.frames.data();
  k.settings_of_lights = &t.lights.settings;
  k.portal_facets = t.portals.facets.data();
  k.portal_polygons = t.portals.polygons.data();
  k.portal_corners = t.portals.corners.data();
  k.portal_pairs = t.portals.pairs.data();
  k.guiding = t.portals.guiding;
  const SurfaceFeatures& f = t.surfaces.features;
  k.scene_has_layers = f.layers;
  k.scene_has_normals = f.normals;
  k.scene_has_textures = f.textures;
  k.scene_has_colours = f.colours;
  k.scene_has_coats = f.coats;
  k.scene_has_sheen = f.sheen;
  k.scene_has_transmission = f.transmission;
  k.scene_has_absorption = f.absorption;
  k.scene_has_panes = f.panes;
  k.scene_has_coverage = f.coverage;
  k.coverage_has_textures = f.coverage_textures;
  k.scene_has_sky = t.lights.has_sky;
  k.scene_has_sky_map = t.lights.has_sky_map;
  k.scene_has_lamps = t.lights.has_lamps;
  k.scene_has_panels = t.lights.has_panels;
  k.scene_has_windows = t.lights.has_windows;
  k.scene_prefers = t.lights.prefers;
  k.scene_has_portals = !t.portals.facets.empty();
  k.portals_have_pairs = !t.portals.pairs.empty();
  return k;
}

}  // namespace
}  // namespace shader

namespace {

class Twin : public Machine {
 public:
  Twin(const RenderTables& tables, const Room& room, uint32_t film_words)
      : room_(room),
        kernels_(shader::kernels_of(tables)),
        vertices_(room.vertices),
        bsdfs_(room.vertices),
        densities_(room.vertices),
        alive_(room.flags()),
        flags_(room.flags()),
        ranks_(room.flags()),
        lit_segments_(room.samples),
        lit_first_(room.samples + 1),
        estimates_(room.estimates()),
        walk_counts_(room.samples + 1),
        walk_last_(room.samples),
        end_first_(room.samples + 1),
        film_(film_words),
        ends_(size_t{room.vertices} + 2 * size_t{room.samples}),
        segments_(room.samples),
        sides_(size_t{room.samples} * shader::kSegmentSides),
        rays_(2 * size_t{room.samples}),
        joinings_(room.joinings()),
        scatterings_(2 * size_t{room.joinings()}) {
    kernels_.path_vertices = vertices_.data();
    kernels_.path_bsdfs = bsdfs_.data();
    kernels_.path_densities = densities_.data();
    kernels_.walk_rays = rays_.data();
    kernels_.joinings = joinings_.data();
    kernels_.scatterings = scatterings_.data();
    kernels_.alive = alive_.data();
    kernels_.walk_counts = walk_counts_.data();
    kernels_.walk_last = walk_last_.data();
    kernels_.end_first = end_first_.data();
    kernels_.flags = flags_.data();
    kernels_.ranks = ranks_.data();
    kernels_.lit_segments = lit_segments_.data();
    kernels_.lit_first = lit_first_.data();
    kernels_.estimates = estimates_.data();
    kernels_.film_words = film_.data();
    kernels_.join_ends = ends_.data();
    kernels_.segments = segments_.data();
    kernels_.segment_sides = sides_.data();
  }

  Room room() const override { return room_; }

  void set(const shader::RenderParameters& p, const std::vector<uint32_t>& pool_offsets) override {
    pool_offsets_ = pool_offsets;
    kernels_.pool_offsets = pool_offsets_.data();
    kernels_.render = p;
    kernels_.camera_culls = p.culls != 0;
    kernels_.mixture_techniques = p.techniques;
    kernels_.power_heuristic = p.beta == 2;
    kernels_.film_has_layers = p.layers != 0;
    kernels_.film_is_transparent = p.transparent != 0;
    kernels_.guide_active = p.guide_light > 0 || p.guide_camera > 0;
  }

  void run(Step step, const shader::StepParameters& parameters) override {
    constexpr uint32_t kGroup = 64;
    kernels_.work = parameters;
    oneapi::tbb::parallel_for(
        uint32_t{0}, (parameters.count + kGroup - 1) / kGroup, [&](uint32_t group) {
          shader::TwinKernels kernels = kernels_;
          kernels.bucket = group % shader::kTallyBuckets;
          const uint32_t end = std::min(parameters.count, (group + 1) * kGroup);
          for (uint32_t i = group * kGroup; i < end; ++i) kernels.run(step, i);
        });
  }

  uint32_t gather(bool of_light, uint32_t first, uint32_t count) override {
    const uint32_t from = of_light ? shader::FROM_LIGHT : shader::FROM_CAMERA;
    for (uint32_t i = 0; i < count; ++i) flags_[i] = kernels_.goes_on(from, first + i);
    const uint32_t n = pick(count);
    for (uint32_t i = 0; i < n; ++i) alive_[i] += first;
    return n;
  }

  uint32_t pick(uint32_t count) override {
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; ++i) {
      ranks_[i] = n;
      if (flags_[i] != 0) alive_[n++] = i;
    }
    return n;
  }

  void place_ends(uint32_t walks) override {
    uint32_t sum = 0;
    for (uint32_t i = 0; i < walks; ++i) {
      end_first_[i] = sum;
      sum += walk_counts_[i];
    }
    end_first_[walks] = sum;
  }

  std::vector<uint32_t> take_film() override {
    std::vector<uint32_t> words = film_;
    std::fill(film_.begin(), film_.end(), 0u);
    return words;
  }

 private:
  const Room room_;
  shader::TwinKernels kernels_;
  std::vector<shader::PathVertex> vertices_;
  std::vector<shader::PathBsdf> bsdfs_;
  std::vector<shader::PathDensity> densities_;
  std::vector<uint32_t> alive_, flags_, ranks_, lit_segments_, lit_first_;
  std::vector<float> estimates_;
  std::vector<uint32_t> walk_counts_, walk_last_, end_first_, film_;
  std::vector<shader::JoinEnd> ends_;
  std::vector<shader::PortalSegment> segments_;
  std::vector<shader::SegmentSide> sides_;
  std::vector<shader::WalkRay> rays_;
  std::vector<shader::Joining> joinings_;
  std::vector<shader::Scattering> scatterings_;
  std::vector<uint32_t> pool_offsets_;
};

}  // namespace

std::unique_ptr<Machine> make_twin(const RenderTables& tables, const Room& room,
                                   uint32_t film_words) {
  return std::make_unique<Twin>(tables, room, film_words);
}

}  // namespace tdpt
