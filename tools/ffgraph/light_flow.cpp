#include "tools/ffgraph/light_flow.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/flow/potential_sweep.h"
#include "tools/ffgraph/camera_light.h"

namespace tdpt {
namespace {

int64_t whole(double capacity) {
  return std::llround(capacity * kCapacityScale);
}

// Needs f.more_sinks.
FlowNetwork network_of(const LightFlow& f, const std::vector<double>& sky_grade) {
  FlowNetwork net;
  net.nodes = static_cast<uint32_t>(f.patches.size() + 2 + f.more_sinks.size());
  net.source = 0;
  net.sink = 1;
  const auto add = [&net](uint32_t from, uint32_t to, double capacity) {
    if (const int64_t c = whole(capacity); c > 0) net.arcs.push_back({from, to, c});
  };
  const std::vector<double>& n = f.etendue.samples;
  std::vector<double> of_lamps = f.hits_light;
  for (size_t i = 0; i < f.lit_by_sky.size(); ++i) of_lamps[i] -= f.lit_by_sky[i];
  const std::vector<double> from_light = terminal_grades(of_lamps, n);
  std::vector<std::vector<double>> to_camera;
  for (const std::vector<double>& hits : f.hits_cameras)
    to_camera.push_back(terminal_grades(hits, n));
  for (uint32_t i = 0; i < f.patches.size(); ++i) {
    const bool sky = f.patches.is_sky(i);
    add(net.source, i + 2, n[i] * (sky ? sky_grade[f.patches.bin_of(i)] : from_light[i]));
    for (size_t k = 0; k < to_camera.size(); ++k)
      if (f.lit[k]) add(i + 2, k == 0 ? net.sink : f.more_sinks[k - 1], n[i] * to_camera[k][i]);
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
    const Vec3d normal = shape_of(patches.scene(), f.face / 2).normal;
    p.centre += f.centroid * f.area;
    p.normal += normal * (f.face & 1 ? -f.area : f.area);
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

PatchTrace trace_of(const PatchMap& patches, const Walks& walks) {
  PatchTrace trace(walks.size());
  tbb::parallel_for(size_t{0}, walks.size(), [&](size_t k) {
    const WalkHit& h = walks[k];
    trace[k] = h.face == kWalkLeft      ? kTraceLeft
               : h.face == kWalkStopped ? kTraceStopped
               : to_sky(h)              ? patches.find_sky(h.face - kWalkToSky)
                                        : patches.find(h.face, Vec3d(h.position));
  });
  return trace;
}

// Number of hits per patch of surface.
std::vector<double> hits_of(const PatchMap& patches, const PatchTrace& trace) {
  std::vector<double> hits(patches.size(), 0);
  for (const uint32_t patch : trace)
    if (patch < patches.size() && !patches.is_sky(patch)) hits[patch] += 1;
  return hits;
}

// Whether light and camera reach one room: some place that a light walk hit can be seen from one
// that a camera walk hit, both in one patch and lifted off their surfaces. That they share patches
// does not tell: a patch of the floor may reach under a closed door.
class Meeting {
 public:
  Meeting(const PatchMap& patches, const Tracer& tracer, const Walks& light,
          const PatchTrace& of_light)
      : patches_(patches), tracer_(tracer), lit_(patches.size()) {
    for (size_t k = 0; k < light.size(); ++k)
      if (const uint32_t p = of_light[k]; p < lit_.size() && lit_[p].size() < kPlaces)
        lit_[p].push_back(lifted(light[k], p));
  }

  bool with(const Walks& camera, const PatchTrace& of_camera) const {
    std::vector<uint8_t> tried(lit_.size(), 0);
    for (size_t k = 0; k < camera.size(); ++k) {
      const uint32_t p = of_camera[k];
      if (p >= lit_.size() || tried[p] == kPlaces) continue;
      if (patches_.is_sky(p)) return true;
      const Lifted from = lifted(camera[k], p);
      ++tried[p];
      for (const Lifted& place : lit_[p])
        if (is_free(from) && is_free(place) && tracer_.visible({from.above}, {place.above}))
          return true;
    }
    return false;
  }

 private:
  static constexpr size_t kPlaces = 16;  // of a patch that are tried
  static constexpr double kLift = 0.05;  // of its cell

  struct Lifted {
    Tracer::Origin place;
    Vec3d above;
  };

  Lifted lifted(const WalkHit& hit, uint32_t patch) const {
    if (!is_hit(hit)) return {};
    const Scene& scene = patches_.scene();
    const Vec3d front = shape_of(scene, hit.face / 2).normal,
                normal = hit.face & 1 ? -front : front;
    const double cell = std::ldexp(patches_.grid().base_cell, -2 * patches_.keys()[patch].level);
    const Vec3d place(hit.position);
    return {{place, normal}, place + normal * (kLift * cell * scene.frame.scale)};
  }

  bool is_free(const Lifted& l) const { return tracer_.visible(l.place, {l.above}); }

  const PatchMap& patches_;
  const Tracer& tracer_;
  std::vector<std::vector<Lifted>> lit_;  // of each patch
};

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

// Adds what begins on each patch and in the sky, what the sky lights, and the terms of the cameras'
// light. `traces`: of the light's walks, then of each camera's.
void count_walks(const Scene& scene, const BothWalks& both, const std::vector<PatchTrace>& traces,
                 LightFlow& f, std::vector<PatchTerms>& terms) {
  f.begun.assign(f.patches.size(), 0);
  f.lit_by_sky.assign(f.patches.size(), 0);
  const LightWalks& light = both.light;
  for (const LightWalks::Start& start : light.starts)
    if (const uint32_t p = f.patches.find(start.at.face, Vec3d(start.at.position)); p != kNoPatch)
      f.begun[p] += 1, terms[p].emitted += light.power[start.walk];
  each_hit(light.hits, [&](size_t k, size_t walk, bool first) {
    const uint32_t p = traces[0][k];
    const bool known = p < f.patches.size();
    if (light.from_sky(walk)) {
      if (known) f.lit_by_sky[p] += 1;
      if (const uint32_t bin = f.patches.find_sky(light.bin[walk]); first && bin != kNoPatch)
        f.begun[bin] += 1, terms[bin].emitted += light.power[walk];
    }
    if (first && known) terms[p].direct += light.power[walk];
  });
  for (PatchTerms& t : terms) t.seen.assign(both.cameras.size(), 0);
  for (size_t c = 0; c < both.cameras.size(); ++c)
    each_hit(both.cameras[c], [&](size_t k, size_t, bool first) {
      if (const uint32_t p = traces[1 + c][k]; first && p < f.patches.size()) terms[p].seen[c] += 1;
    });
  const std::vector<double> albedo = albedos_of(scene);
  for (uint32_t i = 0; i < f.patches.size(); ++i)
    if (!f.patches.is_sky(i))
      terms[i].albedo = albedo[scene.triangles[f.geometry[i].faces.front() / 2].material];
}

}  // namespace

LightFlow light_flow(PatchMap patches, const BothWalks& both, const Tracer& tracer, uint64_t seed,
                     uint32_t rays) {
  LightFlow f{std::move(patches), {}, {}, {}, {}, {}, {}, {}, {}, {}, {}};
  std::vector<const Walks*> all{&both.light.hits};
  for (const Walks& walks : both.cameras) all.push_back(&walks);
  for (const Walks* walks : all)
    f.patches.add_all(walks->size(), [walks](size_t k) {
      const WalkHit& h = (*walks)[k];
      return is_hit(h) ? std::optional(PatchMap::SurfacePoint{h.face, Vec3d(h.position)})
                       : std::nullopt;
    });

  Fragments fragments = Fragments::with_all_of_split(f.patches);
  std::vector<uint8_t> has_area(f.patches.size(), 0);
  for (const Fragments::Fragment& piece : fragments.all()) has_area[piece.patch] = 1;
  f.patches.keep(has_area);
  fragments.keep(has_area);
  if (!both.light.bin.empty())
    for (uint32_t k = 0; k < kSkyBins; ++k) f.patches.add_sky(k);

  std::vector<PatchTrace> traces;
  for (const Walks* walks : all) traces.push_back(trace_of(f.patches, *walks));
  f.hits_light = hits_of(f.patches, traces[0]);
  for (size_t k = 1; k < traces.size(); ++k)
    f.hits_cameras.push_back(hits_of(f.patches, traces[k]));
  const Meeting meeting(f.patches, tracer, both.light.hits, traces[0]);
  for (size_t c = 0; c < both.cameras.size(); ++c)
    f.lit.push_back(meeting.with(both.cameras[c], traces[1 + c]));
  f.etendue = measure_etendue(f.patches, fragments, tracer, seed, rays, traces);
  f.geometry = geometry_of(f.patches, fragments, f.etendue);
  std::vector<PatchTerms> terms(f.patches.size());
  count_walks(f.patches.scene(), both, traces, f, terms);
  f.light = camera_light(f.patches, f.etendue, terms);
  for (uint32_t k = 1; k < both.cameras.size(); ++k)
    f.more_sinks.push_back(f.patches.size() + 1 + k);
  f.network = network_of(f, both.sky_grade);
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

DimacsFile dimacs_file(const LightFlow& f) {
  DimacsFile file;
  file.has_patches = true;
  file.scale = kCapacityScale;
  file.scene_hash = f.patches.scene().identity();
  file.grid = f.patches.grid();
  file.network = f.network;
  file.more_sinks = f.more_sinks;
  file.patches = f.geometry;
  file.light = f.light;
  for (size_t i = 0; i < f.begun.size(); ++i)
    file.walks.push_back({f.begun[i], f.hits_light[i], {}});
  for (const std::vector<double>& hits : f.hits_cameras)
    for (size_t i = 0; i < hits.size(); ++i) file.walks[i].camera.push_back(hits[i]);
  return file;
}

}  // namespace tdpt
