#include "tools/tdpt-render/path/bsdf/surface_curves.h"

#include <cmath>

#include "libcommon/scene/srgb.h"
#include "shaders/shared/path/surface_layout.h"
#include "tools/tdpt-render/path/bsdf/interface_albedo.h"
#include "tools/tdpt-render/path/bsdf/sheen.h"

namespace tdpt {
namespace {

using namespace shader;

double node(uint32_t i, uint32_t nodes) {
  return static_cast<double>(i) / (nodes - 1);
}

class Curves {
 public:
  std::vector<float> build() {
    curves_.reserve(kSurfaceCurves);
    add_interface();
    add_sheen([](double mu, double alpha) { return sheen::unscaled_albedo(mu, alpha); });
    add_sheen([](double mu, double alpha) { return sheen::albedo(mu, alpha); });
    for (const float light : linear_of_srgb()) curves_.push_back(light);
    add_gauss();
    return std::move(curves_);
  }

 private:
  void add(double x) { curves_.push_back(static_cast<float>(x)); }

  void add_interface() {
    const auto add_albedo = [this](const InterfaceAlbedo& e) { add(e.a), add(e.b); };
    for (uint32_t k = 0; k < kInterfaceAlphas; ++k)
      for (uint32_t i = 0; i < kInterfaceCosines; ++i)
        add_albedo(interface_albedo(std::pow(node(i, kInterfaceCosines), 4),
                                    std::pow(node(k, kInterfaceAlphas), 4)));
    // The row of alpha 0 is the mean of its interpolant, and not of the curve itself.
    for (uint32_t k = 0; k < kInterfaceAlphas; ++k)
      add_albedo(
          interface_albedo_average(std::max(std::pow(node(k, kInterfaceAlphas), 4), 1e-300)));
  }

  template <class Albedo>
  void add_sheen(Albedo albedo) {
    for (uint32_t k = 0; k < kSheenRoughnesses; ++k) {
      const double least = sheen::kLeastRoughness;
      const double roughness = least + (1 - least) * node(k, kSheenRoughnesses);
      for (uint32_t i = 0; i < kSheenCosines; ++i)
        add(albedo(std::pow(node(i, kSheenCosines), 3), roughness * roughness));
    }
  }

  // Gauss-Legendre of 12 nodes.
  void add_gauss() {
    constexpr double nodes[kGaussNodes]{0.1252334085114689, 0.3678314989981802, 0.5873179542866175,
                                        0.7699026741943047, 0.9041172563704749, 0.9815606342467193};
    constexpr double weights[kGaussNodes]{0.2491470458134028, 0.2334925365383548,
                                          0.2031674267230659, 0.1600783285433462,
                                          0.1069393259953184, 0.0471753363865118};
    for (uint32_t i = 0; i < kGaussNodes; ++i) add(0.5 * nodes[i]), add(0.5 * weights[i]);
  }

  std::vector<float> curves_;
};

}  // namespace

std::vector<float> make_surface_curves() {
  return Curves().build();
}

}  // namespace tdpt
