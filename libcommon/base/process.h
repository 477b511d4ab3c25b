// This process: its streams, its threads, where its time goes, the signals it gets, the
// instructions it uses.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace tdpt {

/// Opens the standard streams that are closed, so that no file that the program opens takes their
/// place: the wrong way round, so that whoever reads or writes one still fails.
void open_standard_streams();

/// Caps TBB (and with it Embree and OpenVDB) at `n` threads for the rest of the process;
/// n = 0: all cores. Call once, before any parallel work.
void limit_threads(int n);

/// CPU seconds of the whole process, all threads.
double cpu_seconds();

/// Consecutive phases by name, from the start of the clock; phases of the same name are summed.
class Phases {
 public:
  struct Phase {
    std::string name;
    double seconds;      ///< on the wall
    double cpu_seconds;  ///< of all threads of the process
  };

  Phases();

  /// Ends the phase that began when the last one ended.
  void done(const std::string& name);

  /// In order of their first appearance.
  const std::vector<Phase>& all() const { return phases_; }

 private:
  double wall_, cpu_;
  std::vector<Phase> phases_;
};

/// Peak memory of the process so far [bytes].
int64_t peak_memory();

/// {"NAME": {"seconds": S, "cpu_seconds": C}, ...} for any of nlohmann's JSON types.
template <class Json>
void to_json(Json& j, const Phases& phases) {
  j = Json::object();
  for (const Phases::Phase& p : phases.all()) {
    j[p.name]["seconds"] = p.seconds;
    j[p.name]["cpu_seconds"] = p.cpu_seconds;
  }
}

// Ctrl-C and the like: a long run polls a flag, finishes what it holds and exits 6.

/// From now on SIGINT, SIGTERM and SIGHUP only set a flag. A second signal ends the process at once
/// if it comes a second later or more; earlier it counts as the same one, since a group of
/// processes gets it and Make passes it on again. Signals that the caller ignores (nohup) stay
/// ignored.
void catch_signals();
bool stop_requested();

// Selects the instruction set of libraries that dispatch on the processor: Embree and the C
// library's mathematical functions. Different code may round the last bit differently, so identical
// bytes are promised for the same instruction set only.

/// Uses the code of `name` from now on: "native" (default: the newest that the processor has),
/// "avx2" or "sse2" (the same on every 64-bit PC). For the C library to obey, the program restarts
/// itself with the same arguments: call this before anything is read or written. Throws
/// Error(Exit::no_device) if the processor lacks it.
void choose_processor_code(const std::string& name, std::vector<std::string> arguments);

/// What is in use, Embree's and the C library's: "avx512+fma", "sse2"; "generic" where there is no
/// choice.
std::string processor_code();

/// Flushes denormal operands and results to 0 on this thread from now on: they slow Embree down. A
/// second call is free.
void flush_denormals();

/// Embree's configuration string for it.
std::string embree_configuration();

}  // namespace tdpt
