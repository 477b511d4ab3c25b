// How a pilot draws its samples, and evaluates each path for all candidates [pilot.h].
#include "tools/tdpt-render/plan/pilot.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>

#include "tools/tdpt-render/integrators/spread_pixels.h"

namespace tdpt {
namespace {

constexpr uint64_t kChunk = 64;  // groups that one thread sums in order
constexpr double kAlike = 1.05;  // greatest moment over least

bool directed(const Candidate& c) {
  return c.integrator.mixture.guiding != Guiding{};
}

// A run stands for the candidates whose walks and next events are of the same manner.
enum class Manner { plain, looking_out, directed };

Manner manner(const Vista& vista, const Candidate& c) {
  if (directed(c)) return Manner::directed;
  return !vista.openings.windows.empty() && c.integrator.mixture.looks_out() ? Manner::looking_out
                                                                             : Manner::plain;
}

int techniques(const Candidate& c) {
  return std::popcount(c.integrator.mixture.techniques.bits());
}

// Index of the block, across or down, in which a pixel lies.
int64_t part_of(int64_t at, int64_t size) {
  return at * PilotSums::kAcross / size;
}

}  // namespace

PilotSums::PilotSums(size_t candidates, size_t runs)
    : splats(candidates, std::vector<double>(kBatches * kBlocks)),
      luminance(kBlocks),
      squares(kBlocks),
      missed(candidates),
      rays(runs) {}

void PilotSums::merge(const PilotSums& other) {
  for (size_t b = 0; b < kBlocks; ++b) {
    luminance[b] += other.luminance[b];
    squares[b] += other.squares[b];
  }
  for (size_t i = 0; i < splats.size(); ++i) {
    missed[i] += other.missed[i];
    for (size_t b = 0; b < splats[i].size(); ++b) splats[i][b] += other.splats[i][b];
  }
  for (size_t r = 0; r < rays.size(); ++r)
    for (size_t p = 0; p < kParts; ++p) rays[r][p].merge(other.rays[r][p]);
}

bool begins_with_a_light_walk(Strategy s) {
  return s.technique == Technique::light || s.technique == Technique::bi ||
         (s.technique == Technique::portal && s.split > 0);
}

// A path of a sample's camera walk with a light walk or a segment of the cache, as a candidate
// would make it.
struct Connected {
  double brought;  // contribution, given that the candidate has that walk
  double often;    // how often it has it, relative to the run
  double chance;   // that the path is then made; a rarer path has a square as much larger
};

// Correlation of the paths of one sample, for one candidate: the expectation of X^2 less the sum of
// squares of its paths.
class Together {
 public:
  void clear() {
    sum = squares = lit = 0;
    walks_.clear();
  }
  void add(const Vertex* walk, const Connected& j) {
    lit += j.brought * j.often;
    auto at =
        std::find_if(walks_.begin(), walks_.end(), [&](const Walk& w) { return w.y == walk; });
    if (at == walks_.end()) at = walks_.insert(at, {walk});
    at->sum += j.brought * std::sqrt(j.often);
    at->squares += j.brought * j.brought * j.often * j.chance;
    at->lit += j.brought * j.often;
  }
  double of_camera() const { return sum * sum - squares; }
  double of_light_walks() const {
    double all = (2 * sum + lit) * lit;
    for (const Walk& w : walks_) all += w.sum * w.sum - w.squares - w.lit * w.lit;
    return all;
  }

  double sum = 0, squares = 0;  // of paths from the camera
  double lit = 0;               // of paths that begin with light walks

 private:
  // Two paths of one walk occur together about as often as the geometric mean of their frequencies.
  struct Walk {
    const Vertex* y;
    double sum = 0, squares = 0, lit = 0;
  };
  std::vector<Walk> walks_;
};

// One sample of a run, evaluated for all candidates.
class PilotSample {
 public:
  PilotSample(const Pilot& pilot, size_t run, PilotSums& sums)
      : pilot_(pilot),
        run_(run),
        sums_(sums),
        together_(pilot.candidates_.size()),
        of_(together_.size()),
        moments_(together_.size()) {}

  void begin(int x, int y, uint64_t group, PilotRecord& record) {
    block_ = block_of(x, y);
    batch_ = group % PilotSums::kBatches * PilotSums::kBlocks;
    record_ = &record;
    const size_t n = together_.size();
    record = {0, 0, std::vector<double>(n), std::vector<double>(n), std::vector<double>(n)};
    for (Together& t : together_) t.clear();
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
    record_->brought += light;
    record_->alike += light * share;
    for (size_t i = 0; i < together_.size(); ++i) bring(i, light);
  }

