// The guest filter: Intel's Open Image Denoise, version 1.4 or later, if it is installed. It is
// loaded when it is asked for; nothing else depends on it.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libcommon/formats/picture.h"

namespace tdpt::denoise {

class OpenImageDenoise {
 public:
  /// Looks where the system's loader does, and in the folders of the Python package pyoidn. Throws
  /// Error that says how to get it.
  OpenImageDenoise();
  ~OpenImageDenoise();

  const std::string& version() const { return version_; }  ///< "2.5.1"

  /// The filtered pixels. Albedo and normal: of each pixel, without noise; empty: none. Throws
  /// Error if the library fails.
  std::vector<Rgb> filter(const Picture& noisy, const std::vector<Rgb>& albedo,
                          const std::vector<Rgb>& normal);

 private:
  struct Library;
  std::unique_ptr<Library> library_;
  std::string version_;
};

}  // namespace tdpt::denoise
