#include "tools/tdpt-render/path/walk.h"

namespace tdpt {
namespace {

enum class From { light, camera };

// Extends `walk`, whose last vertex is v, along unit w: first hit, its densities, and what the two
// vertices before it learn. pdf_own_A is set by `own_pdf_A(previous, hit)`.
template <class OwnPdf>
bool extend(const World& world, From from, const Vec3d& w, const Rgb& throughput, OwnPdf own_pdf_A,
            Walk& walk, RayCounts& rays) {
  const auto n = static_cast<size_t>(walk.size);
  Vertex& v = walk.v[n - 1];
  Hit hit;
  ++rays.closest;
  if (!world.tracer.closest(v.origin(), w, hit)) return false;
  Vertex& next = walk.v[n];
  next.position = hit.position;
  next.normal = hit.normal;
  next.triangle = hit.triangle;
  next.material = &world.scene.material_of(hit.triangle);
  next.throughput = throughput;
  next.pdf_own_A = own_pdf_A(v, next);
  next.pdf_other_A = 0;
  next.portal_density = 0;
  if (!(next.pdf_own_A > 0)) return false;
  if (n >= 2) walk.v[n - 2].pdf_other_A = scatter_pdf_A(next, v, walk.v[n - 2]);
  // The camera's own edge never counts: no technique puts a portal there.
  if (!world.portals.empty() && !(from == From::camera && n == 1)) {
    ++rays.portal;
    next.portal_density = from == From::light ? world.portals.density(v.position, next.position)
                                              : world.portals.density(next.position, v.position);
  }
  ++walk.size;
  return true;
}

void scatter(const World& world, From from, int edges, Rng& rng, Walk& walk, RayCounts& rays) {
  while (walk.size <= edges) {
    const Vertex& v = walk[walk.size - 1];
    const Vertex& previous = walk[walk.size - 2];
    const Rgb throughput = v.throughput * v.material->base_color;  // f cos / pdf_w
    if (max_component(throughput) <= 0) return;
    const double a = rng.uniform();
    const double b = rng.uniform();
    const bool front = dot(v.normal, previous.position - v.position) > 0;
    const Vec3d w =
        normalize(Onb<double>(front ? v.normal : -v.normal).to_world(cosine_hemisphere(a, b)));
    const auto pdf_A = [&](const Vertex& at, const Vertex& to) {
      return scatter_pdf_A(previous, at, to);
    };
    if (!extend(world, from, w, throughput, pdf_A, walk, rays)) return;
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
    const Vec3d d = to.position - at.position;
    return to_area(world.film.pdf_w(w), w, dot(d, d), to.normal);
  };
  if (extend(world, From::camera, w, Rgb(1.0f), pdf_A, walk, rays))
    scatter(world, From::camera, edges, rng, walk, rays);
}

void walk_from_light(const World& world, int edges, Rng rng, Walk& walk, RayCounts& rays) {
  walk.size = 0;
  if (world.emitters.empty()) return;
  const Emitters::Sample light = world.emitters.sample(rng);
  walk.size = 1;
  Vertex& y0 = walk.v[0];
  y0 = {};
  y0.position = light.position;
  y0.normal = world.tracer.shape(light.triangle).normal;
  y0.triangle = light.triangle;
  y0.material = &world.scene.material_of(light.triangle);
  y0.pdf_own_A = light.pdf_A;
  y0.throughput = Rgb(static_cast<float>(1 / light.pdf_A));
  if (edges < 1) return;
  const double a = rng.uniform();
  const double b = rng.uniform();
  const Vec3d w = normalize(Onb<double>(light.normal).to_world(cosine_hemisphere(a, b)));
  const double sides = y0.material->double_sided ? 2 : 1;  // cos / pdf_w = pi per side
  const Rgb throughput =
      y0.throughput * y0.material->emission * static_cast<float>(sides * std::numbers::pi);
  if (extend(world, From::light, w, throughput, emission_pdf_A, walk, rays))
    scatter(world, From::light, edges, rng, walk, rays);
}

}  // namespace tdpt
