#include "libcommon/testing/houses/light_paths.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <sstream>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/film_plane.h"
#include "libcommon/scene/lights.h"
#include "libcommon/trace/tracer.h"

namespace tdpt::testing {
namespace {

constexpr uint64_t kPathStream = 0x7061'7468;
constexpr uint64_t kBlock = 4096;  // walks with a reservoir of their own
constexpr double kFar = 8;         // distance of the sky [scene sizes]

// One kept path per block would thin too much: a block keeps several, each by itself in proportion
// to luminance.
constexpr size_t kKeptPerBlock = 64;

struct Block {
  std::vector<LightPath> kept{kKeptPerBlock};
  double sum = 0, squares = 0;
};

class Walker {
 public:
  Walker(const Scene& scene, const Camera& camera)
      : scene_(scene), lights_(scene), tracer_(scene, camera.culls), film_(camera, 1600, 900) {}

  void walk(uint64_t index, int depth, Block& block) const {
    Rng rng(1, kPathStream, index);
    const double x = rng.uniform() * film_.width(), y = rng.uniform() * film_.height();
    Vec3d w = film_.direction(x, y);
    Hit hit;
    if (!tracer_.first_seen(film_.position(), w, hit)) return;
    LightPath corners;
    Rgb throughput(1.0f);
    for (int edges = 2; edges <= depth; ++edges) {
      const Vec3d normal = dot(hit.normal, w) > 0 ? -hit.normal : hit.normal;
      corners.push_back(hit.position);
      const Material& m = scene_.material_of(hit.triangle);
      throughput = throughput * m.base_color * (1 - m.metallic);
      add_next_event({hit.position, normal}, throughput, corners, rng, block);
      const double u = rng.uniform(), v = rng.uniform();
      w = Onb<double>(normal).to_world(cosine_hemisphere(u, v));
      if (luminance(throughput) <= 0 || !tracer_.closest({hit.position, normal}, w, hit)) return;
    }
  }

 private:
  void add_next_event(const Tracer::Origin& at, const Rgb& throughput, const LightPath& corners,
                      Rng& rng, Block& block) const {
    const Lights::Point p = selection_.sample(rng);
    if (!p.source) return;
    Vec3d towards, end;
    double per_pdf;  // cosine at the light / d^2 / density
    if (p.source->at_infinity()) {
      towards = -p.position;
      per_pdf = 1 / p.pdf;
      end = at.position + towards * kFar;
    } else {
      const Vec3d d = p.position - at.position;
      const double d2 = dot(d, d);
      if (!(d2 > 0)) return;
      towards = d / std::sqrt(d2);
      const double cos = p.source->is_surface() ? -dot(p.normal, towards) : 1;
      if (!(cos > 0)) return;
      per_pdf = cos / d2 / p.pdf;
      end = p.position;
    }
    const double cos = dot(at.normal, towards);
    if (!(cos > 0)) return;
    const Rgb radiance = p.source->is_surface() ? scene_.material_of(p.triangle).emission : Rgb{};
    const Vec3d front = p.source->is_surface() ? tracer_.shape(p.triangle).normal : Vec3d{};
    const Rgb emitted = p.source->emitted(front, radiance, -towards);
    // A side of a surface that emits on both is drawn half the time [Lights::Point::normal].
    const double sides = p.source->is_surface() && p.source->both_sides() ? 2 : 1;
    const double light =
        luminance(throughput * emitted) * cos * per_pdf * sides * std::numbers::inv_pi;
    if (!(light > 0) || !std::isfinite(light)) return;
    if (!tracer_.visible(at, {end, p.source->at_infinity() ? Vec3d{} : p.normal})) return;
    keep(light, corners, end, rng, block);
  }

  void keep(double light, const LightPath& corners, const Vec3d& end, Rng& rng,
            Block& block) const {
    block.sum += light;
    block.squares += light * light;
    for (LightPath& kept : block.kept) {
      if (rng.uniform() * block.sum >= light) continue;
      kept = {scene_.frame.to_metres(end)};
      for (auto c = corners.rbegin(); c != corners.rend(); ++c)
        kept.push_back(scene_.frame.to_metres(*c));
    }
  }

  const Scene& scene_;
  const Lights lights_;
  const LightSelection selection_{lights_};
  const Tracer tracer_;
  const FilmPlane film_;
};

}  // namespace

LightPaths light_paths(const Scene& scene, const Camera& camera, uint64_t walks, int depth,
                       size_t count) {
  const Walker walker(scene, camera);
  std::vector<Block> blocks((walks + kBlock - 1) / kBlock);
  tbb::parallel_for(size_t{0}, blocks.size(), [&](size_t b) {
    for (uint64_t i = b * kBlock; i < std::min((b + 1) * kBlock, walks); ++i)
      walker.walk(i, depth, blocks[b]);
  });
  LightPaths out;
  double total = 0, squares = 0;
  for (const Block& b : blocks) total += b.sum, squares += b.squares;
  if (!(total > 0)) return out;
  out.effective = total * total / squares;
  // Systematic resampling of blocks; within a block each kept path is a draw of its own.
  Rng rng(1, kPathStream + 1, 0);
  const double step = total / static_cast<double>(count), first = rng.uniform() * step;
  double before = 0, next = first;
  for (Block& b : blocks) {
    size_t used = 0;
    for (before += b.sum; next < before; next += step)
      out.paths.push_back(b.kept[used++ % kKeptPerBlock]);
  }
  return out;
}

std::string text_of(const LightPaths& paths) {
  std::string out = fmt::format("effective {}\n", paths.effective);
  for (const LightPath& path : paths.paths) {
    for (const Vec3d& p : path)
      fmt::format_to(std::back_inserter(out), "{:.5g} {:.5g} {:.5g} ", p.x, p.y, p.z);
    out.back() = '\n';
  }
  return out;
}

LightPaths read_light_paths(const std::string& file) {
  std::istringstream in(read_file(file));
  LightPaths paths;
  std::string word;
  if (!(in >> word >> paths.effective) || word != "effective")
    throw InputError(file, "", "expected light paths");
  for (std::string line; std::getline(in, line);) {
    std::istringstream numbers(line);
    LightPath path;
    for (Vec3d p; numbers >> p.x >> p.y >> p.z;) path.push_back(p);
    if (path.size() > 1) paths.paths.push_back(std::move(path));
  }
  return paths;
}

}  // namespace tdpt::testing
