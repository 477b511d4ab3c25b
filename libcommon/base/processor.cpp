#include "libcommon/base/processor.h"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include <unistd.h>
#if defined(__x86_64__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

#include "libcommon/base/error.h"

namespace tdpt {
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
