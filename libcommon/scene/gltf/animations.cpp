#include "libcommon/scene/gltf/nodes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "libcommon/scene/gltf/accessors.h"

namespace tdpt::gltf {
namespace {

constexpr Numbers kTimes = {"times", 1};
constexpr Numbers kWeights = {"weights", 1, Numbers::Kind::shares};

using Values = std::vector<double>;

/// The two keys around a time, and where it lies between them, in [0, 1].
struct Between {
  size_t key = 0;      ///< the earlier
  double share = 0;    ///< 0: at the earlier, which then is the only one
  double seconds = 0;  ///< from key to key
};

// Keys lie at floats, frames do not: a key that is as near as that is reached.
Between place_between(const Values& times, double seconds) {
  const double reached = seconds + 1e-7 * std::abs(seconds) + 1e-9;
  const auto after = std::upper_bound(times.begin(), times.end(), reached);
  if (after == times.begin()) return {};
  const auto key = static_cast<size_t>(after - times.begin()) - 1;
  if (after == times.end()) return {key};
  const double span = *after - times[key];
  return {key, std::max(0.0, (seconds - times[key]) / span), span};
}

/// a + (b - a) s: exactly a if both are equal.
Values linear(const Values& a, const Values& b, double s) {
  Values v(a.size());
  for (size_t i = 0; i < a.size(); ++i) v[i] = a[i] + (b[i] - a[i]) * s;
  return v;
}

/// Along the shorter arc between two rotations, at constant angular velocity.
Values spherical(const Values& a, const Values& b, double s) {
  const auto norm = [](const Values& q) {
    return std::sqrt(std::inner_product(q.begin(), q.end(), q.begin(), 0.0));
  };
  const double lengths = norm(a) * norm(b);
  double cosine = std::inner_product(a.begin(), a.end(), b.begin(), 0.0) / lengths;
  const double sign = cosine < 0 ? -1 : 1;
  cosine *= sign;
  // Where arc and chord are alike, or a rotation is 0, the weights are those of the chord.
  double of_a = 1 - s, of_b = sign * s;
  if (cosine < 0.999999) {
    const double angle = std::acos(cosine);
    of_a = std::sin((1 - s) * angle) / (std::sin(angle) * norm(a));
    of_b = sign * std::sin(s * angle) / (std::sin(angle) * norm(b));
  } else if (sign > 0) {
    return linear(a, b, s);
  }
  Values v(a.size());
  for (size_t i = 0; i < a.size(); ++i) v[i] = of_a * a[i] + of_b * b[i];
  return v;
}

/// Cubic Hermite spline. A key holds the tangent towards it, its value and the tangent from it, per
/// second; written so that equal values without tangents stay exactly what they are.
Values cubic(const Values& a, const Values& b, const Between& at) {
  const size_t n = a.size() / 3;
  const double s = at.share, square = s * s, cube = square * s;
  Values v(n);
  for (size_t i = 0; i < n; ++i)
    v[i] = a[n + i] + (b[n + i] - a[n + i]) * (3 * square - 2 * cube) +
           at.seconds * (a[2 * n + i] * (cube - 2 * square + s) + b[i] * (cube - square));
  return v;
}

class Animator {
 public:
  Animator(Document& d, double seconds) : d_(d), seconds_(seconds) {}

  Motion run() {
    for (const Animation& a : d_.animations) {
      motion_.animations.push_back({a.name, 0});
      for (const Channel& c : a.channels) move(c, motion_.animations.back().seconds);
    }
    return motion_;
  }

 private:
  /// `last`: when the animation ends.
  void move(const Channel& c, double& last) {
    Node& n = d_.nodes[c.node];
    motion_.moves = true;
    last = std::max(last, times_of(c.input).back());
    if (c.path == Channel::Path::weights) {
      n.weights = value(c, kWeights, targets_of(n), linear);
    } else if (c.path == Channel::Path::rotation) {
      const Values v = value(c, kRotations, 1, spherical);
      n.rotation = {v[0], v[1], v[2], v[3]};
    } else {
      const bool scales = c.path == Channel::Path::scale;
      const Values v = value(c, scales ? kScales : kTranslations, 1, linear);
      (scales ? n.scale : n.translation) = {v[0], v[1], v[2]};
    }
  }

