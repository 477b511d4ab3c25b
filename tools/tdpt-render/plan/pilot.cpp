// How a pilot draws its samples, and evaluates each path for all candidates [pilot.h].
#include "tools/tdpt-render/plan/pilot.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>

namespace tdpt {
namespace {

constexpr uint64_t kChunk = 64;  // groups that one thread sums in order
constexpr double kEqual = 1.05;  // greatest moment over least

// A run stands for the candidates whose walks are guided, or for those whose are not.
bool directed(const Candidate& c) {
  return c.integrator.mixture.guiding != Guiding{};
}

int techniques(const Candidate& c) {
  return std::popcount(c.integrator.mixture.techniques.bits());
}

bool begins_with_a_light_walk(Strategy s) {
  return s.technique == Technique::light || s.technique == Technique::bi ||
         (s.technique == Technique::portal && s.split > 0);
}

// A path of a sample's camera walk with a light walk or a segment of the cache, as a candidate
// would make it.
struct Connected {
  double light;      // contribution, given that the candidate has that walk
  double frequency;  // how often it has it, relative to the run
  double chance;     // that the path is then made; a rarer path has a square as much larger
};

// Correlation of the paths of one sample, for one candidate: the expectation of X^2 less the sum of
// squares of its paths.
class Correlation {
 public:
  void clear() {
    camera_ = camera_squares_ = lit_ = 0;
    walks_.clear();
  }
  // A path from the camera.
  void add(double light) {
    camera_ += light;
    camera_squares_ += light * light;
  }
  // A path that begins with that light walk.
  void add(const Vertex* walk, const Connected& c) {
    lit_ += c.light * c.frequency;
    auto at =
        std::find_if(walks_.begin(), walks_.end(), [&](const Walk& w) { return w.y == walk; });
    if (at == walks_.end()) at = walks_.insert(at, {walk});
    at->sum += c.light * std::sqrt(c.frequency);
    at->squares += c.light * c.light * c.frequency * c.chance;
    at->lit += c.light * c.frequency;
  }
  double of_camera() const { return camera_ * camera_ - camera_squares_; }
  double of_light_walks() const {
    double all = (2 * camera_ + lit_) * lit_;
    for (const Walk& w : walks_) all += w.sum * w.sum - w.squares - w.lit * w.lit;
    return all;
  }

 private:
  // Two paths of one walk occur together about as often as the geometric mean of their frequencies.
  struct Walk {
    const Vertex* y;
    double sum = 0, squares = 0, lit = 0;
  };
  double camera_ = 0, camera_squares_ = 0, lit_ = 0;
  std::vector<Walk> walks_;
};

}  // namespace

// One sample of a run, evaluated for all candidates.
class PilotSample {
 public:
  PilotSample(Pilot& pilot, size_t run, Pilot::Sums& sums)
      : pilot_(pilot),
        run_(run),
        sums_(sums),
        correlations_(pilot.candidates_.size()),
        of_(correlations_.size()),
        moments_(correlations_.size()) {}

  void begin(int x, int y, uint64_t group, size_t number) {
    batch_ = group % Pilot::kBatches * Pilot::kBlocks;
    sample_ = (group * pilot_.runs_.size() + run_) * Pilot::kGroup + number;
    first_ = sample_ * correlations_.size();
    pilot_.blocks_[group] = static_cast<uint32_t>(block_ = block_of(x, y));
    for (Correlation& c : correlations_) c.clear();
  }
  /// Samples of this cache over those of a picture's.
  void share_of_cache(double share) { share_of_cache_ = share; }

  void see(const Contribution& found) {
    const double light = luminance(found.value);
    if (!(light > 0 && std::isfinite(light))) return;
    if (found.path.k() >= 2) return weigh(found, light);
    // A lamp seen directly.
    const double share = light / static_cast<double>(pilot_.runs_.size());
    add_light(block_, share);
    pilot_.luminance_[sample_] += light;
    pilot_.equal_[sample_] += light * share;
    for (size_t i = 0; i < of_.size(); ++i) add_camera_path(i, light);
  }

