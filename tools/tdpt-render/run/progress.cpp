// Each record is described once, by the names and ranges of its numbers; a RecordWriter makes JSON
// of the description, a RecordReader checks and fills in what a file has.
#include "tools/tdpt-render/run/progress.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "tools/tdpt-render/path/sample/light_vertex_cache.h"

namespace tdpt {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kAny = std::numeric_limits<double>::infinity();

class RecordWriter {
 public:
  // JSON has no infinity: null stands for it.
  void number(const char* key, double value, double, double) { json_[key] = value; }
  void count(const char* key, auto value, uint64_t) { json_[key] = static_cast<uint64_t>(value); }
  void flag(const char* key, bool value) { json_[key] = value; }
  void text(const char* key, const std::string& value) { json_[key] = value; }
  template <class T>
  void record(const char* key, const T& value) {
    RecordWriter of;
    describe(of, value);
    json_[key] = of.json_;
  }
  template <class T>
  void record(const char* key, const std::optional<T>& value) {
    json_[key] = nullptr;
    if (value) record(key, *value);
  }
  template <class T>
  void list(const char* key, const std::vector<T>& values, size_t) {
    json_[key] = Json::array();
    for (const T& value : values) {
      RecordWriter of;
      describe(of, value);
      json_[key].push_back(of.json_);
    }
  }
  std::string dump() const { return json_.dump(); }

 private:
  Json json_ = Json::object();
};

class RecordReader {
 public:
  RecordReader(Json from, std::string file, std::string place)
      : from_(std::move(from)), file_(std::move(file)), place_(std::move(place)) {}
  static RecordReader of_text(const std::string& text, const std::string& file,
                              const std::string& place) {
    Json json = nested_too_deep(text) ? Json() : Json::parse(text, nullptr, false);
    if (!json.is_object()) throw InputError(file, place, "is no JSON object");
    return {std::move(json), file, place};
  }

  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw InputError(file_, place_ + "." + key, what);
  }
  void number(const char* key, double& value, double lowest, double highest) {
    const Json& there = at(key);
    if (!there.is_null() && !there.is_number()) fail(key, "is no number");
    value = there.is_null() ? kAny : there.get<double>();
    if (!(value >= lowest && value <= highest)) fail(key, "is out of range");
  }
  template <class Whole>
  void count(const char* key, Whole& value, uint64_t most) {
    if (!at(key).is_number_unsigned() || at(key).get<uint64_t>() > most)
      fail(key, "is out of range");
    value = static_cast<Whole>(at(key).get<uint64_t>());
  }
  void flag(const char* key, bool& value) {
    if (!at(key).is_boolean()) fail(key, "is no yes or no");
    value = at(key).get<bool>();
  }
  void text(const char* key, std::string& value) {
    if (!at(key).is_string()) fail(key, "is no text");
    value = at(key).get<std::string>();
  }
  template <class T>
  void record(const char* key, T& value) {
    if (!at(key).is_object()) fail(key, "is no object");
    RecordReader of(at(key), file_, place_ + "." + key);
    describe(of, value);
  }
  template <class T>
  void record(const char* key, std::optional<T>& value) {
    if (!at(key).is_null()) record(key, value.emplace());
  }
  template <class T>
  void list(const char* key, std::vector<T>& values, size_t most) {
    if (!at(key).is_array() || at(key).size() > most) fail(key, "is no list");
    for (const Json& entry : at(key)) {
      if (!entry.is_object()) fail(key, "has an entry that is no object");
      RecordReader of(entry, file_, place_ + "." + key);
      describe(of, values.emplace_back());
    }
  }

 private:
  const Json& at(const char* key) const {
    const auto found = from_.find(key);
    if (found == from_.end()) fail(key, "is missing");
    return *found;
  }

  const Json from_;
  const std::string file_, place_;
};

// ---- The records; of a RecordWriter they are const, of a RecordReader not ----

template <class T, class Record>
concept Of = std::same_as<std::remove_const_t<T>, Record>;

constexpr uint64_t kMostCount = uint64_t{1} << 40;
constexpr double kMostSeconds = 1e12;

