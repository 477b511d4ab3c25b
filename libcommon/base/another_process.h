// Work that a library might end the program in, done by another process.
#pragma once
#include <cstdint>
#include <cstdio>
#include <functional>

namespace tdpt {

/// Runs `work` in a copy of this process, which is silent on stderr, leaves no core and takes about
/// memory_limit() more than this one at most, while `take` reads here what it writes. Whether the
/// copy came to its end, by no exception, signal or exit of its own, and `take` returned true. A
/// copy has one thread: `work` may wait for no other. Throws Error(Exit::internal) where the system
/// gives no process.
bool in_another_process(const std::function<void(std::FILE* out)>& work,
                        const std::function<bool(std::FILE* in)>& take);

/// Limits this process, such a copy, from now on: to about `bytes` of memory more than it has,
/// where std::bad_alloc is thrown, and to `seconds` of computing, where it ends.
void limit_this_process(uint64_t bytes, unsigned seconds);

}  // namespace tdpt
