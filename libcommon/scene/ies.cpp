#include "libcommon/scene/ies.h"

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <functional>
#include <numbers>

#include "libcommon/base/error.h"

namespace tdpt {
namespace {

using std::numbers::pi;
constexpr double kDegree = pi / 180;
constexpr double kClosest = 1e-4;  // angles [degrees] that differ less are equal to floats

struct IesReader {
  std::string_view text;
  const std::string &file, &place;
  size_t at = 0, line = 1;

  [[noreturn]] void fail(size_t on, const std::string& what) const {
    throw InputError(
        file, place.empty() ? fmt::format("{}", on) : fmt::format("{}, line {}", place, on), what);
  }
  [[noreturn]] void fail(const std::string& what) const { fail(line, what); }

  std::string_view next_line() {
    const size_t end = std::min(text.find_first_of("\r\n", at), text.size());
    const std::string_view all = text.substr(at, end - at);
    at = end;
    return all;
  }
  void pass_line_end() {
    if (at < text.size() && text.substr(at).starts_with("\r\n")) ++at;
    if (at < text.size()) ++at, ++line;
  }
  double number(const char* what) {
    constexpr std::string_view kBetween = " \t,\r\n\v\f\x1a";
    while (at < text.size() && kBetween.find(text[at]) != kBetween.npos)
      if (text[at] == '\n' || text[at] == '\r')
        pass_line_end();
      else
        ++at;
    const size_t end = std::min(text.find_first_of(kBetween, at), text.size());
    std::string_view word = text.substr(at, end - at);
    if (word.empty()) fail(fmt::format("ends before its {}", what));
    at = end;
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || stop != word.data() + word.size() || !std::isfinite(value))
      fail(fmt::format("has no number among its {}", what));
    return value;
  }
  double number(const char* what, double low, double high) {
    const double value = number(what);
    if (!(value >= low && value <= high))
      fail(fmt::format("{}: {}, expected {} to {}", what, value, low, high));
    return value;
  }
  // A number of values, bounded by the text's length: each takes a character and a separator.
  size_t count(const char* what, size_t least) {
    const auto most = static_cast<double>(text.size());
    const double value = number(what, static_cast<double>(least), most);
    if (value != std::floor(value)) fail(fmt::format("{}: {}, expected an integer", what, value));
    return static_cast<size_t>(value);
  }
  std::vector<double> angles(const char* what, size_t n, double low, double high) {
    std::vector<double> all;
    while (all.size() < n) {
      all.push_back(number(what, low, high));
      if (all.size() > 1 && !(all.back() >= all[all.size() - 2] + kClosest))
        fail(fmt::format("{}: {} follows {}, expected angles that ascend", what, all.back(),
                         all[all.size() - 2]));
    }
    return all;
  }
};

/// Rows: vertical angles. Columns: horizontal angles [degrees].
struct Web {
  std::vector<double> rows, columns;
  std::vector<double> values;  // column by column
  double at(size_t row, size_t column) const { return values[column * rows.size() + row]; }
};

// Completes the circle from a quarter, a half, or all but the last column.
Web all_around(const IesReader& in, const Web& web) {
  if (web.columns.size() == 1) return web;
  const double first = web.columns.front(), last = web.columns.back();
  const bool side = first == 90 && last == 270;
  if (!side && (first != 0 || (last < 180 && last != 90)))
    in.fail(
        fmt::format("horizontal angles go from {} to {}, expected 0 to 90, 180 or 360, or 90 "
                    "to 270",
                    first, last));
  std::vector<std::pair<double, size_t>> columns;
  for (size_t c = 0; c < web.columns.size(); ++c) {
    const double a = web.columns[c];
    columns.emplace_back(a, c);
    if (side) columns.emplace_back(a <= 180 ? 180 - a : 540 - a, c);
    if (!side && last <= 180) columns.emplace_back(360 - a, c);
    if (last == 90) columns.emplace_back(180 - a, c), columns.emplace_back(180 + a, c);
  }
  std::sort(columns.begin(), columns.end());
  Web out{web.rows, {}, {}};
  const auto add = [&](double angle, const auto& value) {
    if (!out.columns.empty() && angle < out.columns.back() + kClosest) return;
    out.columns.push_back(angle);
    for (size_t r = 0; r < web.rows.size(); ++r) out.values.push_back(value(r));
  };
  // 0 is 360, and mostly lies between two columns.
  const auto [begin, from] = columns.front();
  const auto [end, to] = columns.back();
  const double share = (360 - end) / (begin + 360 - end);
  const auto at_zero = [&, f = from, t = to](size_t r) {
    return web.at(r, t) + share * (web.at(r, f) - web.at(r, t));
  };
  if (begin >= kClosest) add(0, at_zero);
  for (const auto& [angle, c] : columns) add(angle, [&, k = c](size_t r) { return web.at(r, k); });
  add(360, at_zero);
  return out;
}

Web read_web(IesReader& in, bool has_lamp_factor, LightProfile& profile) {
  const auto vertical = in.count("number of vertical angles", 2);
  const auto horizontal = in.count("number of horizontal angles", 1);
  if (const double type = in.number("photometric type"); type != 1)
    in.fail(fmt::format("photometric type: {}, expected 1, a goniophotometer of type C", type));
  for (const char* name : {"units", "width", "length", "height"}) in.number(name);
  profile.peak *= in.number("ballast factor", kLeastIntensity, kMostIntensity);
  const double lamp = in.number("ballast-lamp factor");
  if (has_lamp_factor && lamp > 0) profile.peak *= lamp;
  in.number("watts");
  Web web;
  web.rows = in.angles("vertical angles", vertical, 0, 180);
  web.columns = in.angles("horizontal angles", horizontal, 0, 360);
  for (size_t i = 0; i < vertical * horizontal; ++i)
    web.values.push_back(in.number("intensities", 0, kMostIntensity));
  const double greatest = *std::max_element(web.values.begin(), web.values.end());
  profile.peak *= greatest;
  if (greatest > 0)
    for (double& value : web.values) value /= greatest;
  return all_around(in, web);
}

// Integral over directions between two rows and two columns, whose horizontal angles differ by
// `across`.
double part_of_ring(const Web& web, size_t r, double across,
                    const std::function<double(size_t)>& value) {
  const double a = web.rows[r] * kDegree, b = web.rows[r + 1] * kDegree;
  // Integrals of sin, and of sin times the interpolation parameter from a to b.
  const double all = std::cos(a) - std::cos(b);
  const double upper = (std::sin(b) - std::sin(a)) / (b - a) - std::cos(b);
  return across * (value(r) * (all - upper) + value(r + 1) * upper);
}

// Integral over directions between a row and the next.
double light_of_ring(const Web& web, size_t r) {
  if (web.columns.size() == 1)
    return part_of_ring(web, r, 2 * pi, [&](size_t i) { return web.at(i, 0); });
  double sum = 0;
  for (size_t c = 0; c + 1 < web.columns.size(); ++c)
    sum += part_of_ring(web, r, (web.columns[c + 1] - web.columns[c]) * kDegree,
                        [&](size_t i) { return 0.5 * (web.at(i, c) + web.at(i, c + 1)); });
  return sum;
}

// The angle of the first row after the last that is not dark.
double reach_of(const Web& web) {
  size_t last = 0;
  for (size_t c = 0; c < web.columns.size(); ++c)
    for (size_t r = 0; r < web.rows.size(); ++r)
      if (web.at(r, c) > 0) last = std::max(last, r);
  return web.rows[std::min(last + 1, web.rows.size() - 1)] * kDegree;
}

double versine(double degrees) {
  const double s = std::sin(0.5 * degrees * kDegree);
  return 2 * s * s;
}

// Importance sampling of light walks by rings between rows. The densities belong to exactly these
// floats.
struct Rings {
  std::vector<float> edges, before, densities;
};
// In proportion to light, except for a tenth that is uniform within reach: if one column is bright
// and the others are dark, a ring's mean says little about a direction.
Rings rings_of(const Web& web, double reach) {
  constexpr double kEven = 0.1;
  const size_t n = web.rows.size() - 1;
  std::vector<double> shares(n);
  double light = 0;
  for (size_t r = 0; r < n; ++r) light += shares[r] = light_of_ring(web, r);
  const double all = versine(reach / kDegree) - versine(web.rows[0]);
  Rings rings;
  for (size_t r = 0; r <= n; ++r) rings.edges.push_back(static_cast<float>(versine(web.rows[r])));
  for (size_t r = 0; r < n; ++r) {
    const bool within = web.rows[r] * kDegree < reach;
    const double wide = versine(web.rows[r + 1]) - versine(web.rows[r]);
    shares[r] = (1 - kEven) * shares[r] / light + (within ? kEven * wide / all : 0);
  }
  // Near the back pole two rows may have equal floats.
  for (size_t r = n; r-- > 0;)
    rings.edges[r] = std::min(rings.edges[r], std::nextafter(rings.edges[r + 1], 0.0f));
  double before = 0;
  for (size_t r = 0; r < n; ++r)
    rings.before.push_back(static_cast<float>(before)), before += shares[r];
  rings.before.push_back(1);
  for (size_t r = 0; r < n; ++r) {
    const double share = double{rings.before[r + 1]} - rings.before[r];
    const double wide = double{rings.edges[r + 1]} - rings.edges[r];
    rings.densities.push_back(share > 0 ? static_cast<float>(share / (2 * pi * wide)) : 0);
  }
  return rings;
}

}  // namespace

