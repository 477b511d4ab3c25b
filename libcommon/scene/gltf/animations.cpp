#include "libcommon/scene/gltf/animations.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "libcommon/scene/gltf/accessors.h"

namespace tdpt::gltf {
namespace {

using Json = nlohmann::json;

constexpr Numbers kTimes = {"times", 1, true, false, false, false};
constexpr Numbers kTranslations = {"translations", 3, true, false, false, false};
constexpr Numbers kRotations = {"rotations", 4, true, true, true, false};
constexpr Numbers kScales = {"scales", 3, true, false, false, false};
constexpr Numbers kWeights = {"weights", 1, true, true, true, false};

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
    for (const Json& a : d_.json.value("animations", Json::array())) {
      motion_.animations.push_back({a.value("name", ""), 0});
      for (const Json& c : a.value("channels", Json::array())) {
        const Json& target = c["target"];
        if (target["path"] == "pointer") {
          ++pointers_;
          continue;
        }
        move(target["node"].get<size_t>(), target["path"].get<std::string>(),
             a["samplers"][c["sampler"].get<size_t>()]);
      }
    }
    if (pointers_ > 0)
      motion_.warnings.push_back(counted(
          pointers_, "animation channel", "by KHR_animation_pointer is left out: it moves no node",
          "by KHR_animation_pointer are left out: they move no node"));
    if (matrices_ > 0)
      motion_.warnings.push_back(counted(matrices_, "animation channel",
                                         "moves a node that has a matrix, and is left out",
                                         "move nodes that have a matrix, and are left out"));
    return motion_;
  }

 private:
  void move(size_t index, const std::string& path, const Json& sampler) {
    tinygltf::Node& n = d_.model.nodes[index];
    if (path != "weights" && !n.matrix.empty()) {
      ++matrices_;
      return;
    }
    if (path == "weights" && n.mesh < 0) return;
    motion_.moves = true;
    double& last = motion_.animations.back().seconds;
    last = std::max(last, times_of(sampler["input"].get<size_t>()).back());
    if (path == "translation") n.translation = value(sampler, kTranslations, 1, linear);
    if (path == "rotation") n.rotation = value(sampler, kRotations, 1, spherical);
    if (path == "scale") n.scale = value(sampler, kScales, 1, linear);
    if (path == "weights") n.weights = value(sampler, kWeights, targets_of(n), linear);
  }

  /// The property at the time: `count` elements per key.
  Values value(const Json& sampler, const Numbers& numbers, size_t count,
               Values (*between)(const Values&, const Values&, double)) {
    const Values& times = times_of(sampler["input"].get<size_t>());
    const Between at = place_between(times, seconds_);
    const auto output = sampler["output"].get<size_t>();
    const bool spline = sampler["interpolation"] == "CUBICSPLINE";
    const size_t stored = spline ? 3 * count : count;
    if (const size_t there = d_.model.accessors[output].count;
        there / std::max<size_t>(stored, 1) < times.size())
      d_.fail(place("accessors", output), fmt::format("count is {}, expected at least {} {}", there,
                                                      times.size() * stored, numbers.noun));
    const auto key = [&](size_t k) {
      return read_numbers(d_, output, numbers, k * stored, stored);
    };
    const Values a = key(at.key);
    if (at.share == 0 || sampler["interpolation"] == "STEP") return spline ? middle(a) : a;
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
  size_t targets_of(const tinygltf::Node& n) const {
    size_t most = 0;
    for (const tinygltf::Primitive& p : d_.model.meshes[static_cast<size_t>(n.mesh)].primitives)
      most = std::max(most, p.targets.size());
    return most;
  }

  Document& d_;
  double seconds_;
  Motion motion_;
  std::map<size_t, Values> times_;  // by accessor: channels share them
  size_t pointers_ = 0, matrices_ = 0;
};

}  // namespace

Motion go_to(Document& d, double seconds) {
  return Animator(d, seconds).run();
}

}  // namespace tdpt::gltf
