#include "tools/tdpt-render/plan/plan.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/json_depth.h"
#include "libcommon/formats/format_version.h"
#include "libcommon/options/shot_options.h"
#include "tools/tdpt-render/path/sample/light_vertex_cache.h"

namespace tdpt {
namespace {

constexpr uint64_t kMostSamples = uint64_t{1} << 32;  // as --spp

// Indexed by PortalWay::Way.
constexpr std::array kWays{"as drawn", "front", "back", "both", "left out"};

// A value of the plan; every access checks it.
class Reader {
 public:
  Reader(const nlohmann::json& from, const std::string& file) : from_(from), file_(file) {}

  template <class T>
  T get(const char* key) const {
    const auto at = from_.find(key);
    if (at == from_.end()) fail(key, "is missing");
    const bool fits = std::is_same_v<T, std::string> ? at->is_string()
                      : std::is_integral_v<T>        ? at->is_number_unsigned()
                                                     : at->is_number();
    if (!fits) fail(key, std::is_same_v<T, std::string> ? "is no string" : "is no such number");
    return at->get<T>();
  }
  double within(const char* key, double lowest, double highest) const {
    const double value = get<double>(key);
    if (!(value >= lowest && value <= highest)) fail(key, "is out of range");
    return value;
  }
  [[noreturn]] void fail(const char* key, const std::string& what) const {
    throw InputError(file_, key, what);
  }

