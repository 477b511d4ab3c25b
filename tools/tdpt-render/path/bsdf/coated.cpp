#include "tools/tdpt-render/path/bsdf/coated.h"

namespace tdpt::coated {
namespace {

constexpr Vec3f kUpright{0, 0, 1};

double square(double x) {
  return x * x;
}

// The frames of a point: of what lies under the coat, and of the coat.
struct Frames {
  explicit Frames(const Point& p)
      : base(p.shading), coat(Vec3d(p.bsdf.coat.normal)), same(p.bsdf.coat.normal == kUpright) {}
  Vec3d coat_from_base(const Vec3d& w) const { return same ? w : coat.to_local(w); }
  Vec3d base_from_coat(const Vec3d& w) const { return same ? w : coat.to_world(w); }

  Onb<double> base, coat;  // of the world, and of the base
  bool same;
};

// A direction as both see it.
struct Seen {
  Seen(const Point& p, const Frames& frames, const Vec3d& w)
      : side(dot(p.normal, w)), base(frames.base.to_local(w)), coat(frames.coat_from_base(base)) {
    on_base = base.z * side > 0;
    const bool inside = side < 0 && p.bsdf.transmits() && !p.bsdf.thin;
    on_coat = coat.z * side > 0 && !inside;
    if (side < 0) coat.z = -coat.z;
  }

