// Sampling techniques as data: which of them an integrator combines decides every MIS weight.
#pragma once
#include <array>
#include <cstdint>

namespace tdpt {

enum class Technique : uint8_t { camera, direct, light, bi, portal };
constexpr int kTechniques = 5;
constexpr std::array<const char*, kTechniques> kTechniqueNames{"camera", "direct", "light", "bi",
                                                               "portal"};

class TechniqueSet {
 public:
  template <class... T>
  constexpr explicit TechniqueSet(T... members)
      : bits_(static_cast<uint8_t>((0u | ... | (1u << static_cast<int>(members))))) {}
  constexpr bool has(Technique t) const { return (bits_ >> static_cast<int>(t)) & 1u; }

 private:
  uint8_t bits_;
};

}  // namespace tdpt
