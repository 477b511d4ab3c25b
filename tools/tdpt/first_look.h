// A picture to look at while portals are being looked for: bidirectional path tracing without them,
// small at first, then in the size that was asked for with more and more samples. None of its
// samples is in the picture.
#pragma once
#include <memory>
#include <string>

#include "libcommon/base/child_process.h"
#include "tools/tdpt/pipeline.h"

namespace tdpt {

class FirstLook {
 public:
  /// `folder` holds what it makes, `preview` is what it writes, a PNG.
  FirstLook(const Arguments& a, const Request& request, const std::string& programs,
            const std::string& folder, const std::string& preview);

  /// Brings what is done to its place, and begins what comes next. Call now and then.
  void tick();

 private:
  void begin();

  Words base_;
  std::string picture_, png_, preview_;
  int64_t width_, height_;  ///< of the picture [pixels]; 0: not said
  int64_t spp_ = 0;         ///< of the next one; 0: it is the small one
  std::unique_ptr<ChildProcess> child_;
};

}  // namespace tdpt
