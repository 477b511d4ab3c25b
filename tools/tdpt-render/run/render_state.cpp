#include "tools/tdpt-render/run/render_state.h"

#include <array>
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
  Reader of(const char* key) const {
    if (!at(key).is_object()) fail(key, "is no object");
    return {at(key), file_};
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

ErrorPilot pilot_of(const Reader& in) {
  ErrorPilot pilot;
  pilot.needed = in.whole("needed");
  const Json& rounds = in.at("rounds");
  if (!rounds.is_array() || rounds.size() > 64) in.fail("rounds", "are no list");
  for (const Json& entry : rounds) {
    if (!entry.is_object()) in.fail("rounds", "has an entry that is no object");
    const Reader round(entry, in.file());
    ErrorPilot::Round r;
    r.samples = round.whole("samples");
    r.estimate.lit = round.flag("lit");
    r.estimate.relmse = round.real("relmse");
    r.estimate.spread = round.real("spread");
    r.estimate.pixels = round.real("pixels");
    pilot.rounds.push_back(r);
  }
  return pilot;
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

void read_state(const Reader& in, PictureParts parts, std::vector<Vec3d> before,
                RenderState& render_state) {
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
  const uint64_t size = in.whole("block_samples");
  if (size == 0) in.fail("block_samples", "is out of range");
  render_state.blocks = PictureBlocks(size, std::move(parts), std::move(before));
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
  Json target;
  if (render_state.target) target = json_of(*render_state.target);
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
              {"block_samples", render_state.blocks.size()}}
      .dump();
}

FilmBlocks blocks_of(const RenderState& render_state) {
  FilmBlocks blocks;
  for (const std::vector<Rgb>& pixels : render_state.blocks.blocks())
    blocks.blocks.push_back({render_state.film.width(), render_state.film.height(), pixels});
  blocks.before = render_state.blocks.before();
  return blocks;
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
    PictureParts parts;
    for (Picture& block : file.blocks.blocks) parts.push_back(std::move(block.pixels));
    read_state(Reader(json, name), std::move(parts), std::move(file.blocks.before), render_state);
  }
  const std::vector<SampleRange>& ranges = render_state.film.ranges();
  if (ranges.size() > 1 || (!ranges.empty() && ranges[0].first != render_state.first))
    throw InputError(name, "film",
                     "holds " + words_of(ranges) + ", which is no beginning to go on from");
  return render_state;
}

}  // namespace tdpt
