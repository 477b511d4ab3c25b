#include "tools/tdpt-render/path/walk.h"

#include "tools/tdpt-render/path/surface.h"

namespace tdpt {
namespace {

// Extends `walk`, whose last vertex is v, along unit w from `origin`: first hit, its densities, and
// what the two vertices before it learn. pdf_own_A is set by `own_pdf_A(previous, hit)`.
template <class OwnPdf>
bool extend(const World& world, From from, const Tracer::Origin& origin, const Vec3d& w,
            const Rgb& throughput, OwnPdf own_pdf_A, Walk& walk, RayCounts& rays) {
  const auto n = static_cast<size_t>(walk.size);
  Vertex& v = walk.v[n - 1];
  Hit hit;
  ++rays.closest;
  if (!world.tracer.closest(origin, w, hit)) return false;
  Vertex& next = walk.v[n];
  place_on_surface(world, hit, next);
  next.throughput = throughput * static_cast<float>(1 / hit.presence);
  next.pdf_own_A = own_pdf_A(v, next);
  next.pdf_other_A = 0;
  next.portal_density = 0;
  if (!(next.pdf_own_A > 0)) return false;
  if (world.absorbing) next.throughput = next.throughput * transmittance(v, next, w, hit.distance);
  if (n >= 2 && !walk.v[n - 2].lamp)  // no walk meets a lamp without surface
    walk.v[n - 2].pdf_other_A = scatter_pdf_A(next, v, walk.v[n - 2], v.dirac);
  // No technique puts a portal on the camera's own edge or on that of a lamp without surface.
  if (!world.portals.empty() && v.on_surface()) {
    ++rays.portal;
    next.portal_density = from == From::light ? world.portals.density(v.position, next.position)
                                              : world.portals.density(next.position, v.position);
  }
  ++walk.size;
  return true;
}

void scatter(const World& world, From from, int edges, Rng& rng, Walk& walk, RayCounts& rays) {
  while (walk.size <= edges) {
    Vertex& v = walk.v[static_cast<size_t>(walk.size) - 1];
    const Vertex& previous = walk[walk.size - 2];
    Turn t;
    if (!turn(v, from, between(v, previous).w, rng, t)) return;
    const Rgb throughput = v.throughput * t.weight;
    if (max_component(throughput) <= 0) return;
    v.dirac = t.dirac;
    const auto pdf_A = [&](const Vertex& at, const Vertex& to) {
      return scatter_pdf_A(previous, at, to, t.dirac);
    };
    if (!extend(world, from, v.origin(), t.w, throughput, pdf_A, walk, rays)) {
      v.dirac = false;
      return;
    }
  }
}

}  // namespace

void walk_from_camera(const World& world, double x, double y, int edges, Rng rng, Walk& walk,
                      RayCounts& rays) {
  walk.size = 1;
  Vertex& z0 = walk.v[0];
  z0 = {};
  z0.position = world.film.position();
  z0.pdf_own_A = 1;
  const Vec3d w = world.film.direction(x, y);
  const auto pdf_A = [&](const Vertex& at, const Vertex& to) {
    return to_area(world.film.pdf_w(w), {w, between(at, to).d2}, to);
  };
  if (extend(world, From::camera, z0.origin(), w, Rgb(1.0f), pdf_A, walk, rays))
    scatter(world, From::camera, edges, rng, walk, rays);
}

void walk_from_light(const World& world, int edges, Rng rng, Walk& walk, RayCounts& rays) {
  walk.size = 0;
  if (world.lights.empty()) return;
  const Lights::Point light = world.lights.sample(rng);
  walk.size = 1;
  Vertex& y0 = walk.v[0];
  place_on_light(world, light, y0);
  if (edges < 1) return;
  const double a = rng.uniform();
  const double b = rng.uniform();
  const Lights::Ray ray = world.lights.leave(light, a, b);
  // Le cos / pdf_w: pi per emitting side of a surface.
  const double sides = light.lamp ? 0 : y0.material->double_sided ? 2 : 1;
  const double per_density = light.lamp ? 1 / light.lamp->pdf : sides * std::numbers::pi;
  const Rgb throughput =
      y0.throughput * emitted(y0, ray.direction) * static_cast<float>(per_density);
  if (max_component(throughput) <= 0) return;
  const Tracer::Origin origin{ray.origin, y0.normal};
  if (extend(world, From::light, origin, ray.direction, throughput, emission_pdf_A, walk, rays))
    scatter(world, From::light, edges, rng, walk, rays);
}

}  // namespace tdpt
