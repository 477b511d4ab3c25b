#include "tools/tdpt-render/path/sample/connect.h"

namespace tdpt {
namespace {

// What `end` carries and scatters, or emits, along unit w.
Rgb towards(const End& end, const Vec3d& w, From from) {
  if (!end.layered) return end.carried;
  if (end.back == Vec3d()) return end.carried * emitted(*end.vertex, w);
  return end.carried * (from == From::light ? bsdf_at(*end.vertex, end.back, w)
                                            : bsdf_at(*end.vertex, w, end.back));
}

}  // namespace

Rgb connect_layered(const World& world, const End& l, const End& c) {
  const Edge e = between(*l.vertex, *c.vertex);
  const Rgb sent = towards(l, e.w, From::light);
  if (sent == Rgb{}) return {};
  const Rgb value =
      sent * towards(c, -e.w, From::camera) * static_cast<float>(geometry(*l.vertex, *c.vertex, e));
  return world.absorbing ? value * transmittance(*l.vertex, *c.vertex, e.w, std::sqrt(e.d2))
                         : value;
}

}  // namespace tdpt

// Compiled for the machine's instruction set; products are never fused with sums
// (-ffp-contract=off), so that results agree. clang cannot clone templates.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define TDPT_WIDE [[gnu::target_clones("default", "avx2")]]
#else
#define TDPT_WIDE
#endif
#define TDPT_INLINE [[gnu::always_inline]] inline

namespace tdpt {

// The values of Colour for one end.
struct Ends::Gloss {
  float of[kColours]{};

