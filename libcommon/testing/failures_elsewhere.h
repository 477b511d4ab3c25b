// For tests of z_failure.h: sends failures to a temporary folder.
#pragma once
#include <cstdlib>

#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::testing {

class FailuresElsewhere {
 public:
  FailuresElsewhere() {
    if (const char* before = std::getenv("TDPT_FAILURES")) before_ = before;
    setenv("TDPT_FAILURES", folder().c_str(), 1);
  }
  ~FailuresElsewhere() {
    if (before_.empty())
      unsetenv("TDPT_FAILURES");
    else
      setenv("TDPT_FAILURES", before_.c_str(), 1);
  }
  FailuresElsewhere(const FailuresElsewhere&) = delete;
  FailuresElsewhere& operator=(const FailuresElsewhere&) = delete;

  /// Created by the first failure.
  std::filesystem::path folder() const { return parent_.path / "failures"; }

 private:
  const TempFolder parent_;
  std::string before_;
};

}  // namespace tdpt::testing
