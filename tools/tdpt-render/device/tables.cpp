#include "tools/tdpt-render/device/tables.h"

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>

#include "libcommon/film/film.h"
#include "libcommon/math/sequence.h"
#include "libcommon/scene/ies.h"
#include "tools/tdpt-render/path/bsdf/scatter.h"

namespace tdpt {

std::vector<uint64_t> whole_shares(const std::vector<double>& weights, uint64_t units) {
  const auto some = static_cast<uint64_t>(
      std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0; }));
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<uint64_t> begin{0};
  double sum = 0;
  uint64_t before = 0;  // nonzero entries so far, each of which has one unit in advance
  for (const double w : weights) {
    sum += w;
    before += w > 0;
    const double share = before == some ? 1 : std::min(sum / total, 1.0);
    begin.push_back(before + static_cast<uint64_t>(share * static_cast<double>(units - some)));
  }
  return begin;
}

namespace {

constexpr uint64_t kAll = uint64_t{1} << 32;

uint32_t word(uint64_t place) {
  return static_cast<uint32_t>(std::min(place, kAll - 1));
}

}  // namespace

WordTable add_word_table(const std::vector<double>& weights, std::vector<uint32_t>& words) {
  const std::vector<uint64_t> begin = whole_shares(weights, kAll);
  const uint64_t n = weights.size();
  WordTable table;
  table.entries = static_cast<uint32_t>(n);
  table.begin = static_cast<uint32_t>(words.size());
  for (const uint64_t place : begin) words.push_back(word(place));
  table.guide = static_cast<uint32_t>(words.size());
  uint64_t entry = 0;
  for (uint64_t slot = 0; slot <= n; ++slot) {
    const uint64_t first = std::min((slot * kAll + n - 1) / n, kAll - 2);
    while (entry + 1 < n && begin[entry + 1] <= first) ++entry;
    words.push_back(static_cast<uint32_t>(entry));
  }
  return table;
}

uint64_t WordTable::words_of(const std::vector<uint32_t>& words, uint32_t entry) const {
  const uint64_t end = entry + 1 == entries ? kAll : words[begin + entry + 1];
  return end - words[begin + entry];
}

