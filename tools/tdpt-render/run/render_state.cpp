#include "tools/tdpt-render/run/render_state.h"

#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/json_depth.h"

namespace tdpt {
namespace {

using Json = nlohmann::ordered_json;

// ---- The tally ----

constexpr const char *kRays = "rays", *kEnergy = "energy", *kByLength = "by_length",
                     *kPortals = "portal_samples", *kPortalEnergy = "portal_energy",
                     *kNotFinite = "not_finite";

// The values of that name, at most `n`.
std::vector<Units> taken(const Counts& counts, const char* name, size_t n) {
  const auto found = counts.find(name);
  if (found == counts.end()) return std::vector<Units>(n);
  std::vector<Units> values = found->second;
  values.resize(n);
  return values;
}

uint64_t low(Units units) {
  return static_cast<uint64_t>(units);
}

// ---- Its numbers, checked on reading ----

class Reader {
 public:
  Reader(const Json& from, const std::string& file) : from_(from), file_(file) {}

  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw InputError(file_, "film.state." + key, what);
  }
  const Json& at(const char* key) const {
    const auto found = from_.find(key);
    if (found == from_.end()) fail(key, "is missing");
    return *found;
  }
  uint64_t whole(const char* key) const {
    const Json& value = at(key);
    if (!value.is_number_unsigned() || value.get<uint64_t>() > uint64_t{1} << 40)
      fail(key, "is out of range");
    return value.get<uint64_t>();
  }
  double finite(const char* key) const {
    const double value = real(key);
    if (!(value <= 1e12)) fail(key, "is out of range");
    return value;
  }
  double real(const char* key) const {
    const Json& value = at(key);
    if (value.is_null()) return std::numeric_limits<double>::infinity();  // JSON has no infinity
    if (!value.is_number() || !(value.get<double>() >= 0)) fail(key, "is out of range");
    return value.get<double>();
  }
  bool flag(const char* key) const {
    if (!at(key).is_boolean()) fail(key, "is no yes or no");
    return at(key).get<bool>();
  }
  std::string text(const char* key) const {
    if (!at(key).is_string()) fail(key, "is no text");
    return at(key).get<std::string>();
  }
  Reader of(const char* key) const {
    if (!at(key).is_object()) fail(key, "is no object");
    return {at(key), file_};
  }
  // What `read` makes of each object of a list.
  template <class Read>
  auto list(const char* key, size_t most, Read read) const {
    const Json& entries = at(key);
    if (!entries.is_array() || entries.size() > most) fail(key, "is no list");
    std::vector<decltype(read(*this))> all;
    for (const Json& entry : entries) {
      if (!entry.is_object()) fail(key, "has an entry that is no object");
      all.push_back(read(Reader(entry, file_)));
    }
    return all;
  }
  const std::string& file() const { return file_; }