  void end() {
    for (size_t i = 0; i < of_.size(); ++i) {
      double& sum = pilot_.correlation_[first_ + i];
      if (pilot_.home_[i] == run_) sum += correlations_[i].of_camera();
      if (pilot_.lit_by_[i] == run_) sum += correlations_[i].of_light_walks();
    }
  }

 private:
  const Mixture& mixture(size_t candidate) const {
    return pilot_.candidates_[candidate].integrator.mixture;
  }

  size_t block_of(int x, int y) const {
    const FilmPlane& film = pilot_.vista_.view.film;
    const auto part_of = [](int64_t at, int64_t size) { return at * Pilot::kAcross / size; };
    return static_cast<size_t>(part_of(y, film.height()) * Pilot::kAcross +
                               part_of(x, film.width()));
  }
  // Block of a splat, whose pixel is not the sample's.
  size_t block_of(const Path& path) const {
    const FilmPlane& film = path.film();
    double x = 0, y = 0;
    film.raster(between(path.vertex(path.k()), path.vertex(path.k() - 1)).w, x, y);
    return block_of(std::clamp(static_cast<int>(x), 0, film.width() - 1),
                    std::clamp(static_cast<int>(y), 0, film.height() - 1));
  }

  void add_light(size_t block, double light) {
    sums_[Pilot::kLuminance][block] += light;
    sums_[Pilot::kSquares][block] += light * light;
  }
  // A path from the camera, in the sample's own pixel, that candidate i makes as the run does.
  void add_camera_path(size_t i, double light) {
    correlations_[i].add(light);
    if (pilot_.home_[i] == run_) pilot_.x_[first_ + i] += light;
  }
  // A path with a light walk of the run, or with its segment.
  void add_connected_path(size_t i, const Connected& c, const Vertex* walk) {
    if (pilot_.lit_by_[i] == run_) correlations_[i].add(walk, c);
    if (pilot_.home_[i] == run_) pilot_.x_[first_ + i] += c.light * c.frequency;
  }

  // By candidate. The run knows the densities of its own walks; an unguided run's are the plain
  // ones.
  const std::vector<StrategySums>& sums_of(const Path& path, Strategy strategy) {
    const Mixture& own = mixture(pilot_.runs_[run_]);
    const bool is_plain = own.guiding == Guiding{};
    if (!is_plain) path.plain_densities(pilot_.vista_, plain_);
    const WalkDensities& plain = is_plain ? path.walks() : plain_;
    for (size_t i = 0; i < of_.size(); ++i) {
      const Mixture& m = mixture(i);
      if (m.guiding == Guiding{})
        of_[i] = path.sums(m, plain, plain, strategy);
      else if (m.guiding == own.guiding)
        of_[i] = path.sums(m, path.walks(), plain, strategy);
      else {
        path.directed_densities(pilot_.guides_[i], plain, directed_);
        of_[i] = path.sums(m, directed_, plain, strategy);
      }
    }
    return of_;
  }

