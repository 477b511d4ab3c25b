// One interface to Embree 3 and 4; nothing else knows which one is used.
//
// Differences: a query's filter and flags are in its context (3) or in separate arguments (4); a
// geometry's mask defaults to all ones (3) or 1 (4).
#pragma once
#if TDPT_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace tdpt::embree {

#if TDPT_EMBREE >= 4
using Context = RTCRayQueryContext;
constexpr RTCSceneFlags kFiltersOfQueries = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
#else
using Context = RTCIntersectContext;
constexpr RTCSceneFlags kFiltersOfQueries = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
#endif

/// Every ray meets every geometry.
constexpr unsigned kMask = ~0u;

/// Query data of an incoherent ray. Filters receive it as `context` of their arguments.
struct Query : Context {
  /// `filter` sees hits after the geometries' own filters; scenes for such queries need the flag
  /// kFiltersOfQueries.
  explicit Query(RTCFilterFunctionN filter = nullptr);
#if TDPT_EMBREE >= 4
  RTCFilterFunctionN filter;
#endif
};

/// A ray from `o` along `d` up to o + far d.
inline RTCRay ray(float ox, float oy, float oz, float dx, float dy, float dz, float far) {
  return {ox, oy, oz, 0, dx, dy, dz, 0, far, kMask, 0, 0};
}

}  // namespace tdpt::embree

// C linkage, so that the linker can wrap them to record rays [ray_record.h].
extern "C" {
/// Stores the first hit in `ray`.
void tdpt_first_hit(RTCScene scene, tdpt::embree::Query& query, RTCRayHit& ray);
/// Whether anything is hit.
bool tdpt_any_hit(RTCScene scene, tdpt::embree::Query& query, RTCRay& ray);
}
