// For tests: planted faults. Samples are drawn correctly, but their density is wrong.
#pragma once
#include "libcommon/scene/lights.h"
#include "tools/tdpt-render/portals/portals.h"

namespace tdpt {

struct PortalSetFaults {
  /// `factor` times the density of all segments.
  static PortalSet scaled(PortalSet set, double factor) {
    set.tables_ = std::make_shared<PortalSet::Tables>(*set.tables_);
    for (auto& f : set.tables_->facets) f.density *= factor;
    for (auto& pair : set.tables_->pairs) pair.pdf *= factor;
    return set;
  }
  /// Knows of no sample that was drawn in a surround.
  static PortalSet without_surrounds(PortalSet set) {
    set.tables_ = std::make_shared<PortalSet::Tables>(*set.tables_);
    for (auto& f : set.tables_->facets) f.surround = 0;
    return set;
  }
  /// `factor` times that of segments to +x (along_x = 1) or to -x (-1).
  static void scale_one_way(PortalSet& set, double along_x, double factor) {
    set.tables_ = std::make_shared<PortalSet::Tables>(*set.tables_);
    for (auto& f : set.tables_->facets)
      if (f.normal.x * along_x > 0) f.density *= factor;
  }
};

struct LightsFaults {
  /// `factor` times the density of the sky's directions.
  static void scale_sky(LightSelection& selection, double factor) {
    selection.sky_pdf_1_ *= factor;
  }
};

}  // namespace tdpt
