#include "libcommon/testing/ray_record.h"

#include <limits>
#include <memory>
#include <mutex>
#include <numeric>
#include <thread>
#include <vector>

#include "libcommon/base/process.h"
#include "libcommon/trace/embree.h"

using tdpt::embree::Query;

extern "C" {
void __real_tdpt_first_hit(RTCScene scene, Query& query, RTCRayHit& ray);
bool __real_tdpt_any_hit(RTCScene scene, Query& query, RTCRay& ray);
void __wrap_tdpt_first_hit(RTCScene scene, Query& query, RTCRayHit& ray);
bool __wrap_tdpt_any_hit(RTCScene scene, Query& query, RTCRay& ray);
}

namespace tdpt::ray_record {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

struct Ray {
  float org_x, org_y, org_z, dir_x, dir_y, dir_z;
  float tfar;  // infinite: first-hit query; else occlusion query up to this distance
  bool met;
};
using Rays = std::vector<Ray>;

struct Record {
  std::mutex lock;  // protects the following
  std::vector<std::unique_ptr<Rays>> of_threads;
  uint64_t number = 0;  // of the record: a thread whose number differs has no entry in this one
  bool open = false;
  RTCScene scene = nullptr;
};
Record record;

Rays& rays_of_thread(RTCScene scene) {
  thread_local Rays* own = nullptr;
  thread_local uint64_t number = 0;
  if (number != record.number) {
    const std::lock_guard lock(record.lock);
    own = record.of_threads.emplace_back(std::make_unique<Rays>()).get();
    number = record.number;
    record.scene = scene;
  }
  return *own;
}

Ray kept(const RTCRay& r, float tfar, bool met) {
  return {r.org_x, r.org_y, r.org_z, r.dir_x, r.dir_y, r.dir_z, tfar, met};
}

uint64_t cast(const Rays& rays) {
  flush_denormals();  // as the Tracer does
  Query query;
  uint64_t others = 0;
  for (const Ray& r : rays) {
    RTCRayHit ray;
    ray.ray = embree::ray(r.org_x, r.org_y, r.org_z, r.dir_x, r.dir_y, r.dir_z, r.tfar);
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    bool met = false;
    if (r.tfar == kInfinite) {
      __real_tdpt_first_hit(record.scene, query, ray);
      met = ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    } else {
      met = __real_tdpt_any_hit(record.scene, query, ray.ray);
    }
    others += met != r.met;
  }
  return others;
}

}  // namespace

void begin() {
  record.of_threads.clear();
  ++record.number;
  record.open = true;
}

void end() {
  record.open = false;
}

uint64_t rays() {
  uint64_t n = 0;
  for (const auto& of_thread : record.of_threads) n += of_thread->size();
  return n;
}

uint64_t threads() {
  return record.of_threads.size();
}

uint64_t cast_again() {
  const auto& all = record.of_threads;
  std::vector<uint64_t> others(all.size());
  std::vector<std::thread> workers;
  for (size_t i = 1; i < all.size(); ++i)
    workers.emplace_back([&, i] { others[i] = cast(*all[i]); });
  if (!all.empty()) others[0] = cast(*all[0]);
  for (std::thread& worker : workers) worker.join();
  return std::accumulate(others.begin(), others.end(), uint64_t{0});
}

}  // namespace tdpt::ray_record

using namespace tdpt::ray_record;

void __wrap_tdpt_first_hit(RTCScene scene, Query& query, RTCRayHit& ray) {
  __real_tdpt_first_hit(scene, query, ray);
  if (!record.open) return;
  const bool met = ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  rays_of_thread(scene).push_back(kept(ray.ray, kInfinite, met));
}

bool __wrap_tdpt_any_hit(RTCScene scene, Query& query, RTCRay& ray) {
  const float tfar = ray.tfar;
  const bool met = __real_tdpt_any_hit(scene, query, ray);
  if (record.open) rays_of_thread(scene).push_back(kept(ray, tfar, met));
  return met;
}
