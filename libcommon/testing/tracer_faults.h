// For tests: rays that step off surfaces farther than they do, or less far.
#pragma once
#include "libcommon/trace/tracer.h"

namespace tdpt {

struct TracerFaults {
  static void scale_step(Tracer& tracer, double scale) { tracer.offset_scale_ = scale; }
};

}  // namespace tdpt