LightProfile read_ies(std::string_view text, const std::string& file, const std::string& place) {
  IesReader in{text, file, place};
  std::string_view line = in.next_line();
  // In later files this field has another meaning.
  const bool has_lamp_factor =
      line.find("LM-63-1995") == line.npos && line.find("LM-63-20") == line.npos;
  const auto is_tilt = [&] {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    return line.starts_with("TILT=");
  };
  while (!is_tilt()) {
    if (in.at == text.size()) in.fail(1, "is no IES file: no line begins with TILT=");
    in.pass_line_end();
    line = in.next_line();
  }
  if (line.starts_with("TILT=INCLUDE")) {
    in.number("lamp's place in the luminaire");
    for (size_t n = 2 * in.count("number of tilts", 0); n > 0; --n) in.number("tilts");
  }
  in.number("number of lamps");
  in.number("lumens");
  LightProfile profile;
  profile.peak = in.number("multiplier", kLeastIntensity, kMostIntensity);
  const Web web = read_web(in, has_lamp_factor, profile);
  if (!(profile.peak >= kLeastIntensity)) {
    profile.peak = 0;
    return profile;
  }
  profile.reach = reach_of(web);
  double light = 0;
  for (size_t r = 0; r + 1 < web.rows.size(); ++r) light += light_of_ring(web, r);
  profile.mean = light / (2 * pi * versine(profile.reach / kDegree));
  const auto add = [&](double x) {
    profile.words.push_back(std::bit_cast<uint32_t>(static_cast<float>(x)));
  };
  profile.words = {static_cast<uint32_t>(web.rows.size()),
                   static_cast<uint32_t>(web.columns.size())};
  for (const double angle : web.rows) add(angle / 360);
  for (const double angle : web.columns) add(angle / 360);
  for (const double value : web.values) add(value);
  const Rings rings = rings_of(web, profile.reach);
  for (const auto* numbers : {&rings.edges, &rings.before, &rings.densities})
    for (const float x : *numbers) add(x);
  return profile;
}

}  // namespace tdpt