void describe(auto& as, Of<Limits> auto& limits) {
  as.count("spp", limits.spp, kMostCount);
  as.number("seconds", limits.seconds, 0, kMostSeconds);
  as.number("target_error", limits.target_error, 0, 1e12);
  as.flag("retry", limits.retry);
}

void describe(auto& as, Of<Lights::KindProbabilities> auto& lights) {
  as.number("surfaces", lights.surfaces, 0, 1);
  as.number("lamps", lights.lamps, 0, 1);
  as.number("parallel", lights.parallel, 0, 1);
  as.number("sky", lights.sky, 0, 1);
}

void describe(auto& as, Of<Truncation> auto& beyond) {
  as.count("depth", beyond.depth, kMaxDepth);
  as.number("share", beyond.share, 0, 1);
  as.number("error", beyond.error, 0, 1e3);
}

void describe(auto& as, Of<PortalWay> auto& way) {
  as.count("way", way, static_cast<uint64_t>(PortalWay::left_out));
}

void describe(auto& as, Of<Mixture> auto& m) {
  as.number("first_direct", m.first_direct, 1e-3, 1e3);
  as.number("later_direct", m.later_direct, 1e-3, 1e3);
  as.number("segments", m.segments, 0.01, 1);
  as.number("light_walks", m.light_walks, kFewestLightWalks, 1);
  as.number("connected", m.connected, 1e-3, LightVertexCache::kWalks);
  as.number("connected_to_segments", m.connected_to_segments, 1e-3, LightVertexCache::kWalks);
  as.number("segments_connected", m.segments_connected, 1,
            LightVertexCache::kWalks / kFewestLightWalks);
  as.number("guide_light", m.guiding.chance[0], 0, 0.95);
  as.number("guide_camera", m.guiding.chance[1], 0, 0.95);
  as.number("through_windows", m.through_windows, 0, 0.95);
}

void describe(auto& as, Of<CandidateEstimate> auto& c) {
  as.text("integrator", c.integrator);
  as.flag("portals", c.with_portals);
  as.number("relmse", c.relmse, 0, kAny);
  as.number("work", c.work, 0, kAny);
  as.number("cost", c.cost, 0, kAny);
}

void describe(auto& as, Of<ErrorEstimate> auto& round) {
  as.count("samples", round.samples, kMostCount);
  as.flag("lit", round.lit);
  as.number("relmse", round.relmse, 0, kAny);
  as.number("spread", round.spread, 0, kAny);
  as.number("pixels", round.pixels, 0, kAny);
}

void describe(auto& as, Of<FrameRecord> auto& frame) {
  as.count("spp", frame.spp, kMostCount);
  as.number("nonzero", frame.nonzero, 0, 1);
  as.number("r", frame.mean.x, 0, kAny);
  as.number("g", frame.mean.y, 0, kAny);
  as.number("b", frame.mean.z, 0, kAny);
  as.number("seconds", frame.seconds, 0, kMostSeconds);
  as.number("cpu", frame.cpu_seconds, 0, kMostSeconds);
}

void describe(auto& as, Of<Tally::SamplePixel> auto& place) {
  as.count("sample", place.sample, kMostCount);
  as.count("y", place.y, 1 << 30);
  as.count("x", place.x, 1 << 30);
}

// What the picture hangs on: alike in all its parts.
void describe(auto& as, Of<Plan> auto& plan) {
  as.text("label", plan.label);
  as.record("mixture", plan.integrator.mixture);
  as.count("spp", plan.spp, kMostSamples);
  as.list("portals", plan.explored.ways, 1 << 20);
  as.record("lights", plan.explored.lights);
  as.record("beyond", plan.explored.beyond);
}

// What was measured besides.
void describe_measured(auto& as, auto& plan) {
  as.list("estimates", plan.forecast.estimates, 64);
  as.count("best", plan.forecast.best, 64);
  as.number("portals_gain", plan.forecast.portals_gain, 0, kAny);
  as.number("gain_low", plan.forecast.gain_low, 0, kAny);
  as.number("gain_high", plan.forecast.gain_high, 0, kAny);
  as.count("pilot_samples", plan.pilot_samples, kMostCount);
  as.number("pilot_cpu", plan.pilot_cpu_seconds, 0, kMostSeconds);
  as.count("explored", plan.explored.samples, kMostCount);
  as.number("exploration_cpu", plan.explored.cpu_seconds, 0, kMostSeconds);
  as.list("rounds", plan.error_rounds, 64);
  as.count("needed", plan.needed, kMostCount);
  as.number("error_pilot_cpu", plan.error_pilot_cpu_seconds, 0, kMostSeconds);
}

