#include "tools/tdpt-render/device/light_tables.h"

#include <algorithm>
#include <bit>
#include <map>

#include "libcommon/scene/ies.h"
#include "tools/tdpt-render/device/sky_tables.h"
#include "tools/tdpt-render/device/whole_shares.h"

namespace tdpt {
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

}  // namespace tdpt