  void weigh(const Contribution& found, double light) {
    const Path& path = found.path;
    const Strategy& strategy = found.strategy;
    const double times = found.times;
    const std::vector<StrategySums>& of = sums_of(path, strategy);
    double all_runs = 0;
    for (const size_t r : pilot_.runs_) all_runs += of[r].counted;
    const size_t own = pilot_.runs_[run_];
    if (!(of[own].used > 0 && std::isfinite(all_runs))) return;
    // v_s over the samples really made: E[n_s] on average.
    const auto per_sample = [&](size_t i) {
      return mixture(i).sample_weight(strategy.technique, strategy.split, path.k()) / times;
    };
    const auto samples_of = [&](size_t i) {
      return mixture(i).samples_of(strategy.technique, strategy.split, path.k());
    };
    // Over all samples of the strategy: f = value p, `used` = n_s p.
    const double f = light * times / samples_of(own) * of[own].used;
    const double share = f * per_sample(own) / all_runs;  // of the picture, all runs together
    const bool segment = strategy.technique == Technique::portal;
    const bool splat = strategy.technique == Technique::light ||
                       (segment && Mixture::sees_segment(strategy.split, path.k()));
    const double chance =
        std::min(1.0, times / (samples_of(own) * (segment ? share_of_cache_ : 1)));
    const size_t block = splat ? block_of(path) : block_;
    add_light(block, share);
    if (!splat) pilot_.luminance_[sample_] += f * per_sample(own) / of[own].counted;
    double least = INFINITY, most = 0;
    for (size_t i = 0; i < of.size(); ++i) {
      if (!(of[i].counted > 0)) {
        sums_[Pilot::kMissed][i] += share;
        continue;
      }
      moments_[i] = share * f * (of[i].squares / of[i].counted / of[i].counted);
      least = std::min(least, moments_[i]);
      most = std::max(most, moments_[i]);
      if (splat || !(of[i].used > 0)) continue;
      const double contribution = f * per_sample(i) / of[i].counted;
      if (!segment && !begins_with_a_light_walk(strategy)) {
        add_camera_path(i, contribution);
        continue;
      }
      // Samples that the candidate makes for each of the run's, if all were connected.
      const double more = samples_of(i) / samples_of(own);
      add_connected_path(
          i, {contribution, of[i].used / of[own].used / more, std::min(1.0, chance / more)},
          &path.vertex(segment ? strategy.split : 0));
    }
    if (!splat && most < kEqual * least) {
      pilot_.equal_[sample_] += most;
      return;
    }
    for (size_t i = 0; i < of.size(); ++i)
      if (of[i].counted > 0)
        (splat ? sums_[Pilot::kSplats + i][batch_ + block] : pilot_.moments_[first_ + i]) +=
            moments_[i];
  }

