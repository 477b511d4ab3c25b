#include "libcommon/scene/ies.h"

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>

#include "libcommon/base/error.h"
#include "libcommon/math/vec.h"

namespace tdpt {
namespace {

using std::numbers::pi;
constexpr double kDegree = pi / 180;
constexpr double kClosest = 1e-4;  // angles [degrees], which floats tell apart
constexpr double kLeast = 1e-30, kMost = 1e30;

struct Reader {
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
  // So many numbers are there: each takes a character and one between.
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

/// Rows: vertical angles. Columns: horizontal ones [degrees].
struct Web {
  std::vector<double> rows, columns;
  std::vector<double> values;  // column by column
  double at(size_t row, size_t column) const { return values[column * rows.size() + row]; }
};

// Linear in both angles; 0 outside.
double value_at(const Web& web, double vertical, double horizontal) {
  const auto interval = [](const std::vector<double>& angles, double a) {
    const auto above = std::upper_bound(angles.begin(), angles.end() - 1, a);
    return static_cast<size_t>(std::max<std::ptrdiff_t>(above - angles.begin(), 1)) - 1;
  };
  const auto outside = [](const std::vector<double>& angles, double a) {
    return a < angles.front() - 1e-9 || a > angles.back() + 1e-9;
  };
  if (outside(web.rows, vertical)) return 0;
  const size_t r = interval(web.rows, vertical);
  const double t = std::clamp((vertical - web.rows[r]) / (web.rows[r + 1] - web.rows[r]), 0.0, 1.0);
  const auto in_column = [&](size_t c) { return std::lerp(web.at(r, c), web.at(r + 1, c), t); };
  if (web.columns.size() == 1) return in_column(0);
  if (outside(web.columns, horizontal)) return 0;
  const size_t c = interval(web.columns, horizontal);
  const double u =
      std::clamp((horizontal - web.columns[c]) / (web.columns[c + 1] - web.columns[c]), 0.0, 1.0);
  return std::lerp(in_column(c), in_column(c + 1), u);
}

// A web of another kind at the places of one of type C: `angles_of` tells where there a direction
// is, z along the aim.
Web as_type_c(const Web& web,
              const std::function<void(const Vec3d&, double&, double&)>& angles_of) {
  double step = 1;
  for (const std::vector<double>* angles : {&web.rows, &web.columns})
    for (size_t i = 1; i < angles->size(); ++i)
      step = std::min(step, (*angles)[i] - (*angles)[i - 1]);
  const int n = static_cast<int>(std::ceil(90 / std::max(step, 0.25)));
  Web out;
  for (int r = 0; r <= n; ++r) out.rows.push_back(90.0 * r / n);
  for (int c = 0; c <= 4 * n; ++c) out.columns.push_back(90.0 * c / n);
  for (const double column : out.columns)
    for (const double row : out.rows) {
      const double s = std::sin(row * kDegree);
      double vertical = 0, horizontal = 0;
      angles_of(
          {s * std::cos(column * kDegree), s * std::sin(column * kDegree), std::cos(row * kDegree)},
          vertical, horizontal);
      // Half of what lies evenly to both sides may be left out.
      if (web.rows.front() >= 0) vertical = std::abs(vertical);
      if (web.columns.front() >= 0) horizontal = std::abs(horizontal);
      out.values.push_back(value_at(web, vertical / kDegree, horizontal / kDegree));
    }
  return out;
}

// All around from a quarter, a half, or all but the last column.
Web all_around(const Reader& in, const Web& web) {
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
    if (a == 0 || (side && a == 180)) columns.emplace_back(360, c);
  }
  std::sort(columns.begin(), columns.end());
  Web out{web.rows, {}, {}};
  for (const auto& [angle, c] : columns) {
    if (!out.columns.empty() && angle < out.columns.back() + kClosest) continue;
    out.columns.push_back(angle);
    for (size_t r = 0; r < web.rows.size(); ++r) out.values.push_back(web.at(r, c));
  }
  return out;
}

Web read_web(Reader& in) {
  constexpr size_t kWithoutEnd = 1;
  const auto vertical = in.count("number of vertical angles", 2);
  const auto horizontal = in.count("number of horizontal angles", kWithoutEnd);
  const double type = in.number("photometric type", 1, 3);
  for (const char* name : {"units", "width", "length", "height"}) in.number(name);
  const double ballast = in.number("ballast factor", kLeast, kMost);
  const double lamp = in.number("ballast-lamp factor", 0, kMost);  // of no use since 1991
  in.number("watts");
  Web web;
  web.rows = in.angles("vertical angles", vertical, type == 1 ? 0 : -90, type == 1 ? 180 : 90);
  web.columns =
      in.angles("horizontal angles", horizontal, type == 1 ? 0 : -90, type == 1 ? 360 : 90);
  for (size_t i = 0; i < vertical * horizontal; ++i)
    web.values.push_back(in.number("intensities", 0, kMost) * ballast * (lamp > 0 ? lamp : 1));
  if (type == 1) return all_around(in, web);
  if (type == 2)
    return as_type_c(web, [](const Vec3d& d, double& v, double& h) {
      v = std::atan2(d.x, d.z), h = std::asin(std::clamp(-d.y, -1.0, 1.0));
    });
  return as_type_c(web, [](const Vec3d& d, double& v, double& h) {
    v = std::asin(std::clamp(d.x, -1.0, 1.0)), h = std::atan2(-d.y, d.z);
  });
}

// Over directions between two rows and two columns, whose horizontal angles differ by `across`.
double part_of_ring(const Web& web, size_t r, double across,
                    const std::function<double(size_t)>& value) {
  const double a = web.rows[r] * kDegree, b = web.rows[r + 1] * kDegree;
  // Of sin, and of sin times the share of the way from a to b.
  const double all = std::cos(a) - std::cos(b);
  const double upper = (std::sin(b) - std::sin(a)) / (b - a) - std::cos(b);
  return across * (value(r) * (all - upper) + value(r + 1) * upper);
}

// Over directions between a row and the next.
double light_of_ring(const Web& web, size_t r) {
  if (web.columns.size() == 1)
    return part_of_ring(web, r, 2 * pi, [&](size_t i) { return web.at(i, 0); });
  double sum = 0;
  for (size_t c = 0; c + 1 < web.columns.size(); ++c)
    sum += part_of_ring(web, r, (web.columns[c + 1] - web.columns[c]) * kDegree,
                        [&](size_t i) { return 0.5 * (web.at(i, c) + web.at(i, c + 1)); });
  return sum;
}

// The last row but those that are dark, and one of these.
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

struct Ring {
  double solid_angle, share;  // of the walks that leave
};
// In proportion to light, but for a tenth, which leaves evenly within reach: where one column is
// bright and the others are dark, light is not what a ring has on average.
std::vector<Ring> rings_of(const Web& web, double reach) {
  constexpr double kEven = 0.1;
  std::vector<Ring> rings;
  double light = 0, solid_angle = 0;
  for (size_t r = 0; r + 1 < web.rows.size(); ++r) {
    const double all = 2 * pi * (versine(web.rows[r + 1]) - versine(web.rows[r]));
    const bool within = web.rows[r] * kDegree < reach;
    rings.push_back({all, within ? light_of_ring(web, r) : 0});
    light += rings.back().share;
    if (within) solid_angle += all;
  }
  for (size_t r = 0; r < rings.size(); ++r)
    rings[r].share =
        (1 - kEven) * rings[r].share / light +
        (web.rows[r] * kDegree < reach ? kEven * rings[r].solid_angle / solid_angle : 0);
  return rings;
}

}  // namespace

LightProfile read_ies(std::string_view text, const std::string& file, const std::string& place) {
  Reader in{text, file, place};
  std::string_view line;
  while (!(line = in.next_line()).starts_with("TILT=")) {
    if (in.at == text.size()) in.fail(1, "is no IES file: no line begins with TILT=");
    in.pass_line_end();
  }
  if (line.starts_with("TILT=INCLUDE")) {
    in.number("lamp's place in the luminaire");
    for (size_t n = 2 * in.count("number of tilts", 0); n > 0; --n) in.number("tilts");
  }
  in.number("number of lamps");
  in.number("lumens");
  const double multiplier = in.number("multiplier", kLeast, kMost);
  const Web web = read_web(in);
  LightProfile profile;
  const double peak = *std::max_element(web.values.begin(), web.values.end());
  profile.peak = peak * multiplier;
  if (!(peak > 0)) return profile;
  profile.reach = reach_of(web);
  const std::vector<Ring> rings = rings_of(web, profile.reach);
  double light = 0;
  for (size_t r = 0; r < rings.size(); ++r) light += light_of_ring(web, r);
  profile.mean = light / peak / (2 * pi * (1 - std::cos(profile.reach)));
  const auto add = [&](double x) {
    profile.words.push_back(std::bit_cast<uint32_t>(static_cast<float>(x)));
  };
  profile.words = {static_cast<uint32_t>(web.rows.size()),
                   static_cast<uint32_t>(web.columns.size())};
  for (const double angle : web.rows) add(angle / 360);
  for (const double angle : web.columns) add(angle / 360);
  for (const double value : web.values) add(value / peak);
  for (const double angle : web.rows) add(versine(angle));
  double before = 0;
  for (const Ring& ring : rings) add(before), before += ring.share;
  add(1);
  for (const Ring& ring : rings) add(ring.share > 0 ? ring.share / ring.solid_angle : 0);
  return profile;
}

}  // namespace tdpt
