// For benchmarks: records the rays that a program traces with Embree, and replays them.
//
// Programs that link this are linked with --wrap=tdpt_first_hit and --wrap=tdpt_any_hit, which
// intercepts the calls of the unchanged Tracer. First-hit and occlusion queries are kept in their
// order per thread. Coverage is not a property of a ray, so scenes must be opaque.
#pragma once
#include <cstdint>

namespace tdpt::ray_record {

/// Discards the record and starts recording the rays of all threads. One scene at a time.
void begin();
/// Stops recording. No thread may be tracing rays.
void end();
/// Number of recorded rays, over all threads.
uint64_t rays();
uint64_t threads();
/// Traces them again, on as many threads as recorded them, each its own. Returns how many differ in
/// whether they hit something: 0.
uint64_t cast_again();

}  // namespace tdpt::ray_record
