#include "tools/tdpt-render/plan.h"

#include <algorithm>
#include <array>

#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "tools/tdpt-render/path/light_pool.h"

namespace tdpt {
namespace {

// By PortalWay::Way.
constexpr std::array kWays{"as drawn", "front", "back", "both", "left out"};

// A value of the plan, checked on the way in.
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

std::string plan_text(const Plan& plan) {
  auto ways = nlohmann::ordered_json::array();
  for (const PortalWay& w : plan.ways)
    ways.push_back({{"portal", w.portal}, {"way", kWays[static_cast<size_t>(w.way)]}});
  const Mixture& m = plan.integrator.mixture;
  return nlohmann::ordered_json{{"integrator", plan.integrator.name},
                                {"stream", plan.integrator.stream},
                                {"label", plan.label},
                                {"first_direct", m.first_direct},
                                {"later_direct", m.later_direct},
                                {"segments", m.segments},
                                {"light_walks", m.light_walks},
                                {"joined", m.joined},
                                {"joined_to_segments", m.joined_to_segments},
                                {"segments_joined", m.segments_joined},
                                {"guide_light", m.guiding.chance[0]},
                                {"guide_camera", m.guiding.chance[1]},
                                {"through_windows", m.through_windows},
                                {"spp", plan.spp},
                                {"portals", ways},
                                {"surfaces", plan.lights.surfaces},
                                {"lamps", plan.lights.lamps},
                                {"parallel", plan.lights.parallel},
                                {"sky", plan.lights.sky}}
      .dump();
}

Plan read_plan(const std::string& text, const std::string& file) {
  const nlohmann::json from = nlohmann::json::parse(text, nullptr, false);
  if (!from.is_object()) throw InputError(file, "", "is no JSON object, expected a plan");
  const Reader in(from, file);
  Plan plan;
  const Integrator* row = find_integrator(in.get<std::string>("integrator"));
  if (!row) in.fail("integrator", "is not known");
  plan.integrator = *row;
  plan.integrator.stream = in.get<uint64_t>("stream");
  if (plan.integrator.stream >= kStreams) in.fail("stream", "is out of range");
  plan.label = in.get<std::string>("label");
  Mixture& m = plan.integrator.mixture;
  m.first_direct = in.within("first_direct", 1e-3, 1e3);
  m.later_direct = in.within("later_direct", 1e-3, 1e3);
  m.segments = in.within("segments", 0.01, 1);
  m.light_walks = in.within("light_walks", kFewestLightWalks, 1);
  m.joined = in.within("joined", 1e-3, LightPool::kWalks);
  m.joined_to_segments = in.within("joined_to_segments", 1e-3, LightPool::kWalks);
  m.segments_joined = in.within("segments_joined", 1, LightPool::kWalks / kFewestLightWalks);
  m.guiding.chance = {in.within("guide_light", 0, 0.95), in.within("guide_camera", 0, 0.95)};
  m.through_windows = in.within("through_windows", 0, 0.95);
  plan.spp = in.get<uint64_t>("spp");
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
  return plan;
}

}  // namespace tdpt