namespace {

void add_emitters(const World& world, const WordTable& table, LightTables& tables) {
  std::vector<float> pdf_A(world.scene.triangles.size());
  const std::vector<uint32_t>& emitters = world.lights.emitters();
  for (uint32_t i = 0; i < emitters.size(); ++i) {
    const TriangleShape shape = shape_of(world.scene, emitters[i]);
    shader::Emitter e{};
    e.p0 = Vec3f(shape.p0);
    e.e1 = Vec3f(shape.e1);
    e.e2 = Vec3f(shape.e2);
    e.normal = Vec3f(shape.normal);
    e.triangle = emitters[i];
    e.source = world.scene.material_of(e.triangle).double_sided ? shader::SOURCE_BOTH
                                                                : shader::SOURCE_FRONT;
    constexpr double kMost = 1e30;  // largest factor that products of floats can bear
    const auto words = static_cast<double>(table.words_of(tables.words, i));
    e.pdf_A = pdf_A[e.triangle] = static_cast<float>(std::min(words * 0x1p-32 / shape.area, kMost));
    tables.emitters.push_back(e);
  }
  tables.settings.emitters = static_cast<uint32_t>(emitters.size());
  tables.settings.first_pdf_A = static_cast<uint32_t>(tables.words.size());
  for (const float pdf : pdf_A) tables.words.push_back(std::bit_cast<uint32_t>(pdf));
}

void add_lamps(const World& world, const WordTable& table, double radiance_unit,
               LightTables& tables) {
  const std::vector<LightSource>& lamps = world.lights.lamps();
  std::map<const LightProfile*, uint32_t> profiles;  // offset of each
  for (uint32_t i = 0; i < lamps.size(); ++i) {
    tables.lamps.push_back(static_cast<shader::Lamp>(lamps[i].lamp()));
    tables.lamps.back().intensity = Rgb(lamps[i].lamp().intensity / radiance_unit);
    const auto words =
        static_cast<double>(table.words_of(tables.words, tables.settings.emitters + i));
    tables.lamps.back().pdf_1 = static_cast<float>(words * 0x1p-32);
    if (const LightProfile* profile = lamps[i].profile()) {
      const auto [at, is_new] =
          profiles.try_emplace(profile, static_cast<uint32_t>(tables.words.size()));
      if (is_new)
        tables.words.insert(tables.words.end(), profile->words.begin(), profile->words.end());
      tables.lamps.back().profile = at->second;
    }
  }
  tables.settings.lamps = static_cast<uint32_t>(lamps.size());
  tables.has_lamps = !lamps.empty();
}

void add_rect_lights(const World& world, LightTables& tables) {
  for (const RectLight& rect_light : world.rect_lights) {
    shader::RectLight p{};
    p.corner = Vec3f(rect_light.corner);
    p.x = Vec3f(rect_light.x);
    p.y = Vec3f(rect_light.y);
    p.normal = Vec3f(rect_light.normal);
    p.length_x = static_cast<float>(rect_light.length_x);
    p.length_y = static_cast<float>(rect_light.length_y);
    p.least_height = static_cast<float>(rect_light.least_height);
    p.weight = static_cast<float>(rect_light.weight);
    p.source = rect_light.source->both_sides() ? shader::SOURCE_BOTH : shader::SOURCE_FRONT;
    p.triangle0 = rect_light.triangle0;
    p.triangle1 = rect_light.triangle1;
    p.corners = rect_light.corners;
    tables.rect_lights.push_back(p);
  }
  tables.settings.rect_lights = static_cast<uint32_t>(tables.rect_lights.size());
  tables.has_rect_lights = !tables.rect_lights.empty();
}

// spread = 2^64 / words of the sky.
void spread_words(uint64_t words, shader::LightSettings& settings) {
  const uint64_t spread = ~uint64_t{0} / words + (std::has_single_bit(words) && words > 1);
  settings.spread_low = static_cast<uint32_t>(spread);
  settings.spread_high = static_cast<uint32_t>(spread >> 32);
}

void fill_up(LightTables& tables) {
  const auto fill = [](auto& all) {
    if (all.empty()) all.emplace_back();
  };
  fill(tables.words), fill(tables.emitters), fill(tables.lamps), fill(tables.suns);
  fill(tables.texels), fill(tables.rect_lights), fill(tables.windows), fill(tables.frames);
}

}  // namespace

LightTables make_light_tables(const Vista& vista, double radiance_unit) {
  LightTables tables;
  shader::LightSettings& settings = tables.settings;
  const Lights& lights = vista.world->lights;
  std::vector<double> weights;
  for (uint32_t i = 0; i < lights.emitters().size() + lights.lamps().size(); ++i)
    weights.push_back(vista.openings.selection.pdf_1(i));
  tables.has_sky = lights.sky() != nullptr;
  if (tables.has_sky) weights.push_back(vista.openings.selection.sky_pdf_1());
  WordTable table;
  if (!weights.empty()) table = add_word_table(weights, tables.words);
  settings.first_begin = table.begin;
  settings.first_guide = table.guide;
  settings.entries = table.entries;
  settings.radius = static_cast<float>(lights.radius());
  add_emitters(*vista.world, table, tables);
  add_lamps(*vista.world, table, radiance_unit, tables);
  uint64_t of_surfaces = 0;
  for (uint32_t i = 0; i < settings.emitters; ++i) of_surfaces += table.words_of(tables.words, i);
  settings.surfaces = static_cast<float>(static_cast<double>(of_surfaces) * 0x1p-32);
  settings.per_surfaces = of_surfaces > 0 ? 1 / static_cast<float>(of_surfaces) : 0;
  if (tables.has_sky) {
    const uint64_t words = table.words_of(tables.words, table.entries - 1);
    settings.sky_pdf_1 = static_cast<float>(static_cast<double>(words) * 0x1p-32);
    settings.sky_extent = static_cast<float>(lights.sky()->cos_per_pdf_w({}));
    spread_words(words, settings);
    add_sky(vista, radiance_unit, tables);
    add_windows(vista.openings.windows, radiance_unit, tables);
  }
  add_rect_lights(*vista.world, tables);
  fill_up(tables);
  return tables;
}

