// Carries out the directives of a scene.
#pragma once
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "tools/tdpt-import/pbrt/geometry.h"
#include "tools/tdpt-import/pbrt/lights.h"
#include "tools/tdpt-import/pbrt/parameters.h"
#include "tools/tdpt-import/pbrt/surfaces.h"
#include "tools/tdpt-import/pbrt/textures.h"

namespace tdpt::foreign::pbrt {

/// pbrt's graphics state: what AttributeBegin saves and AttributeEnd brings back.
struct State {
  Affine to_world{};      ///< current transformation, at the shutter's opening
  bool is_active = true;  ///< transformations apply to the opening
  bool is_reversed = false;
  size_t surface = 0;  ///< current one of Painter
  std::shared_ptr<const AreaLight> area{};
  std::string inside{}, outside{};  ///< media
  /// pbrt-v4's "Attribute" of shape, light, material, medium, texture; shared until one is added.
  std::array<std::shared_ptr<const std::vector<Parameter>>, 5> attributes{};
};

class Builder;

struct Directive {
  const char* name;
  void (*run)(Builder&);
};

/// None if there is no such directive.
const Directive* directive_of(const std::string& name);

class Builder {
 public:
  Builder(Source& source, bool is_v4);
  Described run();

 private:
  friend struct Directives;
  enum class Saved { attributes, transform, object, import };
  struct Save {
    Saved kind;
    State state;
    Place place;
    size_t depth = 0;  // of an imported file
  };
  struct Entity {  // a directive that is carried out later
    std::string kind;
    Parameters list{};
  };

  // Of the tokens that follow.
  std::string name();
  double number();
  std::vector<double> numbers(size_t count);
  Parameters parameters(const Key& holder = {}) {
    return Parameters::read(tokens_, context_.source, holder, whose_);
  }
  Parameters parameters(size_t attribute, const Key& holder = {});
  /// Of an object that others may name: nobody misses what it holds before.
  Key waiting() { return context_.source.enter({}, tokens_.place(), ""); }

  void transform(const Affine& by);
  void set_transform(const Affine& to);
  void save(Saved kind);
  void restore(Saved kind, const char* directive);
  void end_imports();
  void finish_camera();
  void add_shape(const std::string& kind, const Parameters& list);
  void keep(Shape&& shape);
  std::optional<Emission> emission(const Geometry& geometry, const Affine& to_world);

  Context context_;
  Tokens tokens_;
  std::string directive_, whose_;  // that is carried out; with the last name after it
  State state_;
  std::vector<Save> saved_;
  std::map<std::string, Affine> systems_;  // CoordinateSystem
  std::map<std::string, std::vector<Shape>> objects_;
  std::optional<std::string> object_;  // being defined
  size_t shapes_ = 0;
  Textures textures_;
  Painter painter_;
  Geometries geometries_;
  Surfaces named_;
  std::map<std::string, size_t> painted_;  // named surfaces in painter_
  std::optional<Entity> camera_, film_;
  Affine camera_from_world_{};
  bool in_world_ = false, is_done_ = false;
};

}  // namespace tdpt::foreign::pbrt
