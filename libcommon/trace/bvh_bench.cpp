// Our BVH against Embree's: build time, and rays per second on one thread from surface points in
// random directions (closest hit, and visibility of another point). On the scenes given as
// arguments and on a generated one with a million triangles. Interleaved, best of a few rounds;
// counts answers that differ.
#include <chrono>
#include <cstdio>

#include "libcommon/math/rng.h"
#include "libcommon/testing/scalar_tracer.h"
#include "libcommon/trace/tracer.h"

namespace {
using namespace tdpt;

// Spheres of 20 000 triangles each in a closed room.
Scene spheres(uint32_t count) {
  Scene s;
  s.materials.resize(1);
  Rng rng(1, 0, 0);
  for (uint32_t k = 0; k <= count; ++k) {
    const double x = rng.uniform();
    const double y = rng.uniform();
    const double z = rng.uniform();
    const bool room = k == count;
    const Vec3d centre = room ? Vec3d() : Vec3d(x, y, z) * 1.2 - Vec3d(0.6);
    const double radius = room ? 1 : 0.05 + 0.15 * rng.uniform();
    constexpr uint32_t kRows = 101, kColumns = 100;
    const auto first = static_cast<uint32_t>(s.positions.size());
    for (uint32_t i = 0; i <= kRows; ++i)
      for (uint32_t j = 0; j < kColumns; ++j) {
        const double a = 3.14159265 * i / kRows, b = 6.2831853 * j / kColumns;
        s.positions.push_back(Vec3f(
            centre +
            Vec3d(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)) * radius));
      }
    for (uint32_t i = 0; i < kRows; ++i)
      for (uint32_t j = 0; j < kColumns; ++j) {
        const uint32_t a = first + i * kColumns + j, b = first + i * kColumns + (j + 1) % kColumns;
        if (i > 0) s.triangles.push_back({{a, a + kColumns, b}, 0});
        if (i + 1 < kRows) s.triangles.push_back({{b, a + kColumns, b + kColumns}, 0});
      }
  }
  return s;
}

template <class Work>
double seconds(Work work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void compare(const char* name, const Scene& scene) {
  constexpr int kRounds = 3;
  double own_build = 1e9, embree_build = 1e9;
  for (int round = 0; round < kRounds; ++round) {
    own_build = std::min(own_build, seconds([&] { build_bvh(scene); }));
    embree_build = std::min(embree_build, seconds([&] { Tracer{scene}; }));
  }
  std::printf("%s: %zu triangles\n", name, scene.triangles.size());
  std::printf("  build      ours %8.4f s       Embree %8.4f s       ratio %.2f\n", own_build,
              embree_build, own_build / embree_build);

  const Bvh bvh = build_bvh(scene);
  const shader::ScalarTracer own(bvh);
  const Tracer embree(scene);
  constexpr size_t kRays = 1 << 18;
  struct Query {
    Tracer::Origin from, to;
    Vec3d w;
  };
  std::vector<Query> queries(kRays);
  Rng rng(2, 0, 0);
  for (Query& q : queries) {
    for (Tracer::Origin* o : {&q.from, &q.to}) {
      const TriangleShape& s =
          embree.shape(rng.below(static_cast<uint32_t>(scene.triangles.size())));
      const double u = rng.uniform();
      const double v = rng.uniform();
      double b1, b2;
      uniform_triangle(u, v, b1, b2);
      *o = {s.p0 + s.e1 * b1 + s.e2 * b2, s.normal};
    }
    const double z = 2 * rng.uniform() - 1;
    const double phi = 6.283185307179586 * rng.uniform();
    const double r = std::sqrt(1 - z * z);
    q.w = {r * std::cos(phi), r * std::sin(phi), z};
  }
  const auto step = [](const Tracer::Origin& o, const Vec3d& w) {
    return Vec3f(o.position + o.normal * std::copysign(4 * 0x1p-23, dot(o.normal, w)));
  };
  std::vector<uint32_t> own_hit(kRays), embree_hit(kRays);
  std::vector<uint8_t> own_blocked(kRays), embree_blocked(kRays);
  double own_first = 1e9, embree_first = 1e9, own_any = 1e9, embree_any = 1e9;
  for (int round = 0; round < kRounds; ++round) {
    own_first = std::min(
        own_first, seconds([&] {
          for (size_t i = 0; i < kRays; ++i) {
            shader::SurfaceHit hit;
            const Query& q = queries[i];
            own_hit[i] = own.first_hit(step(q.from, q.w), Vec3f(q.w), 0, hit) ? hit.triangle : ~0u;
          }
        }));
    embree_first = std::min(
        embree_first, seconds([&] {
          for (size_t i = 0; i < kRays; ++i) {
            Hit hit;
            embree_hit[i] = embree.closest(queries[i].from, queries[i].w, hit) ? hit.triangle : ~0u;
          }
        }));
    own_any = std::min(own_any, seconds([&] {
                         for (size_t i = 0; i < kRays; ++i) {
                           const Query& q = queries[i];
                           const Vec3d w = q.to.position - q.from.position;
                           own_blocked[i] = own.segment_blocked(step(q.from, w), step(q.to, -w), 0);
                         }
                       }));
    embree_any = std::min(embree_any, seconds([&] {
                            for (size_t i = 0; i < kRays; ++i)
                              embree_blocked[i] = !embree.visible(queries[i].from, queries[i].to);
                          }));
  }
  size_t other_hit = 0, other_blocked = 0;
  for (size_t i = 0; i < kRays; ++i) {
    other_hit += own_hit[i] != embree_hit[i];
    other_blocked += own_blocked[i] != embree_blocked[i];
  }
  const auto line = [&](const char* what, double a, double b, size_t differ) {
    std::printf("  %-9s  ours %8.3f Mray/s  Embree %8.3f Mray/s  ratio %.2f  %zu of %zu differ\n",
                what, kRays / a * 1e-6, kRays / b * 1e-6, a / b, differ, kRays);
  };
  line("closest", own_first, embree_first, other_hit);
  line("occlusion", own_any, embree_any, other_blocked);
}
}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) compare(argv[i], read_gltf(argv[i]));
  compare("spheres", spheres(50));
}
