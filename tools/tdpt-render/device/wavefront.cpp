#include "tools/tdpt-render/device/wavefront.h"

#include <chrono>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "tools/tdpt-render/path/sample/light_vertex_cache.h"

namespace tdpt {

using shader::RenderParameters;
using shader::StepParameters;

FilmPlaces::FilmPlaces(uint64_t pixels, const FilmPlanes& planes, size_t portals_) {
  uint64_t end = 12 * pixels * (planes.layers ? 1 + kTechniques : 1);
  const auto place = [&](uint64_t count) {
    const uint64_t first = end;
    end += count;
    return static_cast<uint32_t>(first);
  };
  odd = place(planes.halves ? 12 * pixels : 0);
  met = place(pixels);
  tally = place(shader::kTallyBuckets * shader::kTallyWords + shader::kLeftOutWords);
  portals = place(shader::kPortalWords * portals_);
  words = place(0);
  if (end > UINT32_MAX)
    throw Error(Exit::no_device,
                fmt::format("the film takes {} words, kernels count {}", end, UINT32_MAX));
}

namespace {

void set_camera(const FilmPlane& film, RenderParameters& p) {
  p.camera_position = Vec3f(film.position());
  p.camera_right = Vec3f(film.right());
  p.camera_up = Vec3f(film.up());
  p.camera_forward = Vec3f(film.forward());
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
  p.connected = static_cast<float>(m.connected);
  p.connected_to_segments = static_cast<float>(m.connected_to_segments);
  p.segments_connected = static_cast<float>(m.segments_connected);
  p.segments = static_cast<float>(m.segments);
  p.through_windows = static_cast<float>(m.through_windows);
  p.guide_light = static_cast<float>(m.guiding.chance[0]);
  p.guide_camera = static_cast<float>(m.guiding.chance[1]);
}

void set_caches(const Mixture& m, RenderParameters& p) {
  const uint64_t pixels = uint64_t{p.width} * p.height;
  const uint64_t per_cache = samples_of_cache(m);
  const uint64_t caches = (pixels + per_cache - 1) / per_cache;
  // The first caches have the most samples.
  const uint64_t most = (pixels + caches - 1) / caches;
  p.caches = static_cast<uint32_t>(caches);
  p.per_cache = static_cast<uint32_t>(most);
  p.walks_full = static_cast<uint32_t>(light_walks_of(m, most));
  p.walks_less = static_cast<uint32_t>(light_walks_of(m, most - 1));
}

// Offset of the pixel that pixel_of_cache() gives each sample within its stretch.
std::vector<uint32_t> cache_offsets(const RenderParameters& p) {
  std::vector<uint32_t> offsets;
  for (uint64_t i = 0; i < p.per_cache; ++i) {
    const uint64_t stretch = i * p.caches;
    offsets.push_back(
        static_cast<uint32_t>(pixel_of_cache(0, i, p.caches, stretch + p.caches) - stretch));
  }
  return offsets;
}

Units units_at(const std::vector<uint32_t>& words, size_t first) {
  Units units = 0;
  for (size_t i = 4; i-- > 0;) units = units << 32 | words[first + i];
  return units;
}

void add_to_film(const std::vector<uint32_t>& words, const RenderParameters& p, Film& film) {
  const size_t pixels = size_t{p.width} * p.height;
  film.add_sums(
      [&](size_t plane, size_t i) {
        return units_at(words,
                        (plane == Film::kOddPlane ? p.odd_first : 12 * pixels * plane) + 4 * i);
      },
      [&](size_t pixel) { return words[p.met_first + pixel]; });
}

// Reports the non-finite values left out; the film's first sample is `first`.
void add_left_out(const std::vector<uint32_t>& words, const RenderParameters& p, uint64_t first,
                  Tally& tally) {
  const size_t begin = p.tally_first + shader::kTallyBuckets * shader::kTallyWords;
  const uint64_t pixels = uint64_t{p.width} * p.height;
  Tally left_out;
  left_out.not_finite = words[begin];
  for (size_t i = 1; i <= shader::kLeftOutPlaces && words[begin + i] != 0; ++i) {
    const uint64_t place = UINT32_MAX - words[begin + i], pixel = place % pixels;
    left_out.not_finite_at.push_back({first + place / pixels, static_cast<int>(pixel / p.width),
                                      static_cast<int>(pixel % p.width)});
  }
  tally.merge(left_out);
}

static_assert(shader::kTallyWords == shader::TALLY_ENERGIES + 4 * shader::kTallySums &&
              kTechniques + Tally::kOctaves <= shader::kTallySums);

void add_to_tally(const std::vector<uint32_t>& words, const RenderParameters& p, size_t portals,
                  bool drawn, Tally& tally) {
  for (size_t bucket = 0; bucket < shader::kTallyBuckets; ++bucket) {
    const size_t first = p.tally_first + bucket * shader::kTallyWords;
    tally.rays.merge({words[first], words[first + 1], words[first + 2], words[first + 3]});
    const auto sum = [&](size_t i) {
      return units_at(words, first + shader::TALLY_ENERGIES + 4 * i);
    };
    for (size_t i = 0; i < kTechniques; ++i) tally.energy[i].merge(sum(i));
    for (size_t i = 0; i < Tally::kOctaves; ++i) tally.by_length[i].merge(sum(kTechniques + i));
  }
  if (!drawn) return;
  tally.begin_portals(portals);
  for (size_t i = 0; i < portals; ++i) {
    const size_t first = p.portals_first + i * shader::kPortalWords;
    tally.portals[i].drawn += words[first];
    tally.portals[i].lit += words[first + 1];
    tally.portals[i].energy.merge(units_at(words, first + 2));
  }
}

// Samples of the first submission. Later ones grow while a submission takes less than kShort
// seconds, and are halved above kLong: drivers reset devices that are busy for long, and users want
// to see progress.
constexpr uint32_t kFirstSubmission = 1 << 14;
constexpr double kShort = 0.1, kLong = 1;
// Length of a pass [s], so that signals and checkpoints do not wait long.
constexpr double kPass = 0.5;
// Samples whose rays and segments 32-bit counters can hold, in every bucket.
constexpr uint64_t kMostCounted = uint64_t{1} << 26;

}  // namespace

WavefrontRenderer::WavefrontRenderer(const Vista& vista_, std::unique_ptr<Machine> machine,
                                     std::string name)
    : SampleRenderer(vista_),
      machine_(std::move(machine)),
      name_(std::move(name)),
      samples_(std::min(machine_->room().samples, kFirstSubmission)),
      most_samples_(machine_->room().samples) {}

RenderParameters WavefrontRenderer::parameters_of(const Integrator& integrator,
                                                  const SampleRules& rules, uint64_t round,
                                                  const Film& film) const {
  RenderParameters p{};
  set_camera(vista.view.film, p);
  set_mixture(integrator.mixture, p);
  set_caches(integrator.mixture, p);
  p.seed = rules.seed;
  p.stream = stream_in(round, integrator.stream) * kPurposes;
  p.beta = static_cast<float>(rules.beta);
  p.max_depth = static_cast<uint32_t>(rules.max_depth);
  p.culls = vista.world->tracer.culls();
  p.transparent = film.has_alpha();
  for (size_t i = 0; i < kTechniques; ++i) p.layers |= film.has_layer(i);
  p.halves = film.options().halves;
  const FilmPlaces places(uint64_t{p.width} * p.height, {p.layers != 0, p.halves != 0},
                          vista.openings.portals.portals());
  p.odd_first = places.odd;
  p.met_first = places.met;
  p.tally_first = places.tally;
  p.portals_first = places.portals;
  p.most_vertices = machine_->room().vertices;
  p.ray_counts_as = 1;
  return p;
}

void WavefrontRenderer::render(const Integrator& integrator, const SampleRules& rules,
                               uint64_t round, const SampleRange& samples, Film& film, Tally& tally,
                               ProgressBar& progress) {
  const RenderParameters p = parameters_of(integrator, rules, round, film);
  const uint64_t pixels = uint64_t{p.width} * p.height;
  const bool drawn = integrator.mixture.has(Technique::portal) && !vista.openings.portals.empty();
  const auto start = std::chrono::steady_clock::now();
  const uint64_t most = std::max<uint64_t>(kMostCounted / pixels, 1);
  for (uint64_t at = samples.first; at < samples.end(); at += most) {
    const SampleRange some{at, std::min(most, samples.end() - at)};
    submit_all(p, some, progress);
    const std::vector<uint32_t> words = machine_->take_film();
    add_to_film(words, p, film);
    add_to_tally(words, p, vista.openings.portals.portals(), drawn, tally);
    add_left_out(words, p, some.first, tally);
    film.complete(some);
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  const auto all = static_cast<double>(pixels * samples.count);
  of_pass_ = static_cast<uint64_t>(kPass * all / std::max(took.count(), 1e-3));
}

void WavefrontRenderer::submit_all(RenderParameters p, const SampleRange& samples,
                                   ProgressBar& progress) {
  const std::vector<uint32_t> offsets = cache_offsets(p);
  p.first_number = static_cast<uint32_t>(samples.first);
  for (uint64_t sample = samples.first, cache = 0; sample < samples.end();) {
    const uint64_t left = (samples.end() - sample) * p.caches - cache;
    p.first_sample = sample;
    p.first_cache = static_cast<uint32_t>(cache);
    const uint64_t most = std::max<uint32_t>(samples_ / p.per_cache, 1);
    p.groups = static_cast<uint32_t>(std::min(left, most));
    const auto start = std::chrono::steady_clock::now();
    if (!submit(p, offsets)) {
      if (p.groups == 1)
        throw Error(Exit::no_device,
                    fmt::format("the device has room for {} vertices of paths, and {} samples that "
                                "share light walks take more: --max-depth makes paths shorter",
                                p.most_vertices, p.per_cache));
      samples_ = most_samples_ = p.groups / 2 * p.per_cache;
      continue;
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (took.count() > kLong) samples_ = std::max(samples_ / 2, p.per_cache);
    if (took.count() < kShort) samples_ = std::min(2 * samples_, most_samples_);
    progress.advance(uint64_t{p.groups} * p.per_cache);
    sample += (cache + p.groups) / p.caches;
    cache = (cache + p.groups) % p.caches;
  }
}

namespace {

// The steps of one submission.
class Submission {
 public:
  Submission(Machine& machine, const RenderParameters& p, bool crosses)
      : machine_(machine),
        p_(p),
        techniques_(TechniqueSet::of_bits(static_cast<uint8_t>(p.techniques))),
        crosses_(crosses),
        walks_(techniques_.walks_from_light() ? p.groups * p.walks_full : 0),
        samples_(p.groups * p.per_cache),
        room_(crosses ? p.segments_first : p.most_vertices) {}

  /// False if not all of it fits; the film is then unchanged.
  bool run() {
    if (!light_walks() || !camera_walks()) return false;
    const uint64_t row = p_.per_cache + 2;
    if (crosses_ && (camera_end_ - camera_) * row > machine_.room().estimates()) return false;
    // The film changes from here on.
    run(Step::meet_lights, camera_end_ - camera_, camera_);
    if (techniques_.has(Technique::direct))
      pairs({Step::choose_next_events, Step::connect, 1, Ends::camera}, camera_, camera_end_);
    if (techniques_.has(Technique::bi))
      pairs({Step::choose_connections, Step::connect, 2, Ends::both}, camera_, camera_end_);
    if (techniques_.has(Technique::light))
      pairs({Step::choose_splats, Step::connect, 1, Ends::light}, walks_, lights_end_);
    if (crosses_) segments();
    return true;
  }

 private:
  void run(Step step, uint32_t count, uint32_t first = 0, uint32_t next = 0) {
    if (count > 0) machine_.run(step, {count, first, next});
  }

  // Traces `count` rays and adds a vertex to each walk, until no walk continues.
  bool extend(bool of_light, uint32_t count) {
    const Step arrive = of_light ? Step::arrive_light : Step::arrive_camera;
    for (;;) {
      if (count > room_ - used_) return false;
      const uint32_t first = used_;
      run(Step::trace, count);
      run(arrive, count, 0, first);
      used_ += count;
      run(of_light ? Step::flag_light : Step::flag_camera, count, first);
      count = machine_.pick(count, first);
      if (count == 0) return true;
      run(of_light ? Step::go_on_light : Step::go_on_camera, count);
    }
  }

  bool light_walks() {
    if (walks_ == 0) return true;
    if (walks_ > room_) return false;
    run(Step::begin_light_walks, walks_);
    used_ = walks_;
    if (!extend(true, walks_)) return false;
    lights_end_ = used_;
    machine_.place_ends(walks_);
    run(Step::list_ends, lights_end_ - walks_, walks_);
    return true;
  }

  bool camera_walks() {
    camera_ = used_;
    run(Step::begin_camera_walks, samples_);
    if (!extend(false, samples_)) return false;
    camera_end_ = used_;
    return true;
  }

  // The ends of a connection where a BSDF is evaluated.
  enum class Ends : uint8_t { light, camera, both };
  struct Pairing {
    Step choose, connect;
    uint32_t each;  // connections
    Ends ends;
  };

  // Chooses connections for each of first .. end, and makes the paths.
  void pairs(const Pairing& p, uint32_t first, uint32_t end) {
    const uint32_t most = machine_.room().connections() / p.each;
    for (uint32_t at = first; at < end; at += most) {
      const uint32_t n = std::min(most, end - at);
      run(p.choose, n, at, camera_);
      const uint32_t chosen = machine_.pick(p.each * n);
      if (p.ends != Ends::camera) run(Step::scatter_ends, chosen, 0);
      if (p.ends != Ends::light) run(Step::scatter_ends, chosen, 1);
      run(Step::see, chosen);
      run(p.connect, chosen > 0 ? machine_.pick(p.each * n) : 0);
      if (p.choose == Step::choose_sides) run(Step::gather_sides, n, at);
    }
  }

  void segments() {
    run(Step::list_starts, walks_);
    run(Step::begin_segments, samples_);
    run(Step::trace, 2 * samples_);
    run(Step::end_segments, 2 * samples_);
    run(Step::put_segments, samples_);
    pairs({Step::choose_sides, Step::connect_sides, 2, Ends::both}, 0, samples_);
    pairs({Step::choose_seen, Step::connect_segments, 1, Ends::light}, 0, samples_);
    run(Step::flag_lit, samples_);
    if (machine_.pick(samples_) == 0) return;
    run(Step::list_lit, samples_);
    run(Step::estimate_segments, camera_end_ - camera_, camera_);
    pairs({Step::choose_segments, Step::connect_segments, 3, Ends::both}, 0, samples_);
  }

  Machine& machine_;
  const RenderParameters& p_;
  const TechniqueSet techniques_;
  const bool crosses_;
  const uint32_t walks_, samples_, room_;
  uint32_t used_ = 0, lights_end_ = 0, camera_ = 0, camera_end_ = 0;  // slots
};

}  // namespace

// Drivers compile a kernel when it first runs: one cache runs those that the integrator needs.
void WavefrontRenderer::prepare(const Integrator& integrator, const SampleRules& rules,
                                const Film& film, bool quiet) {
  ProgressBar progress("making kernels", "submission", 1, quiet);
  RenderParameters p = parameters_of(integrator, rules, 0, film);
  p.groups = 1;
  submit(p, cache_offsets(p));
  machine_->take_film();
  progress.advance();
}

bool WavefrontRenderer::crosses(const RenderParameters& p) const {
  const TechniqueSet techniques = TechniqueSet::of_bits(static_cast<uint8_t>(p.techniques));
  return techniques.has(Technique::portal) && !vista.openings.portals.empty();
}

bool WavefrontRenderer::submit(RenderParameters p, const std::vector<uint32_t>& cache_offsets) {
  p.segments_first = p.most_vertices - 2 * p.groups * p.per_cache;
  machine_->set(p, cache_offsets);
  if (Submission(*machine_, p, crosses(p)).run()) return true;
  p.ray_counts_as = UINT32_MAX;
  machine_->set(p, cache_offsets);
  Submission(*machine_, p, crosses(p)).run();
  return false;
}

}  // namespace tdpt
