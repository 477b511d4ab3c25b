#include "libcommon/trace/tracer.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "libcommon/base/error.h"
#include "libcommon/base/process.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/texture.h"
#include "libcommon/trace/embree.h"
#include "shaders/shared/bvh.h"

namespace tdpt {

namespace {
// 4 units in the last place of 1, which canonical coordinates rarely exceed.
constexpr double kStep = 4 * 1.1920929e-7;
constexpr double kFar = 2;

double largest_coordinate(const Vec3d& p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}
}  // namespace

// Data that Embree passes to the filter.
struct Tracer::Query : embree::Query {
  explicit Query(const uint32_t* coin_ = nullptr, RTCFilterFunctionN filter_ = nullptr)
      : embree::Query(filter_), coin(coin_) {}
  const uint32_t* coin;                           ///< of a float ray
  const std::vector<uint32_t>* passed = nullptr;  ///< all that does not stop; nullptr: by chance
};

struct Tracer::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<TriangleShape> shapes;
  /// Scene triangles of Embree's geometries 0 (opaque) and 1 (with alpha, panes), if there are both
  /// kinds; empty: geometry 0 holds all of them in order.
  std::array<std::vector<uint32_t>, 2> triangles;
  std::vector<Pane> panes;  ///< by material; empty: no panes
  const Scene* traced = nullptr;
  double reach = 0;  // largest absolute coordinate
  bool far = false;  // some lie well outside the frame

  uint32_t triangle(unsigned geometry, unsigned primitive) const {
    return triangles[geometry].empty() ? primitive : triangles[geometry][primitive];
  }
  void add_geometry(const std::vector<uint32_t>& chosen, bool alpha);
  double coverage(uint32_t triangle, float u, float v, const Vec3d& w) const {
    const bool alpha = traced->material_of(triangle).alpha_mode != Material::Alpha::opaque;
    return alpha ? double{coverage_at(*traced, {triangle, u, v})} : opacity(triangle, w);
  }
  bool stops(const Query& query, uint32_t triangle, float u, float v, const Vec3d& w) const;
  /// See Hit::opacity. `w` of any length.
  double opacity(uint32_t triangle, const Vec3d& w) const {
    if (panes.empty()) return 1;
    const Pane& pane = panes[traced->triangles[triangle].material];
    return pane ? pane.opacity(dot(shapes[triangle].normal, w) / length(w)) : 1;
  }
  double reach_of(uint32_t triangle) const {
    double farthest = 0;
    for (const uint32_t v : traced->triangles[triangle].vertex)
      farthest = std::max(farthest, largest_coordinate(Vec3d(traced->positions[v])));
    return farthest;
  }
  /// Then rounding does not depend on how far the triangle reaches.
  bool lies_across_axis(uint32_t triangle) const {
    const Vec3d &a = shapes[triangle].e1, &b = shapes[triangle].e2;
    return std::min({std::max(std::abs(a.x), std::abs(b.x)), std::max(std::abs(a.y), std::abs(b.y)),
                     std::max(std::abs(a.z), std::abs(b.z))}) < kFar;
  }
  /// Where the line from `o` along w meets the triangle's plane, if it reaches far: barycentrics
  /// are floats.
  Vec3d refined(uint32_t triangle, const Vec3d& o, const Vec3d& w, const Vec3d& place) const {
    if (reach_of(triangle) <= 4 * kFar) return place;
    const TriangleShape& s = shapes[triangle];
    const double cosine = dot(s.normal, w);
    const Vec3d exact = o + w * (dot(s.normal, s.p0 - o) / cosine);
    return std::abs(cosine) > 1e-4 && length(exact - place) < 1e-5 * reach ? exact : place;
  }
  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

namespace {
constexpr float kInfiniteRay = std::numeric_limits<float>::infinity();

// An Embree device that supports what is needed; otherwise throws.
RTCDevice new_device() {
  RTCDevice device = rtcNewDevice(embree_configuration().c_str());
  if (!device && rtcGetDeviceError(nullptr) == RTC_ERROR_UNSUPPORTED_CPU)
    throw Error(Exit::no_device, "this processor lacks the instructions that Embree needs");
  if (!device)
    throw Error(Exit::internal, "Embree gives no device, perhaps for want of memory or threads");
  return device;
}

RTCRayHit ray_hit(const RTCRay& ray) {
  RTCRayHit query;
  query.ray = ray;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return query;
}

// Shares the positions with Embree if it may read 16 bytes at the last one, of which 12 are valid.
void give_vertices(RTCGeometry geometry, const std::vector<Vec3f>& positions) {
  const size_t n = positions.size();
  if (positions.capacity() > n) {
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               positions.data(), 0, sizeof(Vec3f), n);
    return;
  }
  auto* copy = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                           RTC_FORMAT_FLOAT3, sizeof(Vec3f),
                                                           std::max<size_t>(n, 1)));
  std::copy(positions.begin(), positions.end(), copy);
}

}  // namespace

