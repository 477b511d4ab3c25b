// Ctrl-C and the like: a long run polls a flag, finishes what it holds and exits 6.
#pragma once

namespace tdpt {

/// From now on SIGINT, SIGTERM and SIGHUP only set a flag. A second signal ends the process at once
/// if it comes a second later or more; earlier it counts as the same one, since a group of
/// processes gets it and Make passes it on again. Signals that the caller ignores (nohup) stay
/// ignored.
void catch_signals();
bool stop_requested();

}  // namespace tdpt