  /// The property at the time: `count` elements per key.
  Values value(const Channel& c, const Numbers& numbers, size_t count,
               Values (*between)(const Values&, const Values&, double)) {
    const Values& times = times_of(c.input);
    const Between at = place_between(times, seconds_);
    const bool spline = c.way == Channel::Way::spline;
    const size_t stored = spline ? 3 * count : count;
    if (const size_t there = d_.accessors[c.output].count;
        there / std::max<size_t>(stored, 1) < times.size())
      d_.fail(place("accessors", c.output),
              fmt::format("count is {}, expected at least {} {}", there, times.size() * stored,
                          numbers.noun));
    const auto key = [&](size_t k) {
      return read_numbers(d_, c.output, numbers, k * stored, stored);
    };
    const Values a = key(at.key);
    if (at.share == 0 || c.way == Channel::Way::step) return spline ? middle(a) : a;
    return spline ? cubic(a, key(at.key + 1), at) : between(a, key(at.key + 1), at.share);
  }

  /// The value of a spline's key.
  static Values middle(const Values& key) {
    const auto third = static_cast<std::ptrdiff_t>(key.size() / 3);
    return {key.begin() + third, key.begin() + 2 * third};
  }

  const Values& times_of(size_t accessor) {
    const auto [it, is_new] = times_.try_emplace(accessor);
    Values& times = it->second;
    if (!is_new) return times;
    times = read_numbers(d_, accessor, kTimes);
    const auto back = std::is_sorted_until(times.begin(), times.end());
    if (back != times.end())
      d_.fail(place("accessors", accessor),
              fmt::format("key {} lies at {} s, before key {} at {} s, expected times in order",
                          back - times.begin(), *back, back - times.begin() - 1, *std::prev(back)));
    return times;
  }

  /// Number of morph targets of a node's mesh, the same for all its primitives.
  size_t targets_of(const Node& n) const {
    size_t most = 0;
    for (const Primitive& p : d_.meshes[n.mesh].primitives) most = std::max(most, p.targets.size());
    return most;
  }

  Document& d_;
  double seconds_;
  Motion motion_;
  std::map<size_t, Values> times_;  // by accessor: channels share them
};

using Moved = std::set<std::pair<size_t, Channel::Path>>;  // nodes and what moves of them

/// Reads the channels of an animation; leaves out those that move nothing, or what is `moved`.
void read_channels(Document& d, const Value& v, Moved& moved, Animation& out) {
  std::vector<Channel> samplers;  // without what they move
  for (const Value& s : v["samplers"].items())
    samplers.push_back({0,
                        {},
                        s["input"].needed().index("accessors"),
                        s["output"].needed().index("accessors"),
                        static_cast<Channel::Way>(
                            s["interpolation"].one_of({"LINEAR", "STEP", "CUBICSPLINE"}, 0))});
  const auto leave_out = [&](const char* which) {
    d.notes.add(fmt::format("channels {} are left out", which),
                fmt::format("animation \"{}\"", shown(out.name, 40)));
  };
  for (const Value& c : v["channels"].items()) {
    const Value target = c["target"].needed(), path = target["path"].needed();
    const size_t node = target["node"].index("nodes");
    Channel channel = samplers[c["sampler"].needed().index_below(samplers.size(), "samplers")];
    if (path.text() == "pointer") {
      leave_out("that move no node (KHR_animation_pointer)");
      continue;
    }
    channel.path =
        static_cast<Channel::Path>(path.one_of({"translation", "rotation", "scale", "weights"}, 0));
    if (node == kNone) continue;  // an extension says what it moves
    channel.node = node;
    const bool weights = channel.path == Channel::Path::weights;
    if (!moved.insert({node, channel.path}).second)
      leave_out("that move what another one moves (--animation names those that count)");
    else if (!weights && !d.nodes[node].matrix.empty())
      leave_out("of nodes that have a matrix");
    else if (!weights || d.nodes[node].mesh != kNone)
      out.channels.push_back(channel);
  }
}

}  // namespace

void read_animations(Document& d, const std::vector<std::string>& wanted) {
  const auto has = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const std::vector<Value> all = d.root()["animations"].items();
  DistinctNames distinct;
  std::vector<std::string> names;
  for (const Value& v : all) names.push_back(distinct.take(v["name"].text(), "", "animation"));
  for (const std::string& name : wanted)
    if (!has(names, name))
      d.fail("animations", names.empty() ? fmt::format("there is none, expected \"{}\"", name)
                                         : fmt::format("none is called \"{}\", expected one of {}",
                                                       name, fmt::join(names, ", ")));
  Moved moved;
  for (size_t i = 0; i < all.size(); ++i) {
    d.animations.push_back({names[i], {}});
    if (wanted.empty() || has(wanted, names[i]))
      read_channels(d, all[i], moved, d.animations.back());
  }
}

Motion go_to(Document& d, double seconds) {
  return Animator(d, seconds).run();
}

}  // namespace tdpt::gltf