  void end() {
    for (size_t i = 0; i < together_.size(); ++i) {
      if (pilot_.home_[i] == run_) record_->common[i] += together_[i].of_camera();
      if (pilot_.lit_by_[i] == run_) record_->common[i] += together_[i].of_light_walks();
    }
  }

  size_t block() const { return block_; }

 private:
  const Mixture& mixture(size_t candidate) const {
    return pilot_.candidates_[candidate].integrator.mixture;
  }

  size_t block_of(int x, int y) const {
    return static_cast<size_t>(part_of(y, pilot_.vista_.view.film.height()) * PilotSums::kAcross +
                               part_of(x, pilot_.vista_.view.film.width()));
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
    sums_.luminance[block] += light;
    sums_.squares[block] += light * light;
  }

  // A path from the camera, in the sample's own pixel, that candidate i makes as the run does.
  void bring(size_t i, double brought) {
    Together& t = together_[i];
    t.sum += brought;
    t.squares += brought * brought;
    if (pilot_.home_[i] == run_) record_->x[i] += brought;
  }

  // A path with a light walk of the run, or with its segment.
  void bring(size_t i, const Connected& j, const Vertex* walk) {
    if (pilot_.lit_by_[i] == run_) together_[i].add(walk, j);
    if (pilot_.home_[i] == run_) record_->x[i] += j.brought * j.often;
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
    if (!splat) record_->brought += f * per_sample(own) / of[own].counted;
    double least = INFINITY, most = 0;
    for (size_t i = 0; i < of.size(); ++i) {
      if (!(of[i].counted > 0)) {
        sums_.missed[i] += share;
        continue;
      }
      moments_[i] = share * f * (of[i].squares / of[i].counted / of[i].counted);
      least = std::min(least, moments_[i]);
      most = std::max(most, moments_[i]);
      if (splat || !(of[i].used > 0)) continue;
      const double brought = f * per_sample(i) / of[i].counted;
      if (!segment && !begins_with_a_light_walk(strategy)) {
        bring(i, brought);
        continue;
      }
      // Samples that the candidate makes for each of the run's, if all were connected.
      const double more = samples_of(i) / samples_of(own);
      const int walk = segment ? strategy.split : 0;
      bring(i, {brought, of[i].used / of[own].used / more, std::min(1.0, chance / more)},
            &path.vertex(walk));
    }
    if (!splat && most < kAlike * least) {
      record_->alike += most;
      return;
    }
    for (size_t i = 0; i < of.size(); ++i)
      if (of[i].counted > 0)
        (splat ? sums_.splats[i][batch_ + block] : record_->moments[i]) += moments_[i];
  }

  const Pilot& pilot_;
  const size_t run_;
  PilotSums& sums_;
  size_t block_ = 0, batch_ = 0;
  double share_of_cache_ = 1;
  PilotRecord* record_ = nullptr;
  std::vector<Together> together_;  // by candidate
  std::vector<StrategySums> of_;
  std::vector<double> moments_;
  WalkDensities plain_, directed_;
};

Pilot::Pilot(const Vista& vista, const std::vector<Candidate>& candidates, const SampleRules& rules,
             const WorkTables& work)
    : vista_(vista), candidates_(candidates), rules_(rules), work_(work), home_(candidates.size()) {
  // For each manner, the first candidate with the most techniques.
  for (const Manner m : {Manner::plain, Manner::looking_out, Manner::directed}) {
    size_t most = candidates.size();
    for (size_t i = 0; i < candidates.size(); ++i)
      if (manner(vista, candidates[i]) == m &&
          (most == candidates.size() || techniques(candidates[i]) > techniques(candidates[most])))
        most = i;
    if (most == candidates.size()) continue;
    for (size_t i = 0; i < candidates.size(); ++i)
      if (manner(vista, candidates[i]) == m) home_[i] = runs_.size();
    runs_.push_back(most);
  }
  lit_by_ = home_;
  for (size_t r = 0; r < runs_.size(); ++r)
    if (candidates[runs_[r]].integrator.mixture.guiding.chance[0] > 0)
      std::fill(lit_by_.begin(), lit_by_.end(), r);
  for (const Candidate& c : candidates)
    guides_.push_back(Guide::knowing_all(vista, c.integrator.mixture));
  sums_ = PilotSums(candidates.size(), runs_.size());
}

namespace {

// Makes samples of one run and counts the rays by phase and technique.
class Runner {
 public:
  using Rays = std::array<RayCounts, PilotSums::kParts>;

  Runner(const Vista& vista, const Mixture& mixture, const Guide& guide, const SampleSettings& how,
         Film& film, const PathObserver& observer)
      : mixture_(mixture),
        tally_(film.unit()),
        sampler_(vista, how, guide, film, tally_, &observer) {}