// A camera ray, which passes backs.
struct Tracer::CameraQuery : Query {
  CameraQuery(const Tracer& tracer_, const Vec3d& w_)
      : Query(nullptr, pass_backs), tracer(tracer_), w(w_) {}
  static void pass_backs(const RTCFilterFunctionNArguments* a) {
    const auto& self = *static_cast<const CameraQuery*>(a->context);
    const uint32_t triangle = self.tracer.impl_->triangle(RTCHitN_geomID(a->hit, a->N, 0),
                                                          RTCHitN_primID(a->hit, a->N, 0));
    if (!self.tracer.draws(triangle, self.w)) a->valid[0] = 0;
  }
  const Tracer& tracer;
  const Vec3d& w;  ///< away from the camera
};

// Whether a surface stops the ray: stochastic transparency, see the header.
bool Tracer::Impl::stops(const Query& query, uint32_t triangle, float u, float v,
                         const Vec3d& w) const {
  const double share = coverage(triangle, u, v, w);
  if (query.passed)
    return share > 0 &&
           std::find(query.passed->begin(), query.passed->end(), triangle) == query.passed->end();
  if (share >= 1 || share <= 0) return share > 0;
  if (query.coin) return double{shader::hashed_unit(*query.coin, triangle)} < share;
  const uint64_t place = uint64_t{std::bit_cast<uint32_t>(u)} << 32 | std::bit_cast<uint32_t>(v);
  return unit_double(mix64(mix64(place) + triangle)) < share;
}

// `chosen`: triangles of the scene; empty: all.
void Tracer::Impl::add_geometry(const std::vector<uint32_t>& chosen, bool alpha) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const bool all = chosen.empty() && triangles[1].empty();
  const size_t n = all ? traced->triangles.size() : chosen.size();
  give_vertices(geometry, traced->positions);
  if (all && n > 0) {
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               traced->triangles.data(), offsetof(Triangle, vertex),
                               sizeof(Triangle), n);
  } else {
    auto* indices = static_cast<std::array<uint32_t, 3>*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                sizeof(std::array<uint32_t, 3>), std::max<size_t>(n, 1)));
    if (n == 0) indices[0] = {0, 0, 0};
    for (size_t i = 0; i < n; ++i) indices[i] = traced->triangles[chosen[i]].vertex;
  }
  if (alpha) {
    rtcSetGeometryUserData(geometry, this);
    const auto filter = [](const RTCFilterFunctionNArguments* a) {
      const auto& self = *static_cast<const Impl*>(a->geometryUserPtr);
      if (a->valid[0] == 0) return;
      const uint32_t t = self.triangles[1][RTCHitN_primID(a->hit, a->N, 0)];
      const Vec3d w(RTCRayN_dir_x(a->ray, a->N, 0), RTCRayN_dir_y(a->ray, a->N, 0),
                    RTCRayN_dir_z(a->ray, a->N, 0));
      const float u = RTCHitN_u(a->hit, a->N, 0), v = RTCHitN_v(a->hit, a->N, 0);
      if (!self.stops(*static_cast<const Query*>(a->context), t, u, v, w)) a->valid[0] = 0;
    };
    rtcSetGeometryIntersectFilterFunction(geometry, filter);
    rtcSetGeometryOccludedFilterFunction(geometry, filter);
  }
  rtcSetGeometryMask(geometry, embree::kMask);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

