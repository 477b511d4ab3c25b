// Runs work in a child process, for libraries that may abort the program on bad input.
#pragma once
#include <cstdint>
#include <cstdio>
#include <functional>

namespace tdpt {

/// Runs `work` in a forked copy of this process, while `take` reads here what it writes. The copy
/// prints nothing on stderr, dumps no core and may allocate about memory_limit() more than this
/// process. Returns true if the copy ended normally (no exception, signal or exit of its own) and
/// `take` returned true. The copy has a single thread, so `work` must not wait for another. Throws
/// Error(Exit::internal) if no process can be created.
bool in_another_process(const std::function<void(std::FILE* out)>& work,
                        const std::function<bool(std::FILE* in)>& take);

/// Limits this process (normally such a copy) from now on: beyond about `bytes` of additional
/// memory std::bad_alloc is thrown, and after `seconds` of CPU time the process is killed.
void limit_this_process(uint64_t bytes, unsigned seconds);

}  // namespace tdpt