 private:
  const Json& from_;
  const std::string& file_;
};

Json json_of(const Limits& limits) {
  return {{"spp", limits.spp},
          {"seconds", limits.seconds},
          {"target_error", limits.target_error},
          {"retry", limits.retry}};
}

Limits limits_of(const Reader& in) {
  return {in.whole("spp"), in.finite("seconds"), in.finite("target_error"), in.flag("retry")};
}

Json json_of(const ErrorPilot& pilot) {
  Json rounds = Json::array();
  for (const ErrorPilot::Round& r : pilot.rounds)
    rounds.push_back({{"samples", r.samples},
                      {"lit", r.estimate.lit},
                      {"relmse", r.estimate.relmse},
                      {"spread", r.estimate.spread},
                      {"pixels", r.estimate.pixels}});
  return {{"needed", pilot.needed}, {"rounds", rounds}};
}

ErrorPilot::Round round_of(const Reader& in) {
  return {in.whole("samples"),
          {in.flag("lit"), in.real("relmse"), in.real("spread"), in.real("pixels")}};
}

ErrorPilot pilot_of(const Reader& in) {
  return {in.list("rounds", 64, round_of), in.whole("needed")};
}

Json json_of(const Measured& measured) {
  const Forecast& forecast = measured.forecast;
  Json estimates = Json::array(), gain;
  for (const CandidateEstimate& c : forecast.estimates)
    estimates.push_back({{"integrator", c.integrator},
                         {"portals", c.with_portals},
                         {"relmse", c.relmse},
                         {"work", c.work},
                         {"cost", c.cost}});
  if (const auto& g = forecast.portals)
    gain = {{"times", g->times},
            {"low", g->low},
            {"high", g->high},
            {"with", g->with},
            {"without", g->without}};
  return {{"estimates", estimates},
          {"best", forecast.best},
          {"gain", gain},
          {"samples", measured.pilot_samples},
          {"cpu", measured.pilot_cpu_seconds}};
}

CandidateEstimate estimate_of(const Reader& in) {
  return {in.text("integrator"), in.flag("portals"), in.real("relmse"), in.real("work"),
          in.real("cost")};
}

PortalsGain gain_of(const Reader& in) {
  return {{in.real("times"), in.real("low"), in.real("high")},
          static_cast<size_t>(in.whole("with")),
          static_cast<size_t>(in.whole("without"))};
}

Measured measured_of(const Reader& in) {
  Measured measured;
  Forecast& forecast = measured.forecast;
  forecast.estimates = in.list("estimates", 64, estimate_of);
  const size_t n = forecast.estimates.size();
  forecast.best = static_cast<size_t>(in.whole("best"));
  if (!in.at("gain").is_null()) forecast.portals = gain_of(in.of("gain"));
  if (forecast.best > 0 && forecast.best >= n) in.fail("best", "is out of range");
  if (forecast.portals && std::max(forecast.portals->with, forecast.portals->without) >= n)
    in.fail("gain", "is of other candidates");
  measured.pilot_samples = in.whole("samples");
  measured.pilot_cpu_seconds = in.finite("cpu");
  return measured;
}

Json json_of(const FrameRecord& frame) {
  return {{"spp", frame.spp},        {"nonzero", frame.nonzero}, {"r", frame.mean.x},
          {"g", frame.mean.y},       {"b", frame.mean.z},        {"seconds", frame.seconds},
          {"cpu", frame.cpu_seconds}};
}

FrameRecord frame_of(const Reader& in) {
  return {in.whole("spp"),
          in.real("nonzero"),
          {in.real("r"), in.real("g"), in.real("b")},
          in.finite("seconds"),
          in.finite("cpu")};
}

Json json_of(const Tally::SamplePixel& place) {
  return {{"sample", place.sample}, {"y", place.y}, {"x", place.x}};
}

Tally::SamplePixel place_of(const Reader& in) {
  return {in.whole("sample"), static_cast<int>(in.whole("y")), static_cast<int>(in.whole("x"))};
}

Json json_of(const TargetOutcome& target) {
  return {{"error", target.error},
          {"pilot_samples", target.pilot_samples},
          {"pilot_cpu_seconds", target.pilot_cpu_seconds},
          {"fixed", target.fixed},
          {"retried", target.retried},
          {"may_retry", target.may_retry},
          {"dark", target.dark}};
}

TargetOutcome target_of(const Reader& in) {
  TargetOutcome target;
  target.error = in.real("error");
  target.pilot_samples = in.whole("pilot_samples");
  target.pilot_cpu_seconds = in.real("pilot_cpu_seconds");
  target.fixed = in.whole("fixed");
  target.retried = in.flag("retried");
  target.may_retry = in.flag("may_retry");
  target.dark = in.flag("dark");
  return target;
}

// For the film of a picture, or of its first samples, as exrmerge writes it.
void stand_without_state(const FilmFacts& facts, RenderState& render_state) {
  render_state.goal = facts.spp;
  render_state.limits.spp = facts.spp;
}

// ---- The blocks as words: the means block after block, then the sums at the end of the last ----

static_assert(sizeof(Rgb) == 12 && sizeof(Vec3d) == 24 &&
              std::endian::native == std::endian::little);

size_t watched_pixels(const Film& film) {
  const size_t step = watched_step(film);
  const size_t all = static_cast<size_t>(film.width()) * static_cast<size_t>(film.height());
  return (all + step - 1) / step;
}

PictureBlocks blocks_of(const StateWords& words, uint64_t size, size_t pixels, const Reader& in) {
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

void read_state(const Reader& in, const StateWords& words, RenderState& render_state) {
  render_state.limits = limits_of(in.of("limits"));
  render_state.first = in.whole("first");
  render_state.goal = in.whole("goal");
  render_state.added = in.whole("added");
  render_state.whole = in.whole("whole");
  render_state.seconds = in.finite("seconds");
  render_state.cpu_seconds = in.finite("cpu_seconds");
  render_state.began = in.finite("began");
  if (!in.at("target").is_null()) render_state.target = target_of(in.of("target"));
  if (render_state.goal == 0 && render_state.limits.seconds == 0)
    in.fail("goal", "is 0, and no time ends the rendering");
  render_state.pilot = pilot_of(in.of("pilot"));
  if (!in.at("measured").is_null()) render_state.measured = measured_of(in.of("measured"));
  render_state.frames = in.list("frames", 1 << 12, frame_of);
  render_state.tally.not_finite_at = in.list("not_finite_at", Tally::kMostPlaces, place_of);
  render_state.blocks =
      blocks_of(words, in.whole("block_samples"), watched_pixels(render_state.film), in);
}

}  // namespace

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

void add_counts(const Counts& counts, Tally& tally) {
  const std::vector<Units> rays = taken(counts, kRays, 4);
  tally.rays.merge({low(rays[0]), low(rays[1]), low(rays[2]), low(rays[3])});
  const std::vector<Units> energy = taken(counts, kEnergy, kTechniques);
  for (size_t i = 0; i < kTechniques; ++i) tally.energy[i].merge(energy[i]);
  const std::vector<Units> by_length = taken(counts, kByLength, Tally::kOctaves);
  for (size_t i = 0; i < Tally::kOctaves; ++i) tally.by_length[i].merge(by_length[i]);
  if (const auto energies = counts.find(kPortalEnergy); energies != counts.end()) {
    const size_t n = energies->second.size();
    const std::vector<Units> samples = taken(counts, kPortals, 2 * n);
    tally.begin_portals(n);
    for (size_t i = 0; i < std::min(n, tally.portals.size()); ++i) {
      tally.portals[i].drawn += low(samples[2 * i]);
      tally.portals[i].lit += low(samples[2 * i + 1]);
      tally.portals[i].energy.merge(energies->second[i]);
    }
  }
  tally.not_finite += low(taken(counts, kNotFinite, 1)[0]);
}

std::string render_state_text(const RenderState& render_state) {
  Json target, measured, frames = Json::array(), places = Json::array();
  if (render_state.target) target = json_of(*render_state.target);
  if (render_state.measured) measured = json_of(*render_state.measured);
  for (const FrameRecord& frame : render_state.frames) frames.push_back(json_of(frame));
  for (const Tally::SamplePixel& place : render_state.tally.not_finite_at)
    places.push_back(json_of(place));
  return Json{{"limits", json_of(render_state.limits)},
              {"first", render_state.first},
              {"goal", render_state.goal},
              {"added", render_state.added},
              {"whole", render_state.whole},
              {"seconds", render_state.seconds},
              {"cpu_seconds", render_state.cpu_seconds},
              {"began", render_state.began},
              {"target", target},
              {"pilot", json_of(render_state.pilot)},
              {"measured", measured},
              {"frames", frames},
              {"not_finite_at", places},
              {"block_samples", render_state.blocks.size()}}
      .dump();
}

StateWords blocks_of(const RenderState& render_state) {
  const PictureBlocks& blocks = render_state.blocks;
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

RenderState render_state_of(FilmFile file, const std::string& name) {
  RenderState render_state(std::move(file.film), {});
  add_counts(file.facts.counts, render_state.tally);
  if (file.facts.state.empty()) {
    stand_without_state(file.facts, render_state);
  } else {
    const std::string& state = file.facts.state;
    const Json json = nested_too_deep(state) ? Json() : Json::parse(state, nullptr, false);
    if (!json.is_object()) throw InputError(name, "film.state", "is no JSON object");
    read_state(Reader(json, name), file.words, render_state);
  }
  const std::vector<SampleRange>& ranges = render_state.film.ranges();
  if (ranges.size() > 1 || (!ranges.empty() && ranges[0].first != render_state.first))
    throw InputError(name, "film",
                     "holds " + words_of(ranges) + ", which is no beginning to go on from");
  return render_state;
}

}  // namespace tdpt
