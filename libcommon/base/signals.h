// Ctrl-C and friends: a long run asks whether it should stop, finishes what it holds and exits 6.
#pragma once

namespace tdpt {

/// From now on SIGINT and SIGTERM only set a flag; a second one ends the process at once.
void catch_signals();
bool stop_requested();

}  // namespace tdpt