namespace {

// Clamps to what floats can hold: gradients of portals as small as rounding are large.
float held(double x) {
  constexpr double kMost = 1e30;
  return static_cast<float>(std::clamp(x, -kMost, kMost));
}
Vec3f held(const Vec3d& v) {
  return {held(v.x), held(v.y), held(v.z)};
}

// Error of a point computed in the plane of a portal, in barycentric coordinates.
float border_of(const shader::PortalPolygonOf<double>& q) {
  constexpr double kOff = 2e-6, kMost = 0.3;
  const double steepest = std::max({length(q.grad1), length(q.grad2), length(q.grad1 + q.grad2)});
  return static_cast<float>(std::min(kOff * steepest, kMost));
}

}  // namespace

PortalTables::PortalTables(const PortalSet& set) {
  if (set.empty()) return;
  for (const auto& f : set.tables_->facets) {
    shader::PortalFacet& out = facets.emplace_back(shader::PortalFacet(f));
    out.area = held(f.area);
    out.density = held(f.density);
    out.per_area = held(f.per_area);
  }
  for (const auto& q : set.tables_->polygons) {
    shader::PortalPolygon& out = polygons.emplace_back(shader::PortalPolygon(q));
    out.grad1 = held(q.grad1);
    out.grad2 = held(q.grad2);
    shader::PortalFacet& f = facets[q.facet];
    if (polygons.size() < f.end) f.border = std::max(f.border, border_of(q));
  }
  for (const Vec3d& corner : set.tables_->corners) corners.push_back({Vec3f(corner), 0});
  for (const auto& pair : set.tables_->pairs) {
    pairs.push_back(shader::PortalPair(pair));
    pairs.back().pdf = held(pair.pdf);
  }
  const auto& sizes = set.guiding;
  guiding = {sizes.facets,
             sizes.polygons,
             sizes.pairs,
             static_cast<float>(sizes.pair_share),
             static_cast<float>(sizes.per_pair_share),
             0,
             0,
             0};
}

namespace {

std::vector<float> in_floats(std::span<const double> curves) {
  return {curves.begin(), curves.end()};
}

}  // namespace

RenderTables::RenderTables(const Vista& vista)
    : radiance_unit(Film::power_of_two(vista.world->lights.power())),
      surfaces(make_surfaces(vista.world->scene, radiance_unit)),
      surface_curves(in_floats(tdpt::surface_curves())),
      sheen_curves(surfaces.features.sheen ? in_floats(tdpt::sheen_curves())
                                           : std::vector<float>()),
      lights(make_light_tables(vista, radiance_unit)),
      portals(vista.openings.portals),
      bvh(build_bvh(vista.world->scene)) {}

void RenderTables::follow(const Vista& vista) {
  lights = make_light_tables(vista, radiance_unit);
  portals = PortalTables(vista.openings.portals);
}

shader::SceneSpans::SceneSpans(const RenderTables& t)
    : bvh_nodes(t.bvh.nodes),
      bvh_triangles(t.bvh.triangles),
      sobol_points(shader::sobol_points),
      faces(t.surfaces.faces),
      materials(t.surfaces.materials),
      material_maps(t.surfaces.material_maps),
      texture_maps(t.surfaces.maps),
      face_corners(t.surfaces.face_corners),
      corner_attributes(t.surfaces.corner_attributes),
      surface_curves(t.surface_curves),
      sheen_curves(t.sheen_curves),
      coverage_of(t.surfaces.coverage.coverage_of),
      coverages(t.surfaces.coverage.coverages),
      texel_words(t.surfaces.texel_words),
      light_words(t.lights.words),
      light_emitters(t.lights.emitters),
      light_lamps(t.lights.lamps),
      sky_suns(t.lights.suns),
      sky_texels(t.lights.texels),
      rect_lights(t.lights.rect_lights),
      sky_windows(t.lights.windows),
      window_frames(t.lights.frames),
      portal_facets(t.portals.facets),
      portal_polygons(t.portals.polygons),
      portal_corners(t.portals.corners),
      portal_pairs(t.portals.pairs) {}

}  // namespace tdpt
