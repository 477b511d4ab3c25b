#include "libcommon/trace/embree.h"

using tdpt::embree::Query;

#if TDPT_EMBREE >= 4
namespace {

template <class Arguments>
void set(Arguments& arguments, Query& query) {
  arguments.context = &query;
  arguments.feature_mask =
      static_cast<RTCFeatureFlags>(RTC_FEATURE_FLAG_TRIANGLE | RTC_FEATURE_FLAG_FILTER_FUNCTION);
  if (!query.filter) return;
  arguments.filter = query.filter;
  arguments.flags = RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;  // incoherent is the default, 0
}

}  // namespace

Query::Query(RTCFilterFunctionN filter_) : filter(filter_) {
  rtcInitRayQueryContext(this);
}

void tdpt_first_hit(RTCScene scene, Query& query, RTCRayHit& ray) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  set(arguments, query);
  rtcIntersect1(scene, &ray, &arguments);
}

bool tdpt_any_hit(RTCScene scene, Query& query, RTCRay& ray) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  set(arguments, query);
  rtcOccluded1(scene, &ray, &arguments);
  return ray.tfar < 0;
}
#else
Query::Query(RTCFilterFunctionN filter_) {
  rtcInitIntersectContext(this);
  flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  filter = filter_;
}

void tdpt_first_hit(RTCScene scene, Query& query, RTCRayHit& ray) {
  rtcIntersect1(scene, &query, &ray);
}

bool tdpt_any_hit(RTCScene scene, Query& query, RTCRay& ray) {
  rtcOccluded1(scene, &query, &ray);
  return ray.tfar < 0;
}
#endif
