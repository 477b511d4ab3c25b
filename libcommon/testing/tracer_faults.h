// For tests: changes how far ray origins are offset from surfaces.
#pragma once
#include "libcommon/trace/tracer.h"

namespace tdpt {

struct TracerFaults {
  static void scale_step(Tracer& tracer, double scale) { tracer.offset_scale_ = scale; }
};

}  // namespace tdpt
