#include "tools/tdpt-render/device/wavefront.h"

#include <algorithm>
#include <cmath>

#include "libcommon/base/error.h"
#include "tools/tdpt-render/path/light_pool.h"

namespace tdpt {

using shader::RenderParameters;
using shader::StepParameters;

FilmPlaces::FilmPlaces(uint64_t pixels, bool layers, size_t portals_) {
  const uint64_t planes = layers ? 1 + kTechniques : 1;
  const uint64_t met_first = 12 * planes * pixels, tally_first = met_first + pixels;
  const uint64_t portals_first = tally_first + shader::kTallyBuckets * shader::kTallyWords + 1;
  const uint64_t all = portals_first + shader::kPortalWords * portals_;
  if (all > UINT32_MAX)
    throw Error(Exit::no_device, "the picture has too many pixels for a device");
  met = static_cast<uint32_t>(met_first);
  tally = static_cast<uint32_t>(tally_first);
  portals = static_cast<uint32_t>(portals_first);
  words = static_cast<uint32_t>(all);
}

namespace {

Vec3f narrow(const Vec3d& v) {
  return Vec3f(v);
}

void set_camera(const FilmPlane& film, RenderParameters& p) {
  p.camera_position = narrow(film.position());
  p.camera_right = narrow(film.right());
  p.camera_up = narrow(film.up());
  p.camera_forward = narrow(film.forward());
  p.half_width = static_cast<float>(film.half_width());
  p.half_height = static_cast<float>(film.half_height());
  p.film_area = 4 * p.half_width * p.half_height;
  p.width = static_cast<uint32_t>(film.width());
  p.height = static_cast<uint32_t>(film.height());
}

void set_mixture(const Mixture& m, RenderParameters& p) {
  p.techniques = m.techniques.bits();
  p.first_direct = static_cast<float>(m.first_direct);
  p.later_direct = static_cast<float>(m.later_direct);
  p.light_walks = static_cast<float>(m.light_walks);
  p.joined = static_cast<float>(m.joined);
  p.joined_to_segments = static_cast<float>(m.joined_to_segments);
  p.segments_joined = static_cast<float>(m.segments_joined);
  p.segments = static_cast<float>(m.segments);
  p.through_windows = static_cast<float>(m.through_windows);
  p.guide_light = static_cast<float>(m.guiding.chance[0]);
  p.guide_camera = static_cast<float>(m.guiding.chance[1]);
}

void set_pools(const Mixture& m, RenderParameters& p) {
  const uint64_t pixels = uint64_t{p.width} * p.height;
  const uint64_t per_pool = samples_of_pool(m);
  const uint64_t pools = (pixels + per_pool - 1) / per_pool;
  // The first pools have the most samples.
  const uint64_t most = (pixels + pools - 1) / pools;
  p.pools = static_cast<uint32_t>(pools);
  p.per_pool = static_cast<uint32_t>(most);
  p.walks_full = static_cast<uint32_t>(light_walks_of(m, most));
  p.walks_less = static_cast<uint32_t>(light_walks_of(m, most - 1));
}

// As far as pixel_of_pool() takes sample i along its stretch.
uint32_t pool_offset(uint64_t i, uint64_t pools) {
  const uint64_t stretch = i * pools;
  return static_cast<uint32_t>(pixel_of_pool(0, i, pools, stretch + pools) - stretch);
}

Units units_at(const std::vector<uint32_t>& words, size_t first) {
  Units units = 0;
  for (size_t i = 4; i-- > 0;) units = units << 32 | words[first + i];
  return units;
}

void add_to_film(const std::vector<uint32_t>& words, const FilmPlaces& places, Film& film) {
  const auto pixels = static_cast<size_t>(film.width()) * static_cast<size_t>(film.height());
  film.add_sums(
      [&](size_t plane, size_t i) { return units_at(words, 4 * (3 * pixels * plane + i)); },
      [&](size_t pixel) { return words[places.met + pixel]; });
}

void add_to_tally(const std::vector<uint32_t>& words, const FilmPlaces& places, size_t portals,
                  bool drawn, Tally& tally) {
  for (size_t bucket = 0; bucket < shader::kTallyBuckets; ++bucket) {
    const size_t first = places.tally + bucket * shader::kTallyWords;
    tally.rays.merge({words[first], words[first + 1], words[first + 2], words[first + 3]});
    const auto sum = [&](size_t i) {
      return units_at(words, first + shader::TALLY_ENERGIES + 4 * i);
    };
    for (size_t i = 0; i < kTechniques; ++i) tally.energy[i].merge(sum(i));
    for (size_t i = 0; i < Tally::kOctaves; ++i) tally.by_length[i].merge(sum(kTechniques + i));
  }
  tally.not_finite += words[places.tally + shader::kTallyBuckets * shader::kTallyWords];
  if (!drawn) return;
  tally.begin_portals(portals);
  for (size_t i = 0; i < portals; ++i) {
    const size_t first = places.portals + i * shader::kPortalWords;
    tally.portals[i].drawn += words[first];
    tally.portals[i].lit += words[first + 1];
    tally.portals[i].energy.merge(units_at(words, first + 2));
  }
}

// Groups from (sample, pool) on.
struct Groups {
  uint64_t sample, pool, left;
};

}  // namespace

WavefrontRenderer::WavefrontRenderer(const World& world, std::unique_ptr<Machine> machine)
    : world_(world), machine_(std::move(machine)), samples_(machine_->room().samples) {}

void WavefrontRenderer::render(const Integrator& integrator, const SampleRules& rules,
                               uint64_t round, const SampleRange& samples, Film& film, Tally& tally,
                               Progress& progress) {
  RenderParameters p{};
  set_camera(world_.film, p);
  set_mixture(integrator.mixture, p);
  set_pools(integrator.mixture, p);
  p.seed = rules.seed;
  p.stream = (integrator.stream + (kStreams + 1) * round) * 16;
  p.beta = static_cast<float>(rules.beta);
  p.max_depth = static_cast<uint32_t>(rules.max_depth);
  p.culls = world_.tracer.culls();
  p.transparent = film.has_alpha();
  for (size_t i = 0; i < kTechniques; ++i) p.layers |= film.has_layer(i);
  const FilmPlaces places(uint64_t{p.width} * p.height, p.layers != 0, world_.portals.portals());
  p.met_first = places.met;
  p.tally_first = places.tally;
  p.portals_first = places.portals;
  p.most_vertices = machine_->room().vertices;
  std::vector<uint32_t> offsets;
  for (uint32_t i = 0; i < p.per_pool; ++i) offsets.push_back(pool_offset(i, p.pools));
  for (uint64_t sample = samples.first, pool = 0; sample < samples.end();) {
    const uint64_t left = (samples.end() - sample) * p.pools - pool;
    p.first_sample = sample;
    p.first_pool = static_cast<uint32_t>(pool);
    p.groups = static_cast<uint32_t>(std::min<uint64_t>(left, samples_ / p.per_pool));
    if (!submit(p, offsets)) {
      samples_ = std::max(samples_ / 2, kMostOfPool);
      continue;
    }
    progress.advance(uint64_t{p.groups} * p.per_pool);
    sample += (pool + p.groups) / p.pools;
    pool = (pool + p.groups) % p.pools;
  }
  const std::vector<uint32_t> words = machine_->take_film();
  add_to_film(words, places, film);
  const bool drawn = integrator.mixture.has(Technique::portal) && !world_.portals.empty();
  add_to_tally(words, places, world_.portals.portals(), drawn, tally);
  film.complete(samples);
}

// False when there was no room for all vertices: then nothing has come of it.
bool WavefrontRenderer::submit(const RenderParameters& p,
                               const std::vector<uint32_t>& pool_offsets) {
  machine_->set(p, pool_offsets);
  const TechniqueSet techniques = TechniqueSet::of_bits(static_cast<uint8_t>(p.techniques));
  const uint32_t walks = techniques.walks_from_light() ? p.groups * p.walks_full : 0;
  const uint32_t samples = p.groups * p.per_pool;
  uint32_t used = 0;
  // A vertex more of each walk that goes on, until none does.
  const auto go_on = [&](bool of_light, uint32_t first, uint32_t count) {
    while (count > 0) {
      const uint32_t alive = machine_->gather(of_light, first, count);
      if (alive > p.most_vertices - used) return false;
      if (alive == 0) break;
      machine_->run(of_light ? Step::go_on_light : Step::go_on_camera, {alive, 0, used});
      first = used;
      count = alive;
      used += alive;
    }
    return true;
  };
  if (2 * walks + samples > p.most_vertices) return false;
  uint32_t lights_end = 0;
  if (walks > 0) {
    machine_->run(Step::begin_light_walks, {walks, 0, walks});
    used = 2 * walks;
    if (!go_on(true, walks, walks)) return false;
    lights_end = used;
    if (samples > p.most_vertices - used) return false;
    machine_->place_ends(walks);
    machine_->run(Step::list_ends, {lights_end - walks, walks, 0});
  }
  const bool crosses = techniques.has(Technique::portal) && !world_.portals.empty();
  const uint32_t camera = used;
  machine_->run(Step::begin_camera_walks, {samples, 0, camera});
  used += samples;
  if (!go_on(false, camera, samples)) return false;
  // From here on the film is added to.
  if (crosses) {
    machine_->run(Step::list_starts, {walks, 0, 0});
    machine_->run(Step::draw_segments, {samples, 0, 0});
    machine_->run(Step::see_segments, {samples, 0, 0});
    machine_->run(Step::join_segments, {samples, 0, 0});
  }
  machine_->run(Step::connect, {used - camera, camera, 0});
  if (techniques.has(Technique::light)) machine_->run(Step::splat, {lights_end - walks, walks, 0});
  return true;
}

}  // namespace tdpt
