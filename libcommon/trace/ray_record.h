// For benchmarks: keeps the rays that the program gives to Embree, and gives them to it again.
//
// Rays are seen on their way: programs that link this are linked with --wrap=tdpt_first_hit and
// --wrap=tdpt_any_hit, so that the Tracer's calls go by here, and the Tracer is that of every day.
// Queries are kept as they were made, first hits and occlusion by turns, those of each thread in
// their order. Coverage is no property of a ray: scenes are to be opaque.
#pragma once
#include <cstdint>

namespace tdpt::ray_record {

/// Forgets what was kept, and keeps the rays of all threads from now on. One scene at a time.
void begin();
/// Keeps no more. No thread may be tracing rays.
void end();
/// How many are kept, of how many threads.
uint64_t rays();
uint64_t threads();
/// Casts them again, on as many threads as made them, each its own. Returns how many met something
/// and had not before, or the other way round: 0.
uint64_t cast_again();

}  // namespace tdpt::ray_record
