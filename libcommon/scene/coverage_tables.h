// Texels of a scene's images, and coverage (alpha) of surfaces that are not opaque, in the layout
// of shaders/shared/coverage_layout.h.
#pragma once
#include <map>
#include <vector>

#include "libcommon/scene/scene.h"
#include "shaders/shared/coverage_layout.h"

namespace tdpt {

/// Images packed into words, each stored once.
class TexelWords {
 public:
  explicit TexelWords(const Scene& scene) : scene_(scene) {}

  /// Where the image of `map`, which must have one, is stored and how it is looked up.
  shader::TexelGrid grid_of(const TextureMap& map);

  std::vector<uint32_t> words;

 private:
  const Scene& scene_;
  std::map<int32_t, uint32_t> first_;
};

/// The texture coordinate used by an alpha test in floats: 0 for NaN, infinities and anything
/// beyond 1e9 images [texture.h].
float texture_coordinate(double u);

struct CoverageTables {
  std::vector<uint32_t> coverage_of;        ///< per triangle; empty when all are opaque
  std::vector<shader::Coverage> coverages;  ///< of the triangles that are not opaque
  std::vector<uint32_t> texels;             ///< of the images that they use

  /// Whether the coverage of some surface depends on a texture.
  bool textured() const;
};

/// Panes count as opaque: either their glass has been opened (open_glass()), or another table holds
/// them.
CoverageTables make_coverages(const Scene& scene);
/// The same, but the texels are added to `words` instead.
CoverageTables make_coverages(const Scene& scene, TexelWords& words);

}  // namespace tdpt
