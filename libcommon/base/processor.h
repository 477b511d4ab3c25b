// Selects the instruction set of libraries that dispatch on the processor: Embree and the C
// library's mathematical functions. Different code may round the last bit differently, so identical
// bytes are promised for the same instruction set only.
#pragma once
#include <string>
#include <vector>

namespace tdpt {

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
