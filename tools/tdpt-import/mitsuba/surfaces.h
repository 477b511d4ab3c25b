// Mitsuba's bsdfs as materials.
#pragma once
#include <map>

#include "tools/tdpt-import/mitsuba/object.h"
#include "tools/tdpt-import/mitsuba/textures.h"

namespace tdpt::foreign::mitsuba {

class Surfaces {
 public:
  Surfaces(Described& scene, Source& source, Textures& textures)
      : scene_(scene), source_(source), textures_(textures) {}

  struct Made {
    size_t material = 0;
    bool turned = false;     ///< the material is that of the surface's back
    bool one_sided = false;  ///< Mitsuba's is black on its back
  };
  /// Of a bsdf around a medium, or around nullptr.
  Made material(const Object& bsdf, const Object* interior);
  /// What Mitsuba gives to shapes without a bsdf.
  enum class Default { grey, black, invisible };
  Made material(Default without);

 private:
  struct Read {
    Material material;
    bool turned = false, two_sided = false;
    bool opaque = true;
  };
  using Reader = Read (Surfaces::*)(const Object&);

  Read read(const Object& bsdf);
  Read twosided(const Object& bsdf);
  Read plain(const Object& bsdf);
  Read coloured_plain(const Object& bsdf);
  Read plastic_like(const Object& bsdf);
  Read conductor_like(const Object& bsdf);
  Read glass_like(const Object& bsdf);
  Read mask(const Object& bsdf);
  Read bump(const Object& bsdf);
  Read blend(const Object& bsdf);
  Read mixture(const Object& bsdf);
  Read coated(const Object& bsdf);
  Read invisible(const Object& bsdf);
  Read principled(const Object& bsdf);

  Read nested(const Object& bsdf);
  double ior(const Object& bsdf, const char* name, const char* otherwise);
  double relative_ior(const Object& bsdf, const char* inside);
  Number alpha(const Object& bsdf);
  void lose(const Object& object, const std::string& sentence) {
    source_.lose(object.place, sentence);
  }
  void near_to(const Object& bsdf, const char* what);
  void absorb(const Object& medium, Read& surface);

  Described& scene_;
  Source& source_;
  Textures& textures_;
  std::map<std::pair<const Object*, const Object*>, Made> made_;
  std::map<Default, Made> defaults_;
};

}  // namespace tdpt::foreign::mitsuba