void describe(auto& as, Of<Progress> auto& progress) {
  as.record("limits", progress.limits);
  as.count("first", progress.first, kMostCount);
  as.count("goal", progress.goal, kMostCount);
  as.count("added", progress.added, kMostCount);
  as.count("whole", progress.whole, kMostCount);
  as.number("seconds", progress.seconds, 0, kMostSeconds);
  as.number("cpu_seconds", progress.cpu_seconds, 0, kMostSeconds);
  as.number("began", progress.began, 0, kMostSeconds);
  as.count("retried", progress.retried, kMostCount);
  as.list("frames", progress.frames, 1 << 12);
  as.list("not_finite_at", progress.tally.not_finite_at, Tally::kMostPlaces);
}

// ---- The sums of the tally, which add over parts of a picture ----

constexpr const char *kRays = "rays", *kEnergy = "energy", *kByLength = "by_length",
                     *kPortals = "portal_samples", *kPortalEnergy = "portal_energy",
                     *kNotFinite = "not_finite";

Counts counts_of(const Tally& tally) {
  Counts counts;
  const RayCounts& rays = tally.rays;
  counts[kRays] = {rays.closest, rays.shadow, rays.portal, rays.connect};
  for (const UnitSum& sum : tally.energy) counts[kEnergy].push_back(sum.units());
  for (const UnitSum& sum : tally.by_length) counts[kByLength].push_back(sum.units());
  for (const Tally::OfPortal& portal : tally.portals) {
    counts[kPortals].push_back(portal.drawn);
    counts[kPortals].push_back(portal.lit);
    counts[kPortalEnergy].push_back(portal.energy.units());
  }
  counts[kNotFinite] = {tally.not_finite};
  return counts;
}

// Ignores counts that this program does not know, and surplus ones.
void add_counts(const Counts& counts, Tally& tally) {
  const auto taken = [&](const char* name, size_t n) {
    const auto found = counts.find(name);
    std::vector<Units> values = found == counts.end() ? std::vector<Units>() : found->second;
    values.resize(n);
    return values;
  };
  const auto low = [](Units units) { return static_cast<uint64_t>(units); };
  const std::vector<Units> rays = taken(kRays, 4);
  tally.rays.merge({low(rays[0]), low(rays[1]), low(rays[2]), low(rays[3])});
  const std::vector<Units> energy = taken(kEnergy, kTechniques);
  for (size_t i = 0; i < kTechniques; ++i) tally.energy[i].merge(energy[i]);
  const std::vector<Units> by_length = taken(kByLength, Tally::kOctaves);
  for (size_t i = 0; i < Tally::kOctaves; ++i) tally.by_length[i].merge(by_length[i]);
  if (const auto energies = counts.find(kPortalEnergy); energies != counts.end()) {
    const size_t n = energies->second.size();
    const std::vector<Units> samples = taken(kPortals, 2 * n);
    tally.begin_portals(n);
    for (size_t i = 0; i < std::min(n, tally.portals.size()); ++i) {
      tally.portals[i].drawn += low(samples[2 * i]);
      tally.portals[i].lit += low(samples[2 * i + 1]);
      tally.portals[i].energy.merge(energies->second[i]);
    }
  }
  tally.not_finite += low(taken(kNotFinite, 1)[0]);
}

// ---- The blocks as words: the means block after block, then the sums at the end of the last ----

static_assert(sizeof(Rgb) == 12 && sizeof(Vec3d) == 24 &&
              std::endian::native == std::endian::little);

StateWords words_of(const PictureBlocks& blocks) {
  StateWords words;
  const auto append = [&](const auto& values) {
    const size_t at = words.size(), bytes = values.size() * sizeof values[0];
    words.resize(at + bytes / 4);
    if (bytes > 0) std::memcpy(words.data() + at, values.data(), bytes);
  };
  for (const std::vector<Rgb>& part : blocks.blocks()) append(part);
  append(blocks.before());
  return words;
}

