// A preview picture while portals are being sought: bidirectional path tracing without them, small
// at first, then at the requested size with more and more samples. The final picture uses none of
// its samples.
#pragma once
#include <memory>
#include <string>

#include "libcommon/base/child_process.h"
#include "tools/tdpt/pipeline.h"

namespace tdpt {

class FirstLook {
 public:
  /// `folder` holds its files; it writes the PNG `preview`.
  FirstLook(const Arguments& a, const Request& request, const std::string& programs,
            const std::string& folder, const std::string& preview);

  /// Publishes a finished picture and starts the next. Call now and then.
  void tick();

 private:
  void begin();

  Words base_;
  std::string picture_, png_, preview_;
  int64_t width_, height_;  ///< of the picture [pixels]; 0: not said
  int64_t spp_ = 0;         ///< of the next picture; 0: it is the small one
  std::unique_ptr<ChildProcess> child_;
};

}  // namespace tdpt
