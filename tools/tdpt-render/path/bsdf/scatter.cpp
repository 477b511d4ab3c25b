#include "tools/tdpt-render/path/bsdf/scatter.h"

// Flattened (inlined): each function then keeps only the part of the shared code that it needs.

namespace tdpt {

[[gnu::flatten]] Rgb layered_bsdf(const Point& p, Vec3d to_light, Vec3d to_camera) {
  return Rgb(surfaces().bsdf_at(p, to_light, to_camera));
}

double emission_under_coat(const Point& p, Vec3d w) {
  return surfaces().emission_under_coat(p, w);
}

[[gnu::flatten]] void Incidence::see_layers(const Point& p) {
  struct InPlace {  // converts to the context, so that emplace() builds it there
    operator shader::Surfaces::ScatterContext() const {
      return surfaces().scatter_context_at(p, back);
    }
    const Point& p;
    const Vec3d& back;
  };
  layers.emplace(InPlace{p, back});
}

[[gnu::flatten]] double layered_pdf_w(const Point& p, const Incidence& in, const Vec3d& to,
                                      bool dirac) {
  return surfaces().layered_pdf_w(p, *in.layers, to, dirac);
}

[[gnu::flatten]] double layered_albedo(const Point& p, const Incidence& in) {
  return surfaces().layered_albedo(p, *in.layers, in.back);
}

}  // namespace tdpt