Tracer::Tracer(const Scene& scene, bool culls)
    : scene_(scene), culls_(culls), impl_(std::make_unique<Impl>()) {
  flush_denormals();
  impl_->device = new_device();
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, culls ? RTC_SCENE_FLAG_ROBUST | embree::kFiltersOfQueries
                                       : RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(impl_->scene, RTC_BUILD_QUALITY_HIGH);
  impl_->traced = &scene;
  for (uint32_t t = 0; t < scene.triangles.size(); ++t)
    impl_->reach = std::max(impl_->reach, impl_->reach_of(t));
  impl_->far = impl_->reach > kFar;
  const auto n = static_cast<uint32_t>(scene.triangles.size());
  std::vector<uint8_t> filtered(scene.materials.size());
  std::vector<Pane> panes(scene.materials.size());
  for (size_t m = 0; m < scene.materials.size(); ++m) {
    panes[m] = pane_of(scene.materials[m]);
    filtered[m] = panes[m] || scene.materials[m].alpha_mode != Material::Alpha::opaque;
  }
  if (std::any_of(panes.begin(), panes.end(), [](const Pane& p) { return bool(p); }))
    impl_->panes = panes;
  bool any = false;
  for (const Triangle& t : scene.triangles) any |= filtered[t.material] != 0;
  if (any)
    for (uint32_t t = 0; t < n; ++t)
      impl_->triangles[filtered[scene.triangles[t].material]].push_back(t);
  impl_->add_geometry(impl_->triangles[0], false);
  if (any) impl_->add_geometry(impl_->triangles[1], true);
  rtcCommitScene(impl_->scene);
  if (rtcGetDeviceError(impl_->device) != RTC_ERROR_NONE)
    throw Error(Exit::internal,
                "Embree cannot build its hierarchy, perhaps for want of memory or threads");
  // Allocated last: the BVH build temporarily needs as much memory.
  impl_->shapes.reserve(n);
  for (uint32_t t = 0; t < n; ++t) impl_->shapes.push_back(shape_of(scene, t));
}

Tracer::~Tracer() = default;

double Tracer::reach() const {
  return impl_->reach;
}

const TriangleShape& Tracer::shape(uint32_t triangle) const {
  return impl_->shapes[triangle];
}

// Called twice for every ray between two points: inlined.
[[gnu::always_inline]] inline Vec3f Tracer::step_off(const Origin& from, const Vec3d& w) const {
  if (impl_->far || largest_coordinate(from.position) > 8) [[unlikely]]
    return step_off_afar(from, w);
  if (from.normal == Vec3d{}) return Vec3f(from.position + w * (kStep * offset_scale_ / length(w)));
  const double step = dot(from.normal, w) < 0 ? -kStep : kStep;
  return Vec3f(from.position + from.normal * (step * offset_scale_));
}

// In proportion to the coordinates that rounding depends on. An origin in the air before the whole
// scene is moved up to it.
[[gnu::noinline]] Vec3f Tracer::step_off_afar(const Origin& from, const Vec3d& w) const {
  if (from.normal == Vec3d{}) {
    const Vec3d unit = w / length(w);
    const double before = std::max(0.0, -dot(from.position, unit) - 2 * impl_->reach);
    const Vec3d p = from.position + unit * before;
    return Vec3f(p + unit * (kStep * offset_scale_ * std::max(1.0, largest_coordinate(p))));
  }
  double size = std::max(1.0, largest_coordinate(from.position));
  if (from.triangle != ~0u && !impl_->lies_across_axis(from.triangle))
    size = std::max(size, impl_->reach_of(from.triangle));
  const double step = dot(from.normal, w) < 0 ? -kStep : kStep;
  return Vec3f(from.position + from.normal * (step * offset_scale_ * size));
}

bool Tracer::first_hit(const Vec3f& from, const Vec3f& w, uint32_t coin,
                       shader::SurfaceHit& hit) const {
  flush_denormals();
  RTCRayHit found = ray_hit(embree::ray(from.x, from.y, from.z, w.x, w.y, w.z, kInfiniteRay));
  Query query(&coin);
  tdpt_first_hit(impl_->scene, query, found);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit.t = found.ray.tfar;
  hit.triangle = impl_->triangle(found.hit.geomID, found.hit.primID);
  hit.b1 = found.hit.u;
  hit.b2 = found.hit.v;
  hit.back = dot(impl_->shapes[hit.triangle].normal, Vec3d(w)) > 0 ? 1 : 0;
  return true;
}

bool Tracer::segment_blocked(const Vec3f& a, const Vec3f& b, uint32_t coin) const {
  flush_denormals();
  const Vec3f d = b - a;
  RTCRay ray = embree::ray(a.x, a.y, a.z, d.x, d.y, d.z, 1);
  Query query(&coin);
  return tdpt_any_hit(impl_->scene, query, ray);
}

