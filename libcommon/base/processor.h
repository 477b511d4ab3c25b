// Code that libraries choose by the processor they run on: Embree's rays and the mathematical
// functions of the C library. Either may round the last bit otherwise, so the same bytes are
// promised for the same code only.
#pragma once
#include <string>
#include <vector>

namespace tdpt {

/// From now on that of `name`: "native" (the default: the newest that the processor has), "avx2" or
/// "sse2" (the same on every 64-bit PC). For the C library to obey, the program starts anew with
/// the same arguments: call it before anything is read or written. Throws Error(Exit::no_device)
/// where the processor lacks it.
void choose_processor_code(const std::string& name, std::vector<std::string> arguments);

/// What runs now, of Embree and of the C library: "avx512+fma", "sse2"; "generic" where nothing is
/// chosen.
std::string processor_code();

/// From now on numbers below the least normal one are 0 on this thread, as operand and as result:
/// they slow Embree down. Costs nothing the second time.
void flush_denormals();

/// Embree's configuration for it.
std::string embree_configuration();

}  // namespace tdpt
