// Texels of a scene's images, and coverage (alpha) of the surfaces that are not opaque, in the
// layout of shaders/shared/coverage_layout.h.
#pragma once
#include <map>
#include <vector>

#include "libcommon/scene/scene.h"
#include "shaders/shared/coverage_layout.h"

namespace tdpt {

/// Images as words, each once.
class TexelWords {
 public:
  explicit TexelWords(const Scene& scene) : scene_(scene) {}

  /// The image of `map`, which has one, and how it is looked up.
  shader::TexelGrid grid_of(const TextureMap& map);

  std::vector<uint32_t> words;

 private:
  const Scene& scene_;
  std::map<int32_t, uint32_t> first_;
};

/// What an alpha test of floats takes for a texture coordinate: 0 for what is no number or beyond
/// 1e9 images [texture.h].
float texture_coordinate(double u);

struct CoverageTables {
  std::vector<uint32_t> coverage_of;        ///< of each triangle; empty when all are opaque
  std::vector<shader::Coverage> coverages;  ///< of the triangles that are not opaque
  std::vector<uint32_t> texels;             ///< of the images that they use

  /// Whether a texture says where some surface is.
  bool textured() const;
};

/// Panes count as opaque: their glass is open (open_glass()), or another table has them.
CoverageTables make_coverages(const Scene& scene);
/// The same without `texels`, which are put into `words`.
CoverageTables make_coverages(const Scene& scene, TexelWords& words);

}  // namespace tdpt