PictureBlocks blocks_of(const StateWords& words, uint64_t size, const Film& film,
                        const RecordReader& in) {
  const size_t step = watched_step(film);
  const size_t all = static_cast<size_t>(film.width()) * static_cast<size_t>(film.height());
  const size_t pixels = (all + step - 1) / step;
  if (size == 0) in.fail("block_samples", "is out of range");
  if (words.empty()) return PictureBlocks(size, {}, {});
  const size_t of_block = 3 * pixels, of_sums = 6 * pixels;
  if (words.size() < of_sums || (words.size() - of_sums) % of_block != 0 ||
      words.size() > of_sums + 7 * of_block)
    in.fail("block_samples", "has blocks of another size");
  PictureParts parts((words.size() - of_sums) / of_block, std::vector<Rgb>(pixels));
  const uint32_t* from = words.data();
  for (std::vector<Rgb>& part : parts) {
    std::memcpy(static_cast<void*>(part.data()), from, 4 * of_block);
    from += of_block;
  }
  std::vector<Vec3d> before(pixels);
  std::memcpy(static_cast<void*>(before.data()), from, 4 * of_sums);
  return {size, std::move(parts), std::move(before)};
}

}  // namespace

std::string film_bytes(Progress& progress, const Plan& plan, FilmFacts facts,
                       const Channels& channels) {
  RecordWriter decided, state;
  decided.text("integrator", plan.integrator.name);
  decided.count("stream", plan.integrator.stream, kStreams);
  describe(decided, plan);
  describe(state, std::as_const(progress));
  state.count("block_samples", progress.blocks.size(), kMostCount);
  describe_measured(state, plan);
  facts.plan = decided.dump();
  facts.state = state.dump();
  facts.spp = progress.spp();
  facts.counts = counts_of(progress.tally);
  return film_bytes(progress.film, facts, words_of(progress.blocks), channels);
}

Plan plan_of(const FilmFacts& facts, const std::string& name) {
  RecordReader in = RecordReader::of_text(facts.plan, name, "film.plan");
  std::string integrator;
  in.text("integrator", integrator);
  const Integrator* const row = find_integrator(integrator);
  if (!row) in.fail("integrator", "is not known");
  Plan plan;
  plan.integrator = *row;
  in.count("stream", plan.integrator.stream, kStreams - 1);
  if (plan.integrator.stream == 0) in.fail("stream", "is out of range");
  describe(in, plan);
  const Lights::KindProbabilities& s = plan.explored.lights;
  const double sum = s.surfaces + s.lamps + s.parallel + s.sky;
  if (sum != 0 && std::abs(sum - 1) > 1e-9) in.fail("lights", "add up to no 1");
  if (facts.state.empty()) return plan;
  RecordReader state = RecordReader::of_text(facts.state, name, "film.state");
  describe_measured(state, plan);
  const Forecast& forecast = plan.forecast;
  const size_t n = forecast.estimates.size();
  if (forecast.best > 0 && forecast.best >= n) state.fail("best", "is out of range");
  return plan;
}

Progress progress_of(FilmFile file, const std::string& name) {
  Progress progress(std::move(file.film), {});
  add_counts(file.facts.counts, progress.tally);
  if (file.facts.state.empty()) {
    progress.goal = progress.limits.spp = file.facts.spp;
  } else {
    RecordReader in = RecordReader::of_text(file.facts.state, name, "film.state");
    describe(in, progress);
    if (progress.goal == 0 && progress.limits.seconds == 0)
      in.fail("goal", "is 0, and no time ends the rendering");
    uint64_t block = 0;
    in.count("block_samples", block, kMostCount);
    progress.blocks = blocks_of(file.words, block, progress.film, in);
  }
  const std::vector<SampleRange>& ranges = progress.film.ranges();
  if (ranges.size() > 1 || (!ranges.empty() && ranges[0].first != progress.first))
    throw InputError(name, "film",
                     "holds " + words_of(ranges) + ", which is no beginning to go on from");
  return progress;
}

}  // namespace tdpt
