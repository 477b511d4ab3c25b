// How many threads the whole process uses.
#pragma once

namespace tdpt {

/// Caps TBB (and with it Embree and OpenVDB) at `n` threads for the rest of the process;
/// n = 0: all cores. Call once, before any parallel work.
void limit_threads(int n);

/// CPU seconds of the whole process, all threads.
double cpu_seconds();

}  // namespace tdpt
