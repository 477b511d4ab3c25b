#include "tools/tdpt-render/path/sample/guide.h"

namespace tdpt::shader {

// Flattened (inlined): facets are large, and each function needs little of one.

[[gnu::flatten]] Guide::CrossingDensity Guide::crossing(const Point& a, const Point& b,
                                                        uint64_t& tests, const Drawn& drawn) const {
  if (!has_crossing(a, b)) return {};
  ++tests;
  return edge_crossing(a, b, drawn);
}

[[gnu::flatten]] void Guide::set_totals_at_surface(const Vec3d& away, Vertex& v) const {
  v.guide_totals = guide_totals_at_surface(v, away);
}

[[gnu::flatten]] double Guide::mixed_pdf_A(From from, const Vertex& at, const Incidence* in,
                                           const Edge& e, const Point& to, double plain_A,
                                           const CrossingDensity& crossing) const {
  return guided_pdf_A(static_cast<uint>(from), at, at.guide_totals, in, plain_A,
                      to.cosine(e.w) / e.d2, crossing);
}

}  // namespace tdpt::shader
