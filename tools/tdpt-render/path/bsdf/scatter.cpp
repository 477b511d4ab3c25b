#include "tools/tdpt-render/path/bsdf/scatter.h"

#include "libcommon/math/warp.h"
#include "tools/tdpt-render/path/bsdf/coated.h"

namespace tdpt {
namespace {

template <class T>
T square(T x) {
  return x * x;
}

// Local directions; false when a direction lies above one normal and below the other.
bool to_shading_frame(const Point& v, const Vec3d& a, const Vec3d& b, Vec3d& la, Vec3d& lb) {
  const Onb<double> onb(v.shading);
  la = onb.to_local(a);
  lb = onb.to_local(b);
  return la.z * dot(v.normal, a) > 0 && lb.z * dot(v.normal, b) > 0;
}

}  // namespace

Rgb layered_bsdf(const Point& v, Vec3d to_light, Vec3d to_camera) {
  if (v.bsdf.coat) return coated::bsdf(v, to_light, to_camera);
  Vec3d l, c;
  if (!to_shading_frame(v, to_light, to_camera, l, c)) return {};
  return bsdf::f(v.bsdf, l, c) * static_cast<float>(square(v.bsdf.index(c)) * std::abs(l.z) /
                                                    std::abs(dot(v.normal, to_light)));
}

double layered_scatter_pdf_w(const Point& at, Vec3d back, Vec3d to, bool dirac) {
  if (at.bsdf.coat) return coated::scatter_pdf_w(at, back, to, dirac);
  Vec3d f, t;
  if (!to_shading_frame(at, back, to, f, t)) return 0;
  return dirac ? bsdf::dirac_probability(at.bsdf, f, t) * square(at.bsdf.index(t)) * std::abs(t.z)
               : bsdf::pdf_w(at.bsdf, f, t);
}

double emission_under_coat(const Point& p, Vec3d w) {
  return coated::of_emission(p, w);
}

namespace {

[[gnu::noinline]] bool layered_turn_towards(const Point& v, From from, const Vec3d& back,
                                            const Vec3d& w, Turn& out) {
  if (v.bsdf.coat) return coated::turn_towards(v, from, back, w, out);
  Vec3d local_back, to;
  if (!to_shading_frame(v, back, w, local_back, to)) return false;
  const double pdf_w = bsdf::pdf_w(v.bsdf, local_back, to);
  if (!(pdf_w > 0)) return false;
  const Rgb f = from == From::camera ? layered_bsdf(v, w, back) : layered_bsdf(v, back, w);
  out.weight = f * static_cast<float>(std::abs(dot(v.normal, w)) / pdf_w);
  return true;
}

[[gnu::noinline]] bool layered_turn(const Point& v, From from, const Vec3d& back,
                                    const std::array<double, 3>& u, Turn& out) {
  if (v.bsdf.coat) return coated::turn(v, from, back, u, out);
  const auto [a, b, choice] = u;
  const Onb<double> onb(v.shading);
  const Vec3d local_back = onb.to_local(back);
  if (!(local_back.z * dot(v.normal, back) > 0)) return false;
  bsdf::Scattered scattered;
  if (!bsdf::sample(v.bsdf, local_back, choice, a, b, scattered)) return false;
  const Vec3d& to = scattered.to;
  out.w = normalize(onb.to_world(to));
  out.dirac = scattered.dirac;
  const double cos_out = dot(v.normal, out.w);
  if (!(to.z * cos_out > 0)) return false;
  if (scattered.dirac) {
    // f = reflectance * n_c^2 |l.ns| / |l.ng| per n^2 |cos| dw; l towards the light, c the camera.
    const double p = bsdf::dirac_probability(v.bsdf, local_back, to);
    const double factor = from == From::camera
                              ? square(v.bsdf.index(local_back) / v.bsdf.index(to))
                              : std::abs(local_back.z * cos_out / (dot(v.normal, back) * to.z));
    out.weight = bsdf::dirac_reflectance(v.bsdf, local_back, to) * static_cast<float>(factor / p);
    return p > 0;
  }
  return layered_turn_towards(v, from, back, out.w, out);
}

}  // namespace

bool turn(const Point& v, From from, const Vec3d& back, const std::array<double, 3>& u, Turn& out) {
  out.dirac = false;
  if (!v.simple) return layered_turn(v, from, back, u, out);
  const bool front = dot(v.normal, back) > 0;
  out.weight = v.material->base_color;
  out.w = Onb<double>(front ? v.normal : -v.normal).to_world(cosine_hemisphere(u[0], u[1]));
  return true;
}

bool turn_towards(const Point& v, From from, const Vec3d& back, const Vec3d& w, Turn& out) {
  out.w = w;
  out.dirac = false;
  if (!v.simple) return layered_turn_towards(v, from, back, w, out);
  out.weight = v.material->base_color;
  return same_side(v, back, w);
}

Odds odds_of(const Bsdf& b, const Vec3d& from) {
  Odds out;
  out.dirac = bsdf::any_dirac_probability(b, from);
  if (out.dirac == 0 && b.alpha < kNarrow) out.broad = bsdf::diffuse_probability(b, from);
  return out;
}

Odds odds_of(const Point& p, const Vec3d& back) {
  if (p.bsdf.coat) return coated::odds(p, back);
  const Vec3d local = Onb<double>(p.shading).to_local(back);
  return local.z * dot(p.normal, back) > 0 ? odds_of(p.bsdf, local) : Odds{};
}

Rgb albedo_of(const Point& p, const Vec3d& back) {
  if (p.bsdf.coat) return coated::albedo(p, back);
  return bsdf::albedo(p.bsdf, Onb<double>(p.shading).to_local(back));
}

Rgb transmittance(const Point& a, const Point& b, const Vec3d& w, double d) {
  if (a.at_infinity() || b.at_infinity()) return Rgb(1.0f);  // the sun is in no solid
  const auto inside = [](const Point& v, const Vec3d& away) {
    return v.on_surface() && v.material->solid && max_component(v.material->absorption) > 0 &&
           dot(v.normal, away) < 0;
  };
  const Material* m = inside(a, w) ? a.material : inside(b, -w) ? b.material : nullptr;
  if (!m) return Rgb(1.0f);
  const auto share = [&](float absorption) {
    return static_cast<float>(std::exp(-double{absorption} * d));
  };
  return {share(m->absorption.x), share(m->absorption.y), share(m->absorption.z)};
}

}  // namespace tdpt