// Whether a ray that hits a triangle near one of its edges was stopped before by a neighbour.
[[gnu::noinline]] bool Tracer::stopped_before(Query& query, const Vec3f& o, const Vec3d& w,
                                              const Origin& at) const {
  const double way = length(at.position - Vec3d(o));
  const Vec3f from(Vec3d(o) + w * std::max(way - double{shader::kEdgeReach}, 0.0));
  const Vec3f d = step_off(at, -w) - from;
  RTCRay rest = embree::ray(from.x, from.y, from.z, d.x, d.y, d.z, 1);
  return tdpt_any_hit(impl_->scene, query, rest);
}

[[gnu::always_inline]] inline bool Tracer::first_surface(Query& query, const Vec3f& o,
                                                         const Vec3d& from, const Vec3d& w,
                                                         Hit& hit) const {
  flush_denormals();
  const Vec3f d(w);
  RTCRayHit found = ray_hit(embree::ray(o.x, o.y, o.z, d.x, d.y, d.z, kInfiniteRay));
  tdpt_first_hit(impl_->scene, query, found);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit.triangle = impl_->triangle(found.hit.geomID, found.hit.primID);
  const TriangleShape& s = impl_->shapes[hit.triangle];
  hit.b1 = found.hit.u;
  hit.b2 = found.hit.v;
  const bool at_edge = shader::keep_off_edges(s.e1, s.e2, w, hit.b1, hit.b2);
  hit.position = s.p0 + s.e1 * hit.b1 + s.e2 * hit.b2;
  if (impl_->far) [[unlikely]]
    hit.position = impl_->refined(hit.triangle, Vec3d(o), w, hit.position);
  hit.normal = s.normal;
  hit.opacity = impl_->opacity(hit.triangle, w);
  hit.distance = length(hit.position - from);
  if (at_edge) [[unlikely]] {
    if (stopped_before(query, o, w, {hit.position, hit.normal, hit.triangle})) return false;
  }
  return hit.distance > 0;
}

bool Tracer::closest_from(const Vec3f& from, const Vec3d& w, Hit& hit) const {
  Query query;
  return first_surface(query, from, Vec3d(from), w, hit);
}

bool Tracer::closest(const Origin& from, const Vec3d& w, Hit& hit) const {
  Query query;
  return first_surface(query, step_off(from, w), from.position, w, hit);
}

bool Tracer::first_seen(const Vec3d& camera, const Vec3d& w, Hit& hit) const {
  if (!culls_) return closest({camera}, w, hit);
  CameraQuery query(*this, w);
  return first_surface(query, step_off({camera}, w), camera, w, hit);
}

bool Tracer::first_sheet(const Origin& from, const Vec3d& w, const std::vector<uint32_t>& passed,
                         Sheet& sheet) const {
  Query query;
  return first_sheet(query, from, w, passed, sheet);
}

bool Tracer::first_sheet_seen(const Vec3d& camera, const Vec3d& w,
                              const std::vector<uint32_t>& passed, Sheet& sheet) const {
  if (!culls_) return first_sheet({camera}, w, passed, sheet);
  CameraQuery query(*this, w);
  return first_sheet(query, {camera}, w, passed, sheet);
}

bool Tracer::first_sheet(Query& query, const Origin& from, const Vec3d& w,
                         const std::vector<uint32_t>& passed, Sheet& sheet) const {
  query.passed = &passed;
  Hit& hit = sheet.hit;
  if (!first_surface(query, step_off(from, w), from.position, w, hit)) return false;
  sheet.coverage =
      impl_->coverage(hit.triangle, static_cast<float>(hit.b1), static_cast<float>(hit.b2), w);
  return true;
}

bool Tracer::sees(const Vec3d& camera, const Origin& place) const {
  if (!culls_) return visible(place, {camera});
  const Vec3d w = place.position - camera;
  CameraQuery query(*this, w);
  return unblocked(query, place, {camera});
}

bool Tracer::visible(const Origin& a, const Origin& b) const {
  Query query;
  return unblocked(query, a, b);
}

bool Tracer::unblocked(Query& query, const Origin& one, const Origin& other) const {
  flush_denormals();
  // From the end with the smaller coordinates, which rounding moves less.
  const bool turned =
      impl_->far && dot(one.position, one.position) > dot(other.position, other.position);
  const Origin &a = turned ? other : one, &b = turned ? one : other;
  const Vec3d w = b.position - a.position;
  const Vec3f from = step_off(a, w);
  const Vec3f to = step_off(b, -w);
  const Vec3f d = to - from;
  RTCRay ray = embree::ray(from.x, from.y, from.z, d.x, d.y, d.z, 1);
  return !tdpt_any_hit(impl_->scene, query, ray);
}

}  // namespace tdpt
