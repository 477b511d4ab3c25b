// Ctrl-C and friends: a long run asks whether it should stop, finishes what it holds and exits 6.
#pragma once

namespace tdpt {

/// From now on SIGINT, SIGTERM and SIGHUP only set a flag; a second one ends the process at once.
/// What the caller chose to ignore (nohup) stays ignored.
void catch_signals();
bool stop_requested();

}  // namespace tdpt
