#include "tools/ffgraph/light_flow.h"

#include <algorithm>
#include <cmath>

#include "libcommon/flow/potential_sweep.h"

namespace tdpt {
namespace {

// `hits_of_lamps`: of each patch, by walks that do not come from the sky.
FlowNetwork network_of(const LightFlow& f, const std::vector<double>& hits_of_lamps,
                       const std::vector<double>& sky_grade) {
  FlowNetwork net;
  net.nodes = static_cast<uint32_t>(f.patches.size() + 2 + f.file.more_sinks.size());
  net.source = 0;
  net.sink = 1;
  const auto add = [&net](uint32_t from, uint32_t to, double capacity) {
    if (const int64_t c = std::llround(capacity * kCapacityScale); c > 0)
      net.arcs.push_back({from, to, c});
  };
  const std::vector<double>& n = f.etendue.samples;
  const std::vector<double> from_light = terminal_grades(hits_of_lamps, n);
  std::vector<std::vector<double>> to_camera;
  for (size_t k = 0; k < f.lit.size(); ++k) {
    std::vector<double> hits;
    for (const PatchWalks& walks : f.file.walks) hits.push_back(walks.camera[k]);
    to_camera.push_back(terminal_grades(hits, n));
  }
  for (uint32_t i = 0; i < f.patches.size(); ++i) {
    const bool sky = f.patches.is_sky(i);
    add(net.source, i + 2, n[i] * (sky ? sky_grade[f.patches.bin_of(i)] : from_light[i]));
    for (size_t k = 0; k < to_camera.size(); ++k)
      if (f.lit[k])
        add(i + 2, k == 0 ? net.sink : f.file.more_sinks[k - 1], n[i] * to_camera[k][i]);
  }
  for (const Etendue::Pair& p : f.etendue.pairs) {
    add(p.i + 2, p.j + 2, 0.5 * p.count);
    add(p.j + 2, p.i + 2, 0.5 * p.count);
  }
  return net;
}

std::vector<Patch> geometry_of(const PatchMap& patches, const Fragments& fragments,
                               const Etendue& etendue) {
  std::vector<Patch> geometry(patches.size());
  std::vector<double> area(patches.size(), 0);
  for (uint32_t i = 0; i < patches.size(); ++i) {
    const PatchKey& key = patches.keys()[i];
    geometry[i].node = i + 3;
    geometry[i].samples = etendue.samples[i];
    if (patches.is_sky(i)) {
      geometry[i].sky = static_cast<int32_t>(patches.bin_of(i));
      continue;
    }
    geometry[i].level = key.level;
    geometry[i].cell = key.cell;
  }
  for (const Fragments::Fragment& f : fragments.all()) {
    Patch& p = geometry[f.patch];
    p.centre += f.centroid * f.area;
    p.normal += facing(patches.scene(), f.face).normal * f.area;
    p.faces.push_back(f.face);
    area[f.patch] += f.area;
  }
  for (uint32_t i = 0; i < patches.size(); ++i) {
    if (patches.is_sky(i)) continue;
    geometry[i].centre = patches.scene().frame.to_metres(geometry[i].centre / area[i]);
    geometry[i].normal = normalize(geometry[i].normal);
  }
  return geometry;
}

// Completes the patches of a walk's hits: by the `numbers` that they have now, and with its ends.
void number_trace(const PatchMap& patches, const Walks& walks, const std::vector<uint32_t>& numbers,
                  PatchTrace& trace) {
  for (size_t k = 0; k < walks.size(); ++k)
    if (walks[k].face == kWalkStopped)
      trace[k] = kTraceStopped;
    else if (to_sky(walks[k]))
      trace[k] = patches.find_sky(walks[k].face - kWalkToSky);
    else if (trace[k] != kNoPatch)
      trace[k] = numbers[trace[k]];
}

// Whether the light and each camera reach one room: some place that a light walk hit can be seen
// from one that a camera walk hit, both in one patch and lifted off their surfaces. That they
// share patches does not tell: a patch of the floor may reach under a closed door. `traces`: of the
// light's walks, then of each camera's.
std::vector<uint8_t> lit_cameras(const PatchMap& patches, const Tracer& tracer,
                                 const BothWalks& both, const std::vector<PatchTrace>& traces) {
  constexpr size_t kPlaces = 16;  // of a patch that are tried
  constexpr double kLift = 0.05;  // of its cell
  struct Lifted {
    Tracer::Origin place;
    Vec3d above;
  };
  const Scene& scene = patches.scene();
  const auto lifted = [&](const WalkHit& hit, uint32_t patch) -> Lifted {
    if (!is_hit(hit)) return {};
    const Vec3d normal = facing(scene, hit.face).normal;
    const double cell = std::ldexp(patches.grid().base_cell, -2 * patches.keys()[patch].level);
    const Vec3d place(hit.position);
    return {{place, normal}, place + normal * (kLift * cell * scene.frame.scale)};
  };
  const auto is_free = [&](const Lifted& l) { return tracer.visible(l.place, {l.above}); };

  std::vector<std::vector<Lifted>> lit(patches.size());
  for (size_t k = 0; k < traces[0].size(); ++k)
    if (const uint32_t p = traces[0][k]; p < lit.size() && lit[p].size() < kPlaces)
      lit[p].push_back(lifted(both.light.hits[k], p));
  std::vector<uint8_t> lit_camera(both.cameras.size(), 0);
  for (size_t c = 0; c < both.cameras.size(); ++c) {
    std::vector<uint8_t> tried(lit.size(), 0);
    for (size_t k = 0; k < both.cameras[c].size() && !lit_camera[c]; ++k) {
      const uint32_t p = traces[1 + c][k];
      if (p >= lit.size() || tried[p] == kPlaces) continue;
      ++tried[p];
      const Lifted from = lifted(both.cameras[c][k], p);
      lit_camera[c] =
          patches.is_sky(p) || std::any_of(lit[p].begin(), lit[p].end(), [&](const Lifted& place) {
            return is_free(from) && is_free(place) && tracer.visible({from.above}, {place.above});
          });
    }
  }
  return lit_camera;
}

// Calls visit(k, walk, first) for each hit k; first: of its walk.
template <class Visit>
void each_hit(const Walks& hits, const Visit& visit) {
  size_t walk = 0;
  for (size_t k = 0; k < hits.size(); ++k)
    if (is_hit(hits[k]))
      visit(k, walk, k == 0 || !is_hit(hits[k - 1]));
    else
      ++walk;
}

// What the walks say of each patch.
struct Counts {
  std::vector<PatchWalks> walks;
  std::vector<double> hits_of_lamps;  // by walks that do not come from the sky
  LightTerms terms;                   // without the albedo
};

// `traces`: of the light's walks, then of each camera's.
Counts count_walks(const PatchMap& patches, const BothWalks& both,
                   const std::vector<PatchTrace>& traces) {
  const size_t n = patches.size(), cameras = both.cameras.size();
  const std::vector<double> none(n, 0);
  Counts counts{std::vector(n, PatchWalks{0, 0, std::vector<double>(cameras, 0)}),
                none,
                {none, none, none, std::vector(cameras, none)}};
  const auto begin = [&](uint32_t patch, double power) {
    if (patch == kNoPatch) return;
    counts.walks[patch].begun += 1;
    counts.terms.emitted[patch] += power;
  };
  const LightWalks& light = both.light;
  for (size_t walk = 0; walk < light.start.size(); ++walk)
    if (const WalkHit& at = light.start[walk]; at.face != kNoFace)
      begin(patches.find(at.face, Vec3d(at.position)), light.power[walk]);
  each_hit(light.hits, [&](size_t k, size_t walk, bool first) {
    if (first && light.from_sky(walk)) begin(patches.find_sky(light.bin[walk]), light.power[walk]);
    const uint32_t p = traces[0][k];
    if (p >= n) return;
    counts.walks[p].light += 1;
    counts.hits_of_lamps[p] += !light.from_sky(walk);
    if (first) counts.terms.direct[p] += light.power[walk];
  });
  for (size_t c = 0; c < cameras; ++c)
    each_hit(both.cameras[c], [&](size_t k, size_t, bool first) {
      const uint32_t p = traces[1 + c][k];
      if (p >= n) return;
      counts.walks[p].camera[c] += 1;
      counts.terms.seen[c][p] += first;
    });
  return counts;
}

}  // namespace

LightFlow light_flow(PatchMap patches, const BothWalks& both, const Tracer& tracer, uint64_t seed,
                     uint32_t rays) {
  LightFlow f{std::move(patches), {}, {}, {}};
  const Scene& scene = f.patches.scene();
  std::vector<const Walks*> all{&both.light.hits};
  for (const Walks& walks : both.cameras) all.push_back(&walks);
  std::vector<PatchTrace> traces;
  for (const Walks* walks : all) traces.push_back(f.patches.add_all(*walks));

  Fragments fragments(f.patches, &f.patches);
  std::vector<uint8_t> has_area(f.patches.size(), 0);
  for (const Fragments::Fragment& piece : fragments.all()) has_area[piece.patch] = 1;
  const std::vector<uint32_t> numbers = f.patches.keep(has_area);
  fragments.renumber(numbers);
  if (!both.light.bin.empty())
    for (uint32_t k = 0; k < kSkyBins; ++k) f.patches.add_sky(k);
  for (size_t k = 0; k < all.size(); ++k) number_trace(f.patches, *all[k], numbers, traces[k]);

  f.lit = lit_cameras(f.patches, tracer, both, traces);
  f.etendue = measure_etendue(f.patches, fragments, tracer, seed, rays, traces);

  DimacsFile& file = f.file;
  file.has_patches = true;
  file.scale = kCapacityScale;
  file.scene_hash = scene.identity();
  file.grid = f.patches.grid();
  file.patches = geometry_of(f.patches, fragments, f.etendue);
  Counts counts = count_walks(f.patches, both, traces);
  const std::vector<double> albedo = albedos_of(scene);
  for (uint32_t i = 0; i < f.patches.size(); ++i)
    if (!f.patches.is_sky(i))
      counts.terms.albedo[i] = albedo[scene.triangles[file.patches[i].faces[0] / 2].material];
  file.light = camera_light(f.patches, f.etendue, counts.terms);
  file.walks = std::move(counts.walks);
  for (uint32_t k = 1; k < both.cameras.size(); ++k)
    file.more_sinks.push_back(f.patches.size() + 1 + k);
  file.network = network_of(f, counts.hits_of_lamps, both.sky_grade);
  return f;
}

std::vector<uint8_t> straddling(const Etendue& etendue, const std::vector<Side>& side,
                                double share) {
  std::vector<double> to_source(side.size(), 0), to_sink(side.size(), 0);
  for (const Etendue::Pair& p : etendue.pairs) {
    (side[p.j] == Side::source ? to_source : to_sink)[p.i] += p.count;
    (side[p.i] == Side::source ? to_source : to_sink)[p.j] += p.count;
  }
  std::vector<uint8_t> chosen(side.size(), 0);
  for (size_t i = 0; i < side.size(); ++i)
    chosen[i] = std::max(to_source[i], to_sink[i]) < share * (to_source[i] + to_sink[i]);
  return chosen;
}

}  // namespace tdpt
