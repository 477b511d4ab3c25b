// What a build may know before it sees a scene. Of tdpt-render nothing; its twin
// tdpt-render-diffuse, which bench/only-needed.sh holds it against, knows that every surface is
// diffuse about its own normal.
#pragma once

namespace tdpt {

#ifdef TDPT_DIFFUSE_ONLY
/// A bool that is always `kAlways`: what asks for it compiles to nothing.
template <bool kAlways>
struct Known {
  constexpr Known(bool = kAlways) {}
  constexpr operator bool() const { return kAlways; }
};
#else
template <bool>
using Known = bool;
#endif

}  // namespace tdpt