  explicit Gloss(const End& end) {
    const auto put = [&](Colour at, const Vec3f& v) {
      of[at] = v.x, of[at + 1] = v.y, of[at + 2] = v.z;
    };
    of[alpha2] = of[cosine] = 1;
    put(normal_x, Vec3f(end.facing));
    put(back_x, Vec3f(end.facing));
    if (!end.layered) put(red, end.carried);
    if (!end.opaque) return;
    const Vertex& v = *end.vertex;
    const Bsdf& b = v.bsdf;
    const double cos = dot(v.shading, end.back);
    put(normal_x, Vec3f(cos < 0 ? -v.shading : v.shading));
    put(back_x, Vec3f(end.back));
    of[cosine] = std::max(static_cast<float>(std::abs(cos)), kGrazing);
    const Rgb left = max(Rgb(1.0f) - b.f0, Rgb(0.05f));
    // Rough estimate of the layers above: a term estimated as 0 is never chosen.
    const Rgb above = b.sheen * 0.3f + Rgb(0.1f * b.coat.strength);
    put(red, end.carried * (b.diffuse * left + above) * static_cast<float>(std::numbers::inv_pi));
    of[alpha2] = std::max(b.alpha * b.alpha, kMirror);
    put(f0_red, end.carried * b.f0);
    put(f90_red, end.carried * (Rgb(b.f90) - b.f0));
  }
  static constexpr float kGrazing = 1e-3f, kMirror = 1e-6f;
};

namespace {

struct Way {
  double x, y, z, d2, g;  // g: the geometry term G
  double sent, met;       // positive if the end faces the other
};

// The same as connect.h, branch-free.
template <class L>
TDPT_INLINE Way way(const L& l, int i, const Vec3d& at, const Vec3d& facing) {
  Way w;
  w.x = at.x - l.place[Ends::x][i], w.y = at.y - l.place[Ends::y][i],
  w.z = at.z - l.place[Ends::z][i];
  const double sent = l.place[Ends::facing_x][i] * w.x + l.place[Ends::facing_y][i] * w.y +
                      l.place[Ends::facing_z][i] * w.z;
  const double met = -(facing.x * w.x + facing.y * w.y + facing.z * w.z);
  w.d2 = w.x * w.x + w.y * w.y + w.z * w.z;
  w.g = sent * met / (w.d2 * w.d2);
  w.sent = sent, w.met = met;
  return w;
}

template <class L>
TDPT_INLINE double brought(const L& l, int i, float r, float g, float b) {
  r = r * l.colour[Ends::light_red][i], g = g * l.colour[Ends::light_green][i],
  b = b * l.colour[Ends::light_blue][i];
  return static_cast<double>(0.2126f * r + 0.7152f * g + 0.0722f * b);
}

template <class L>
TDPT_INLINE double estimate_simple(const L& l, int i, const Vec3d& at, const Vec3d& facing,
                                   const Rgb& carried) {
  const Way w = way(l, i, at, facing);
  const auto g = static_cast<float>(((w.sent > 0) & (w.met > 0)) ? w.g : 0.0);
  return brought(l, i, l.colour[Ends::red][i] * carried.x * g,
                 l.colour[Ends::green][i] * carried.y * g, l.colour[Ends::blue][i] * carried.z * g);
}

struct Colours {
  float r, g, b;
};

TDPT_INLINE float most(float a, float b) {
  return a > b ? a : b;
}

// Scattering of an end along unit w: its diffuse lobe and that of the interface
// [shaders/shared/path/microfacet.h]. `at(c)`: its column c.
template <class At>
TDPT_INLINE Colours scattered(const At& at, float x, float y, float z) {
  const float hx = at(Ends::back_x) + x, hy = at(Ends::back_y) + y, hz = at(Ends::back_z) + z;
  const float scale = 1 / std::sqrt(hx * hx + hy * hy + hz * hz + 1e-12f);
  const float cos_h =
      (at(Ends::normal_x) * hx + at(Ends::normal_y) * hy + at(Ends::normal_z) * hz) * scale;
  const float cos_d =
      (at(Ends::back_x) * hx + at(Ends::back_y) * hy + at(Ends::back_z) * hz) * scale;
  const float cos_w = most(at(Ends::normal_x) * x + at(Ends::normal_y) * y + at(Ends::normal_z) * z,
                           1e-3f),
              cos_b = at(Ends::cosine);
  const float a2 = at(Ends::alpha2);
  const float s = most(cos_h * cos_h * (a2 - 1) + 1, a2);
  const float d = a2 / (s * s);
  const float v = 1 / (cos_w * std::sqrt(a2 + (1 - a2) * cos_b * cos_b) +
                       cos_b * std::sqrt(a2 + (1 - a2) * cos_w * cos_w));
  const float lobe = d * v * static_cast<float>(0.5 * std::numbers::inv_pi);
  const float m = most(1 - cos_d, 0.0f), m2 = m * m, schlick = m2 * m2 * m;
  return {at(Ends::red) + (at(Ends::f0_red) + at(Ends::f90_red) * schlick) * lobe,
          at(Ends::green) + (at(Ends::f0_green) + at(Ends::f90_green) * schlick) * lobe,
          at(Ends::blue) + (at(Ends::f0_blue) + at(Ends::f90_blue) * schlick) * lobe};
}

template <class L, class C>
TDPT_INLINE double estimate_glossy(const L& l, int i, const Vec3d& at, const Vec3d& facing,
                                   const C& c) {
  const Way w = way(l, i, at, facing);
  const double scale = 1 / std::sqrt(w.d2);
  const auto x = static_cast<float>(w.x * scale), y = static_cast<float>(w.y * scale),
             z = static_cast<float>(w.z * scale);
  const Colours sent = scattered([&](Ends::Colour k) { return l.colour[k][i]; }, x, y, z);
  const Colours met = scattered([&](Ends::Colour k) { return c.of[k]; }, -x, -y, -z);
  const auto g = static_cast<float>(((w.sent > 0) & (w.met > 0)) ? w.g : 0.0);
  // If both ends coincide the direction is undefined.
  const double value = brought(l, i, sent.r * met.r * g, sent.g * met.g * g, sent.b * met.b * g);
  return ((w.sent > 0) & (w.met > 0)) ? value : 0.0;
}

// n: a multiple of kLanes, so that no remainder is left.
template <class L>
TDPT_WIDE void simple_columns(const L l, int n, const Vec3d at, const Vec3d facing,
                              const Rgb carried, double* __restrict out) {
  for (int i = 0; i < n; ++i) out[i] = estimate_simple(l, i, at, facing, carried);
}
template <class L>
TDPT_WIDE void simple_chosen(const L l, const int* __restrict chosen, const Vec3d at,
                             const Vec3d facing, const Rgb carried, double* __restrict out) {
  for (int i = 0; i < Ends::kLanes; ++i)
    out[i] = estimate_simple(l, chosen[i], at, facing, carried);
}
template <class L, class C>
TDPT_WIDE void glossy_columns(const L l, int n, const Vec3d at, const Vec3d facing, const C c,
                              double* __restrict out) {
  for (int i = 0; i < n; ++i) out[i] = estimate_glossy(l, i, at, facing, c);
}
template <class L, class C>
TDPT_WIDE void glossy_chosen(const L l, const int* __restrict chosen, const Vec3d at,
                             const Vec3d facing, const C c, double* __restrict out) {
  for (int i = 0; i < Ends::kLanes; ++i) out[i] = estimate_glossy(l, chosen[i], at, facing, c);
}

}  // namespace

void Ends::make_place() {
  const size_t n = 2 * place_[0].size() + 2 * kLanes;
  for (size_t k = 0; k < kPlaces; ++k) {
    place_[k].resize(n);
    columns_.place[k] = place_[k].data();
  }
  for (size_t k = 0; k < kColours; ++k) {
    colour_[k].resize(n);
    columns_.colour[k] = colour_[k].data();
  }
}

void Ends::add(const End& end) {
  if (size_ == place_[0].size()) make_place();
  const Vec3d &p = end.position, &facing = end.facing;
  place_[x][size_] = p.x, place_[y][size_] = p.y, place_[z][size_] = p.z;
  place_[facing_x][size_] = facing.x;
  place_[facing_y][size_] = facing.y;
  place_[facing_z][size_] = facing.z;
  const Gloss gloss(end);
  for (size_t k = 0; k < kColours; ++k) colour_[k][size_] = gloss.of[k];
  glossy_ |= end.layered && end.opaque;
  ++size_;
}

void Ends::set_light(size_t i, const Rgb& light) {
  colour_[light_red][i] = light.x;
  colour_[light_green][i] = light.y;
  colour_[light_blue][i] = light.z;
}

void Ends::estimate(const End& c, double* out) const {
  const int n = static_cast<int>(room(size_));
  if (glossy_ || c.layered)
    glossy_columns(columns_, n, c.position, c.facing, Gloss(c), out);
  else
    simple_columns(columns_, n, c.position, c.facing, c.carried, out);
}

void Ends::estimate(const End& c, const std::array<int, kLanes>& chosen, double* out) const {
  if (glossy_ || c.layered)
    glossy_chosen(columns_, chosen.data(), c.position, c.facing, Gloss(c), out);
  else
    simple_chosen(columns_, chosen.data(), c.position, c.facing, c.carried, out);
}

}  // namespace tdpt