  void light_phase(int x, int y, uint64_t number, Walk& walk, Rays& rays) {
    if (!sampler_.has_light_phase()) return;
    sampler_.begin(x, y, number);
    count(rays[1], [&] { sampler_.light_phase(walk); });
  }

  void segment_phase(int x, int y, uint64_t number, const Walk& walk, LightVertexCache& cache,
                     Rays& rays) {
    if (!sampler_.has_segment_phase()) return;
    sampler_.begin(x, y, number);
    count(rays[2], [&] { sampler_.segment_phase(walk, cache); });
  }

  void camera_phase(int x, int y, uint64_t number, const Walk& walk, LightVertexCache& cache,
                    Rays& rays) {
    sampler_.begin(x, y, number);
    sampler_.connect_with(walk, cache);
    count(rays[0], [&] { sampler_.walk_from_camera(); });
    for (size_t t = 0; t < kTechniques; ++t)
      if (const auto technique = static_cast<Technique>(t); mixture_.has(technique))
        count(rays[3 + t], [&] { sampler_.run(technique); });
  }

 private:
  template <class Work>
  void count(RayCounts& rays, const Work& work) {
    tally_.rays = {};
    work();
    rays.merge(tally_.rays);
  }

  const Mixture& mixture_;
  Tally tally_;
  PathSampler sampler_;
};

}  // namespace

// Draws groups [first, end) of one run, one sample of each at a time; light walks are cached as in
// the picture.
void Pilot::draw_run(size_t r, uint64_t first, uint64_t end, Film& film, PilotSums& sums) {
  const Integrator& integrator = candidates_[runs_[r]].integrator;
  PilotSample seen(*this, r, sums);
  const PathObserver observer = [&](const Contribution& found) { seen.see(found); };
  const SampleSettings how{integrator.mixture, rules_.max_depth, 1, rules_.seed,
                           stream_in(kPilotRound.first, integrator.stream)};
  Runner runner(vista_, integrator.mixture, guides_[runs_[r]], how, film, observer);
  const uint64_t per_cache = samples_of_cache(integrator.mixture);
  std::vector<Walk> walks(light_walks_of(integrator.mixture, per_cache));
  const Walk none;
  LightVertexCache cache;
  // Runs of 2^32 samples of a pixel are independent [sequence.h].
  const auto number = [](uint64_t k, size_t j) { return (kPilotGroup * k + j) << 32; };
  const auto draw_cache = [&](uint64_t begin, uint64_t in_cache, size_t j) {
    const uint64_t walking = light_walks_of(integrator.mixture, in_cache);
    cache.clear(in_cache);
    seen.share_of_cache(static_cast<double>(in_cache) / static_cast<double>(per_cache));
    // Visits the first `count` samples: place in the cache, group, pixel.
    const auto each = [&](uint64_t count, const auto& visit) {
      for (uint64_t i = 0; i < count; ++i) {
        const auto [x, y] =
            spread_pixel(begin + i, vista_.view.film.width(), vista_.view.film.height());
        visit(i, begin + i, x, y);
      }
    };
    const auto walk_of = [&](uint64_t i) -> const Walk& { return i < walking ? walks[i] : none; };
    each(walking, [&](uint64_t i, uint64_t k, int x, int y) {
      runner.light_phase(x, y, number(k, j), walks[i], sums.rays[r]);
      cache.add(walks[i]);
    });
    each(in_cache, [&](uint64_t i, uint64_t k, int x, int y) {
      runner.segment_phase(x, y, number(k, j), walk_of(i), cache, sums.rays[r]);
    });
    each(in_cache, [&](uint64_t i, uint64_t k, int x, int y) {
      seen.begin(x, y, k, record(k, r, j));
      runner.camera_phase(x, y, number(k, j), walk_of(i), cache, sums.rays[r]);
      seen.end();
      blocks_[k] = static_cast<uint32_t>(seen.block());
    });
  };
  for (uint64_t begin = first; begin < end; begin += per_cache)
    for (size_t j = 0; j < kPilotGroup; ++j) draw_cache(begin, std::min(per_cache, end - begin), j);
}

void Pilot::draw(uint64_t groups, Film& film) {
  const uint64_t first = this->groups(), end = first + groups;
  blocks_.resize(end);
  records_.resize(end * samples_of_group());
  std::vector<PilotSums> parts((groups + kChunk - 1) / kChunk);
  tbb::parallel_for(size_t{0}, parts.size(), [&](size_t c) {
    parts[c] = PilotSums(candidates_.size(), runs_.size());
    const uint64_t begin = first + c * kChunk;
    for (size_t r = 0; r < runs_.size(); ++r)
      draw_run(r, begin, std::min(end, begin + kChunk), film, parts[c]);
  });
  for (const PilotSums& part : parts) sums_.merge(part);
}

}  // namespace tdpt