  double side;       // cosine to the geometric normal
  Vec3d base, coat;  // the latter mirrored to the front
  bool on_base, on_coat;
};

bool both_on_base(const Seen& a, const Seen& b) {
  return a.on_base && b.on_base;
}
bool both_on_coat(const Seen& a, const Seen& b) {
  return a.on_coat && b.on_coat && a.side * b.side > 0;
}

double sum(const Rgb& c) {
  return double{c.x} + c.y + c.z;
}

// That the coat is taken, in proportion to what it reflects and what else leaves.
double coat_probability(const Bsdf& b, const Seen& from) {
  if (!from.on_coat) return 0;
  if (!from.on_base) return 1;
  // Facets reflect more than their mean at some angles.
  const double e = 1 - coat::left_over(b.coat, from.coat.z) + 0.02 * b.coat.strength;
  return 3 * e / (3 * e + sum(bsdf::albedo(b, from.base)));
}

// Which of the two leads from `back` to `to`. Where both are smooth, both do if their normals are
// the same; else the one whose normal is nearer to the half vector.
Dirac dirac(const Bsdf& b, const Frames& frames, const Seen& back, const Seen& to) {
  const double p = coat_probability(b, back);
  Dirac base, top;
  if (both_on_base(back, to)) {
    base.probability = (1 - p) * bsdf::dirac_probability(b, back.base, to.base);
    base.reflectance = bsdf::dirac_reflectance(b, back.base, to.base);
    base.cos_to = to.base.z, base.cos_back = back.base.z;
    base.n_to = b.index(to.base), base.n_back = b.index(back.base);
  }
  if (!coat::smooth(b.coat) || !both_on_coat(back, to)) return base;
  top.probability = p;
  top.reflectance = Rgb(static_cast<float>(coat::reflectance(b.coat, back.coat.z)));
  top.cos_to = to.coat.z, top.cos_back = back.coat.z;
  if (!(base.probability > 0)) return top;
  if (frames.same) {
    base.probability += top.probability;
    base.reflectance += top.reflectance;
    return base;
  }
  const Vec3d h = back.base + to.base, n(b.coat.normal);
  return std::abs(dot(h, n)) > std::abs(h.z) ? top : base;
}

Rgb bsdf(const Point& p, const Seen& l, const Seen& c) {
  Rgb out{};
  const double side = std::abs(l.side);
  if (both_on_base(l, c))
    out += bsdf::f(p.bsdf, l.base, c.base) *
           static_cast<float>(square(p.bsdf.index(c.base)) * std::abs(l.base.z) / side);
  if (both_on_coat(l, c))
    out += Rgb(static_cast<float>(coat::f(p.bsdf.coat, l.coat, c.coat) * l.coat.z / side));
  return out;
}

double rough_pdf_w(const Bsdf& b, const Seen& back, const Seen& to) {
  const double p = coat_probability(b, back);
  double pdf = 0;
  if (both_on_coat(back, to)) pdf += p * coat::pdf_w(b.coat, back.coat, to.coat);
  if (both_on_base(back, to)) pdf += (1 - p) * bsdf::pdf_w(b, back.base, to.base);
  return pdf;
}

bool weigh(const Point& p, From from, const Seen& back, const Seen& to, Turn& out) {
  const double pdf_w = rough_pdf_w(p.bsdf, back, to);
  if (!(pdf_w > 0)) return false;
  const Rgb f = from == From::camera ? bsdf(p, to, back) : bsdf(p, back, to);
  out.weight = f * static_cast<float>(std::abs(to.side) / pdf_w);
  return true;
}

}  // namespace

Rgb bsdf(const Point& p, const Vec3d& to_light, const Vec3d& to_camera) {
  const Frames frames(p);
  return bsdf(p, Seen(p, frames, to_light), Seen(p, frames, to_camera));
}

double scatter_pdf_w(const Point& at, const Vec3d& back, const Vec3d& to, bool by_dirac) {
  const Frames frames(at);
  const Seen from(at, frames, back), next(at, frames, to);
  if (!by_dirac) return rough_pdf_w(at.bsdf, from, next);
  const Dirac d = dirac(at.bsdf, frames, from, next);
  return d.probability * square(d.n_to) * std::abs(d.cos_to);
}

Dirac dirac(const Point& p, const Vec3d& back, const Vec3d& to) {
  const Frames frames(p);
  return dirac(p.bsdf, frames, Seen(p, frames, back), Seen(p, frames, to));
}

bool turn_towards(const Point& p, From from, const Vec3d& back, const Vec3d& w, Turn& out) {
  const Frames frames(p);
  return weigh(p, from, Seen(p, frames, back), Seen(p, frames, w), out);
}

bool turn(const Point& p, From from, const Vec3d& back, const std::array<double, 3>& u, Turn& out) {
  const auto [a, b, choice] = u;
  const Frames frames(p);
  const Seen here(p, frames, back);
  const double take = coat_probability(p.bsdf, here);
  const bool by_coat = choice < take;
  bsdf::Scattered s;
  if (by_coat) {
    if (!coat::sample(p.bsdf.coat, here.coat, a, b, s.to)) return false;
    if (here.side < 0) s.to.z = -s.to.z;
    s.to = frames.base_from_coat(s.to);
    s.dirac = coat::smooth(p.bsdf.coat);
  } else if (!here.on_base ||
             !bsdf::sample(p.bsdf, here.base, (choice - take) / (1 - take), a, b, s)) {
    return false;
  }
  out.w = normalize(frames.base.to_world(s.to));
  out.dirac = s.dirac;
  const Seen next(p, frames, out.w);
  // Bent normals may send it to a side where the lobe that it comes from is not seen.
  if (!(by_coat ? both_on_coat(here, next) : next.on_base)) return false;
  if (!s.dirac) return weigh(p, from, here, next, out);
  const Dirac d = dirac(p.bsdf, frames, here, next);
  if (!(d.probability > 0)) return false;
  const double factor = from == From::camera
                            ? square(d.n_back / d.n_to)
                            : std::abs(d.cos_back * next.side / (here.side * d.cos_to));
  out.weight = d.reflectance * static_cast<float>(factor / d.probability);
  return true;
}

Rgb albedo(const Point& p, const Vec3d& back) {
  const Seen here(p, Frames(p), back);
  Rgb out{};
  if (here.on_base) out += bsdf::albedo(p.bsdf, here.base);
  if (here.on_coat) out += Rgb(static_cast<float>(1 - coat::left_over(p.bsdf.coat, here.coat.z)));
  return out;
}

Odds odds(const Point& p, const Vec3d& back) {
  const Seen here(p, Frames(p), back);
  const double take = coat_probability(p.bsdf, here);
  Odds out;
  if (here.on_base) out = odds_of(p.bsdf, here.base);
  const bool smooth = coat::smooth(p.bsdf.coat), broad = p.bsdf.coat.alpha >= kNarrow;
  out.dirac = (1 - take) * out.dirac + (smooth ? take : 0);
  out.broad = (1 - take) * out.broad + (broad ? take : 0);
  if (out.dirac > 0) out.broad = 1;
  return out;
}

double of_emission(const Point& p, const Vec3d& w) {
  return coat::left_over(p.bsdf.coat, Seen(p, Frames(p), w).coat.z);
}

}  // namespace tdpt::coated