  Pilot& pilot_;
  const size_t run_;
  Pilot::Sums& sums_;
  size_t block_ = 0, batch_ = 0;
  size_t sample_ = 0, first_ = 0;  // its place in the pilot's records, and of its first candidate
  double share_of_cache_ = 1;
  std::vector<Correlation> correlations_;  // by candidate
  std::vector<StrategySums> of_;
  std::vector<double> moments_;
  WalkDensities plain_, directed_;
};

Pilot::Pilot(const Vista& vista, const std::vector<Candidate>& candidates, const SampleRules& rules,
             bool on_device)
    : vista_(vista),
      candidates_(candidates),
      rules_(rules),
      on_device_(on_device),
      home_(candidates.size()) {
  // For each way of drawing, the first candidate with the most techniques.
  for (const bool guided : {false, true}) {
    size_t most = candidates.size();
    for (size_t i = 0; i < candidates.size(); ++i) {
      if (directed(candidates[i]) != guided) continue;
      home_[i] = runs_.size();
      if (most == candidates.size() || techniques(candidates[i]) > techniques(candidates[most]))
        most = i;
    }
    if (most < candidates.size()) runs_.push_back(most);
  }
  lit_by_ = home_;
  for (size_t r = 0; r < runs_.size(); ++r)
    if (candidates[runs_[r]].integrator.mixture.guiding.chance[0] > 0)
      std::fill(lit_by_.begin(), lit_by_.end(), r);
  for (const Candidate& c : candidates)
    guides_.push_back(Guide::knowing_all(vista, c.integrator.mixture));
  sums_ = no_sums();
  rays_.resize(runs_.size());
}

Pilot::Sums Pilot::no_sums() const {
  const size_t n = candidates_.size();
  Sums sums(kSplats + n, std::vector<double>(kBatches * kBlocks));
  sums[kLuminance].resize(kBlocks), sums[kSquares].resize(kBlocks), sums[kMissed].resize(n);
  return sums;
}

// Draws groups [first, end) of one run, one sample of each at a time; light walks are cached as in
// the picture.
void Pilot::draw_run(size_t r, uint64_t first, uint64_t end, Film& film, Sums& sums, Rays& rays) {
  const Integrator& integrator = candidates_[runs_[r]].integrator;
  const Mixture& mixture = integrator.mixture;
  PilotSample seen(*this, r, sums);
  const PathObserver observer = [&](const Contribution& found) { seen.see(found); };
  const SampleSettings how{mixture, rules_.max_depth, 1, rules_.seed,
                           stream_in(kPilotRound.first, integrator.stream)};
  Tally tally(film.unit());
  PathSampler sampler(vista_, how, guides_[runs_[r]], film, tally, &observer);
  const auto count = [&](RayCounts& counts, const auto& work) {
    tally.rays = {};
    work();
    counts.merge(tally.rays);
  };
  const uint64_t per_cache = samples_of_cache(mixture);
  std::vector<Walk> walks(light_walks_of(mixture, per_cache));
  const Walk none;
  LightVertexCache cache;
  const auto draw_cache = [&](uint64_t begin, uint64_t in_cache, size_t j) {
    const uint64_t walking = light_walks_of(mixture, in_cache);
    cache.clear(in_cache);
    seen.share_of_cache(static_cast<double>(in_cache) / static_cast<double>(per_cache));
    // Begins the first `samples` samples of the cache.
    const auto each = [&](uint64_t samples, const auto& visit) {
      for (uint64_t i = 0; i < samples; ++i) {
        const uint64_t k = begin + i;
        const auto [x, y] = spread_pixel(k, vista_.view.film.width(), vista_.view.film.height());
        // Runs of 2^32 samples of a pixel are independent [sequence.h].
        sampler.begin(x, y, (kGroup * k + j) << 32);
        seen.begin(x, y, k, j);
        visit(i);
      }
    };
    const auto walk_of = [&](uint64_t i) -> const Walk& { return i < walking ? walks[i] : none; };
    each(walking, [&](uint64_t i) {
      if (sampler.has_light_phase()) count(rays[1], [&] { sampler.light_phase(walks[i]); });
      cache.add(walks[i]);
    });
    each(sampler.has_segment_phase() ? in_cache : 0,
         [&](uint64_t i) { count(rays[2], [&] { sampler.segment_phase(walk_of(i), cache); }); });
    each(in_cache, [&](uint64_t i) {
      sampler.connect_with(walk_of(i), cache);
      count(rays[0], [&] { sampler.walk_from_camera(); });
      for (size_t t = 0; t < kTechniques; ++t)
        if (const auto technique = static_cast<Technique>(t); mixture.has(technique))
          count(rays[3 + t], [&] { sampler.run(technique); });
      seen.end();
    });
  };
  for (uint64_t begin = first; begin < end; begin += per_cache)
    for (size_t j = 0; j < kGroup; ++j) draw_cache(begin, std::min(per_cache, end - begin), j);
}

void Pilot::draw(uint64_t groups, Film& film) {
  const uint64_t first = this->groups(), end = first + groups;
  const size_t samples = end * samples_of_group();
  blocks_.resize(end);
  for (auto* const of_sample : {&luminance_, &equal_}) of_sample->resize(samples);
  for (auto* const of_candidate : {&moments_, &x_, &correlation_})
    of_candidate->resize(samples * candidates_.size());
  std::vector<std::pair<Sums, std::vector<Rays>>> parts((groups + kChunk - 1) / kChunk);
  tbb::parallel_for(size_t{0}, parts.size(), [&](size_t c) {
    parts[c] = {no_sums(), std::vector<Rays>(runs_.size())};
    auto& [sums, rays] = parts[c];
    const uint64_t begin = first + c * kChunk;
    for (size_t r = 0; r < runs_.size(); ++r)
      draw_run(r, begin, std::min(end, begin + kChunk), film, sums, rays[r]);
  });
  for (const auto& [sums, rays] : parts) {
    for (size_t s = 0; s < sums.size(); ++s)
      for (size_t b = 0; b < sums[s].size(); ++b) sums_[s][b] += sums[s][b];
    for (size_t r = 0; r < rays.size(); ++r)
      for (size_t p = 0; p < rays[r].size(); ++p) rays_[r][p].merge(rays[r][p]);
  }
}

}  // namespace tdpt