 private:
  const nlohmann::json& from_;
  const std::string& file_;
};

}  // namespace

bool operator==(const Plan& a, const Plan& b) {
  return std::string(a.integrator.name) == b.integrator.name &&
         a.integrator.stream == b.integrator.stream &&
         a.integrator.mixture == b.integrator.mixture && a.label == b.label && a.spp == b.spp &&
         a.ways == b.ways && a.lights == b.lights;
}

namespace {

nlohmann::ordered_json json_of(const Plan& plan) {
  auto ways = nlohmann::ordered_json::array();
  for (const PortalWay& w : plan.ways)
    ways.push_back({{"portal", w.portal}, {"way", kWays[static_cast<size_t>(w.way)]}});
  const Mixture& m = plan.integrator.mixture;
  nlohmann::ordered_json all{{"integrator", plan.integrator.name},
                             {"stream", plan.integrator.stream},
                             {"label", plan.label},
                             {"first_direct", m.first_direct},
                             {"later_direct", m.later_direct},
                             {"segments", m.segments},
                             {"light_walks", m.light_walks},
                             {"connected", m.connected},
                             {"connected_to_segments", m.connected_to_segments},
                             {"segments_connected", m.segments_connected},
                             {"guide_light", m.guiding.chance[0]},
                             {"guide_camera", m.guiding.chance[1]},
                             {"through_windows", m.through_windows},
                             {"spp", plan.spp},
                             {"portals", ways},
                             {"surfaces", plan.lights.surfaces},
                             {"lamps", plan.lights.lamps},
                             {"parallel", plan.lights.parallel},
                             {"sky", plan.lights.sky}};
  if (const auto& b = plan.beyond)
    all["beyond"] = {{"depth", b->depth}, {"share", b->share}, {"error", b->error}};
  return all;
}

}  // namespace

std::string plan_text(const Plan& plan) {
  return json_of(plan).dump();
}

Plan read_plan(const std::string& text, const std::string& file) {
  const nlohmann::json from =
      nested_too_deep(text) ? nlohmann::json() : nlohmann::json::parse(text, nullptr, false);
  if (!from.is_object()) throw InputError(file, "", "is no JSON object, expected a plan");
  const Reader in(from, file);
  Plan plan;
  const Integrator* row = find_integrator(in.get<std::string>("integrator"));
  if (!row) in.fail("integrator", "is not known");
  plan.integrator = *row;
  plan.integrator.stream = in.get<uint64_t>("stream");
  if (plan.integrator.stream == 0 || plan.integrator.stream >= kStreams)
    in.fail("stream", "is out of range");
  plan.label = in.get<std::string>("label");
  Mixture& m = plan.integrator.mixture;
  m.first_direct = in.within("first_direct", 1e-3, 1e3);
  m.later_direct = in.within("later_direct", 1e-3, 1e3);
  m.segments = in.within("segments", 0.01, 1);
  m.light_walks = in.within("light_walks", kFewestLightWalks, 1);
  m.connected = in.within("connected", 1e-3, LightVertexCache::kWalks);
  m.connected_to_segments = in.within("connected_to_segments", 1e-3, LightVertexCache::kWalks);
  m.segments_connected =
      in.within("segments_connected", 1, LightVertexCache::kWalks / kFewestLightWalks);
  m.guiding.chance = {in.within("guide_light", 0, 0.95), in.within("guide_camera", 0, 0.95)};
  m.through_windows = in.within("through_windows", 0, 0.95);
  plan.spp = in.get<uint64_t>("spp");
  if (plan.spp > kMostSamples) in.fail("spp", "is out of range");
  const auto ways = from.find("portals");
  if (ways == from.end() || !ways->is_array()) in.fail("portals", "is no list");
  for (const nlohmann::json& entry : *ways) {
    if (!entry.is_object()) in.fail("portals", "has an entry that is no object");
    const Reader of_portal(entry, file);
    const auto way = std::find(kWays.begin(), kWays.end(), of_portal.get<std::string>("way"));
    if (way == kWays.end()) of_portal.fail("way", "is not known");
    plan.ways.push_back({static_cast<size_t>(of_portal.get<uint64_t>("portal")),
                         static_cast<PortalWay::Way>(way - kWays.begin())});
  }
  plan.lights = {in.within("surfaces", 0, 1), in.within("lamps", 0, 1), in.within("parallel", 0, 1),
                 in.within("sky", 0, 1)};
  if (const auto beyond = from.find("beyond"); beyond != from.end()) {
    if (!beyond->is_object()) in.fail("beyond", "is no object");
    const Reader of(*beyond, file);
    plan.beyond = {static_cast<int>(of.within("depth", 1, kMaxDepth)), of.within("share", 0, 1),
                   of.within("error", 0, 1e3)};
  }
  const Lights::KindProbabilities& s = plan.lights;
  const double sum = s.surfaces + s.lamps + s.parallel + s.sky;
  if (sum != 0 && std::abs(sum - 1) > 1e-9)
    in.fail("surfaces", "and the other shares add up to no 1");
  return plan;
}

std::string plan_file_text(const PlanFile& file) {
  auto shape = nlohmann::ordered_json::object();
  for (const auto& [name, value] : file.shape) shape[name] = value;
  nlohmann::ordered_json all{{"format", format_version::plan}};
  if (file.frames.empty()) all["plan"] = json_of(file.plan);
  for (const auto& [frame, plan] : file.frames)
    all["frames"].push_back({{"frame", frame}, {"plan", json_of(plan)}});
  all["shape"] = shape;
  all["command"] = file.command;
  return all.dump(2) + "\n";
}

const Plan& PlanFile::of_frame(int64_t frame) const {
  std::vector<int64_t> keys;
  for (const auto& [key, planned] : frames) keys.push_back(key);
  return frames.at(nearest_key(keys, frame));
}

namespace {

std::map<int64_t, Plan> read_frames(const nlohmann::ordered_json& list, const std::string& file) {
  std::map<int64_t, Plan> frames;
  if (!list.is_array() || list.empty()) throw InputError(file, "frames", "is no list of plans");
  for (const auto& entry : list) {
    if (!entry.is_object() || !entry.contains("frame") || !entry["frame"].is_number_unsigned() ||
        !entry.contains("plan"))
      throw InputError(file, "frames", "has an entry without a frame or without a plan");
    const auto frame = entry["frame"].get<uint64_t>();
    if (frame > kLastFrame || frames.contains(static_cast<int64_t>(frame)))
      throw InputError(file, "frames",
                       fmt::format("has frame {} twice, or none can have it", frame));
    frames[static_cast<int64_t>(frame)] = read_plan(entry["plan"].dump(), file);
  }
  return frames;
}

}  // namespace

PlanFile read_plan_file(const std::string& path) {
  const std::string name = display_name(path);
  const std::string text_of_file = read_file(path);
  const auto from = nested_too_deep(text_of_file)
                        ? nlohmann::ordered_json()
                        : nlohmann::ordered_json::parse(text_of_file, nullptr, false);
  if (!from.is_object() || from.contains("plan") == from.contains("frames"))
    throw InputError(name, "", "is no plan, expected one from --plan");
  const auto version = from.find("format");
  check_version(name, "format", version == from.end() ? "" : version->dump(), format_version::plan);
  PlanFile file;
  if (from.contains("plan"))
    file.plan = read_plan(from["plan"].dump(), name);
  else
    file.frames = read_frames(from["frames"], name);
  const auto text = [&](const char* key, const nlohmann::ordered_json& value) {
    if (!value.is_string()) throw InputError(name, key, "is no string");
    return value.get<std::string>();
  };
  file.command = text("command", from.value("command", nlohmann::ordered_json()));
  const auto shape = from.find("shape");
  if (shape == from.end() || !shape->is_object()) throw InputError(name, "shape", "is no object");
  for (const auto& [key, value] : shape->items())
    file.shape.emplace_back(key, text("shape", value));
  return file;
}

}  // namespace tdpt
