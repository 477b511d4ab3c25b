#include "libcommon/trace/tracer.h"

#include <limits>

#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include "libcommon/base/error.h"

namespace tdpt {

struct Tracer::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<TriangleShape> shapes;
  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

namespace {
// Canonical coordinates are at most 1 in magnitude: 4 units in the last place of 1.
constexpr double kStep = 4 * 1.1920929e-7;

// Denormals slow Embree down; set per thread, once.
void flush_denormals() {
  thread_local const bool done = [] {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    return true;
  }();
  (void)done;
}
}  // namespace

Tracer::Tracer(const Scene& scene) : scene_(scene), impl_(std::make_unique<Impl>()) {
  flush_denormals();
  impl_->device = rtcNewDevice(nullptr);
  if (!impl_->device) throw Error(Exit::internal, "Embree gives no device");
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(impl_->scene, RTC_BUILD_QUALITY_HIGH);
  RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const size_t n = scene.triangles.size();
  auto* positions = static_cast<Vec3f*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f),
                              std::max<size_t>(scene.positions.size(), 1)));
  std::copy(scene.positions.begin(), scene.positions.end(), positions);
  auto* indices = static_cast<std::array<uint32_t, 3>*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              sizeof(std::array<uint32_t, 3>), std::max<size_t>(n, 1)));
  if (n == 0) indices[0] = {0, 0, 0};
  impl_->shapes.resize(n);
  for (uint32_t t = 0; t < n; ++t) {
    indices[t] = scene.triangles[t].vertex;
    impl_->shapes[t] = shape_of(scene, t);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(impl_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(impl_->scene);
  if (rtcGetDeviceError(impl_->device) != RTC_ERROR_NONE)
    throw Error(Exit::internal, "Embree cannot build its hierarchy");
}

Tracer::~Tracer() = default;

const TriangleShape& Tracer::shape(uint32_t triangle) const {
  return impl_->shapes[triangle];
}

Vec3f Tracer::step_off(const Origin& from, const Vec3d& w) const {
  const double step = dot(from.normal, w) < 0 ? -kStep : kStep;
  return Vec3f(from.position + from.normal * (step * offset_scale_));
}

bool Tracer::closest(const Origin& from, const Vec3d& w, Hit& hit) const {
  flush_denormals();
  const Vec3f o = step_off(from, w);
  const Vec3f d(w);
  RTCRayHit query;
  query.ray = {o.x, o.y, o.z, 0, d.x, d.y, d.z, 0, std::numeric_limits<float>::infinity(),
               ~0u, 0,   0};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  rtcIntersect1(impl_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  const TriangleShape& s = impl_->shapes[query.hit.primID];
  hit.triangle = query.hit.primID;
  hit.b1 = query.hit.u;
  hit.b2 = query.hit.v;
  hit.position = s.p0 + s.e1 * hit.b1 + s.e2 * hit.b2;
  hit.normal = s.normal;
  hit.distance = length(hit.position - from.position);
  return hit.distance > 0;
}

bool Tracer::visible(const Origin& a, const Origin& b) const {
  flush_denormals();
  const Vec3d w = b.position - a.position;
  const Vec3f from = step_off(a, w);
  const Vec3f to = step_off(b, -w);
  const Vec3f d = to - from;
  RTCRay ray{from.x, from.y, from.z, 0, d.x, d.y, d.z, 0, 1.0f, ~0u, 0, 0};
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  rtcOccluded1(impl_->scene, &context, &ray);
  return ray.tfar >= 0;
}

}  // namespace tdpt
