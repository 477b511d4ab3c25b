// What all parts of the reader of pbrt's scenes share.
#pragma once
#include <map>
#include <string>

#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/source.h"

namespace tdpt::foreign::pbrt {

struct Context {
  Context(Source& scene_source, bool is_v4) : source(scene_source), v4(is_v4) {}

  Source& source;
  bool v4;  ///< pbrt-v4, else pbrt-v3
  Described scene{};
  std::optional<Sky> portals_sky{};  ///< of the first infinite light with a portal

  /// The picture of this file, read once.
  size_t image(const std::string& name, const Place& place);
  /// Whether it is anywhere transparent.
  bool has_alpha(size_t image);

 private:
  std::map<std::string, size_t> images_{};
  std::map<size_t, bool> has_alpha_{};
};

}  // namespace tdpt::foreign::pbrt
