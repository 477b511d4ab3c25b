#include "tools/tdpt-render/plan/portal_ways.h"

#include <algorithm>
#include <numeric>

#include "tools/tdpt-render/plan/portal_probe.h"

namespace tdpt {
namespace {

constexpr size_t kMostPortals = 16;
constexpr uint64_t kLeastSamples = 10;
constexpr double kLeastEnergy = 0.001;  // share of the picture's
constexpr double kEarnest = 0.2;        // share of the light through the portal
constexpr double kWideWay = 0.066;      // conductance
constexpr double kNoLight = 1e-4;       // share of the picture's without its brightest sample
constexpr uint64_t kEnoughLit = 100;    // samples

bool tells(const std::array<PassedLight, 2>& light) {
  return std::max(light[0].samples, light[1].samples) >= kLeastSamples;
}

}  // namespace

PortalWay::Way way_of(bool drawn_both_ways, const PassedLight& with, const PassedLight& against,
                      double total, bool wide) {
  const auto sure = [](const PassedLight& light) {
    return light.samples < kLeastSamples ? 0 : light.energy - light.brightest;
  };
  if (!(std::max(sure(with), sure(against)) > kLeastEnergy * total)) return PortalWay::as_drawn;
  const double least = kEarnest * (with.energy + against.energy);
  if (sure(against) > least && with.energy < least) return PortalWay::back;
  if (drawn_both_ways) {
    if (sure(with) > least && against.energy < least) return PortalWay::front;
    if (wide) return with.energy < against.energy ? PortalWay::back : PortalWay::front;
    return PortalWay::as_drawn;
  }
  return sure(against) > least && !wide ? PortalWay::both : PortalWay::as_drawn;
}

std::vector<PassedPortals::Opening> PassedPortals::openings(const std::vector<Portal>& portals,
                                                            const Frame& frame) {
  std::vector<Opening> openings;
  for (Portal portal : portals) {
    portal.both_ways = true;
    PortalSet both({portal}, frame);
    portal.both_ways = false;
    openings.push_back({PortalSet({portal}, frame), std::move(both)});
  }
  return openings;
}

PassedPortals::PassedPortals(const std::vector<Opening>& openings)
    : openings_(openings),
      ways_(openings.size()),
      either_(openings.size()),
      of_sample_(openings.size()) {}

void PassedPortals::see(const Path& path, double light) {
  if (path.k() < 2) return;
  total_ += light;
  sample_ += light;
  for (size_t p = 0; p < openings_.size(); ++p) {
    bool passes = false;
    for (int i = 0; i + 1 < path.k(); ++i) {
      const Vertex &a = path.vertex(i), &b = path.vertex(i + 1);
      const Vec3d from = a.at_infinity() ? before_the_scene(b.position, a.position) : a.position;
      if (!(openings_[p].both.density(from, b.position) > 0)) continue;
      passes = true;
      if (openings_[p].front.density(from, b.position) > 0) of_sample_[p][0] += light;
      if (openings_[p].front.density(b.position, from) > 0) of_sample_[p][1] += light;
    }
    if (passes) either_[p] += light;
  }
}

void PassedPortals::end_sample() {
  lit_ += sample_ > 0;
  brightest_ = std::max(brightest_, sample_);
  sample_ = 0;
  for (size_t p = 0; p < openings_.size(); ++p) {
    for (size_t way = 0; way < 2; ++way) {
      double& light = of_sample_[p][way];
      PassedLight& sum = ways_[p][way];
      sum.samples += light > 0;
      sum.energy += light;
      sum.brightest = std::max(sum.brightest, light);
      light = 0;
    }
  }
}

void PassedPortals::merge(const PassedPortals& other) {
  total_ += other.total_;
  lit_ += other.lit_;
  brightest_ = std::max(brightest_, other.brightest_);
  for (size_t p = 0; p < openings_.size(); ++p) {
    either_[p] += other.either_[p];
    for (size_t way = 0; way < 2; ++way) {
      PassedLight& sum = ways_[p][way];
      const PassedLight& part = other.ways_[p][way];
      sum.samples += part.samples;
      sum.energy += part.energy;
      sum.brightest = std::max(sum.brightest, part.brightest);
    }
  }
}

WayFinder::WayFinder(const std::vector<Portal>& portals)
    : portals_(portals),
      open_(std::min(portals.size(), kMostPortals)),
      ways_(portals.size()),
      dark_(portals.size()) {
  std::iota(open_.begin(), open_.end(), size_t{0});
  for (size_t i = 0; i < ways_.size(); ++i) ways_[i].portal = i;
}

std::vector<Portal> WayFinder::opened() const {
  std::vector<Portal> opened;
  for (const size_t i : open_) opened.emplace_back(portals_[i]).both_ways = true;
  return opened;
}

void WayFinder::learn(const PassedPortals& passed, const Vista& vista) {
  some_silent_ = false;
  if (vista.openings.portals.empty()) return;
  lit_ = std::max(lit_, passed.lit_);
  std::vector<size_t> silent;
  for (size_t k = 0; k < open_.size(); ++k) {
    const size_t i = open_[k];
    const auto& [with, against] = passed.ways_[k];
    const auto way = [&, &with = with, &against = against](bool wide) {
      return way_of(portals_[i].both_ways, with, against, passed.total_, wide);
    };
    // Conductance is probed only where it matters.
    const bool wide =
        way(true) != way(false) && probed_conductance(*vista.world, portals_[i]) > kWideWay;
    ways_[i].way = way(wide);
    dark_[i] = passed.either_[k] < kNoLight * (passed.total_ - passed.brightest_);
    if (!tells(passed.ways_[k])) silent.push_back(i);
  }
  some_silent_ = !silent.empty() && silent.size() < open_.size();
  open_ = std::move(silent);
}

std::vector<PortalWay> WayFinder::told() const {
  std::vector<PortalWay> ways = ways_;
  if (lit_ < kEnoughLit) return ways;
  for (size_t i = 0; i < ways.size(); ++i)
    if (dark_[i] || std::find(open_.begin(), open_.end(), i) != open_.end())
      ways[i].way = PortalWay::left_out;
  return ways;
}

void apply_ways(const std::vector<PortalWay>& ways, std::vector<Portal>& portals) {
  for (const PortalWay& w : ways) {
    Portal& portal = portals.at(w.portal);
    if (w.way == PortalWay::as_drawn) continue;
    if (w.way == PortalWay::left_out) {
      portal.figures.emplace("area", area_of(portal));
      portal.triangles.clear();
      continue;
    }
    portal.both_ways = w.way == PortalWay::both;
    if (w.way == PortalWay::back)
      for (auto& t : portal.triangles) std::swap(t[1], t[2]);
  }
}

}  // namespace tdpt
