#include "libcommon/base/process.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <memory>

#include <fcntl.h>
#include <oneapi/tbb/global_control.h>
#include <sys/resource.h>
#include <unistd.h>

#if defined(__x86_64__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

#include "libcommon/base/error.h"

namespace tdpt {

void open_standard_streams() {
  for (int fd = 0; fd <= 2; ++fd)
    if (::fcntl(fd, F_GETFD) < 0) (void)::open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY);
}

void limit_threads(int n) {
  static std::unique_ptr<tbb::global_control> control;
  if (n > 0)
    control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<size_t>(n));
}

double cpu_seconds() {
  timespec t{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

namespace {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Phases::Phases() : wall_(wall_seconds()), cpu_(cpu_seconds()) {}

void Phases::done(const std::string& name) {
  const double wall = wall_seconds(), cpu = cpu_seconds();
  auto phase =
      std::find_if(phases_.begin(), phases_.end(), [&](const Phase& p) { return p.name == name; });
  if (phase == phases_.end()) phase = phases_.insert(phase, {name, 0, 0});
  phase->seconds += wall - wall_;
  phase->cpu_seconds += cpu - cpu_;
  wall_ = wall;
  cpu_ = cpu;
}

int64_t peak_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return int64_t{usage.ru_maxrss} * 1024;
}

namespace {
volatile std::sig_atomic_t stopped = 0;
volatile int64_t stopped_at = 0;  // [ms]

int64_t milliseconds() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return int64_t{now.tv_sec} * 1000 + now.tv_nsec / 1000000;
}

void on_signal(int number) {
  if (!stopped) {
    stopped_at = milliseconds();
    stopped = 1;
  } else if (milliseconds() - stopped_at > 1000) {
    std::signal(number, SIG_DFL);
    std::raise(number);
  }
}
}  // namespace

void catch_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP})
    if (std::signal(number, on_signal) == SIG_IGN) std::signal(number, SIG_IGN);
}

bool stop_requested() {
  return stopped != 0;
}

namespace {

// Environment variable that keeps the GNU C library from using newer instructions.
constexpr const char* kTunables = "GLIBC_TUNABLES";
constexpr const char* kPlain = "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4";

std::string chosen = "native";

#if defined(__x86_64__)
void flush_denormals_now() {
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}
bool has(const std::string& isa) {
  if (isa == "avx512")
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512vl");
  if (isa == "avx2") return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (isa == "avx") return __builtin_cpu_supports("avx");
  if (isa == "sse4.2") return __builtin_cpu_supports("sse4.2");
  return isa == "sse2";
}
// Instruction sets for which Embree has code, newest first.
constexpr std::array kKnown{"avx512", "avx2", "avx", "sse4.2", "sse2"};
#else
void flush_denormals_now() {
#if defined(__aarch64__)
  uint64_t control = 0;  // its bit 24 has operands and results flushed
  asm volatile("mrs %0, fpcr" : "=r"(control));
  asm volatile("msr fpcr, %0" : : "r"(control | uint64_t{1} << 24));
#endif
}
bool has(const std::string&) {
  return false;
}
constexpr std::array<const char*, 0> kKnown{};
#endif

bool is_plain() {
  const char* tunables = std::getenv(kTunables);
  return tunables && std::strstr(tunables, kPlain);
}

}  // namespace

void choose_processor_code(const std::string& name, std::vector<std::string> arguments) {
  chosen = name;
  if (name == "native") return;
  if (!has(name)) throw Error(Exit::no_device, "--set isa=" + name + ": this processor lacks it");
  if (name != "sse2" || is_plain()) return;
  const char* before = std::getenv(kTunables);
  const std::string tunables = before && *before ? std::string(before) + ":" + kPlain : kPlain;
  ::setenv(kTunables, tunables.c_str(), 1);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  ::execv("/proc/self/exe", argv.data());
  throw Error(Exit::no_device,
              "--set isa=" + name + ": the program cannot be started anew with it");
}

std::string processor_code() {
  std::string code = chosen;
  if (code == "native") {
    code = "generic";
    for (const char* isa : kKnown)
      if (has(isa)) {
        code = isa;
        break;
      }
  }
  if (has("avx2") && !is_plain()) code += "+fma";
  return code;
}

void flush_denormals() {
  thread_local const bool done = [] {
    flush_denormals_now();
    return true;
  }();
  (void)done;
}

std::string embree_configuration() {
  return chosen == "native" ? "" : "isa=" + chosen;
}

}  // namespace tdpt
