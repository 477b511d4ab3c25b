#include "libcommon/scene/emitters.h"

#include <numbers>

namespace tdpt {

Emitters::Emitters(const Scene& scene) : scene_(scene), pdf_A_(scene.triangles.size(), 0.0f) {
  std::vector<double> weights;
  for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
    const Material& m = scene.material_of(t);
    const double y = luminance(m.emission);
    if (y <= 0) continue;
    const double sides = m.double_sided ? 2 : 1;
    triangles_.push_back(t);
    weights.push_back(sides * std::numbers::pi * y * shape_of(scene, t).area);
    power_ += weights.back();
  }
  if (triangles_.empty()) return;
  table_ = AliasTable(weights);
  for (uint32_t i = 0; i < triangles_.size(); ++i) {
    const uint32_t t = triangles_[i];
    pdf_A_[t] = static_cast<float>(table_.pdf_1(i) / shape_of(scene, t).area);
  }
}

Emitters::Sample Emitters::sample(Rng& rng) const {
  const double pick = rng.uniform();
  const double u = rng.uniform();
  const double v = rng.uniform();
  const double side = rng.uniform();
  const uint32_t t = triangles_[table_.sample(pick)];
  const TriangleShape s = shape_of(scene_, t);
  double b1, b2;
  uniform_triangle(u, v, b1, b2);
  const bool back = scene_.material_of(t).double_sided && side < 0.5;
  return {t, s.p0 + s.e1 * b1 + s.e2 * b2, back ? -s.normal : s.normal, pdf_A_[t]};
}

}  // namespace tdpt
