// Ctrl-C and friends: a long run asks whether it should stop, finishes what it holds and exits 6.
#pragma once

namespace tdpt {

/// From now on SIGINT, SIGTERM and SIGHUP only set a flag. One that comes a second later or more
/// ends the process at once; before that it is taken for the same, as a group of processes gets it
/// and Make hands it on again.
/// What the caller chose to ignore (nohup) stays ignored.
void catch_signals();
bool stop_requested();

}  // namespace tdpt
