// Surfaces and textures of Tungsten. Internal to this room.
#pragma once
#include <map>

#include "tools/tdpt-import/tungsten/json.h"

namespace tdpt::foreign::tungsten {

class Surfaces {
 public:
  Surfaces(Described& scene, const std::optional<Node>& bsdfs);

  /// Index of the material that a "bsdf" means: by name, or on the spot.
  size_t material(const std::optional<Node>& bsdf);
  /// A constant, a file's name or a texture.
  Colour colour(const Node& node);
  Number number(const Node& node);
  /// An image of the scene's files, once for each name.
  size_t image(const Node& node, const std::string& name);

 private:
  Material read(const Node& bsdf, int depth);
  Material read_nested(const Node& bsdf, int depth);
  Colour albedo(const Node& bsdf);
  Number roughness(const Node& bsdf, double otherwise);
  double ior(const Node& bsdf);
  Material of_type(const std::string& type, const Node& bsdf, int depth);
  Material inner(const Node& bsdf, const char* key, int depth);
  Material conductor_of(const Node& bsdf, const Number& alpha);
  Material plastic_of(const Node& bsdf, const Number& alpha);
  Material glass_of(const Node& bsdf, const Number& alpha);
  Material sheet_of(const Node& bsdf);
  Material transparent(const Node& bsdf, int depth);
  Material coated(const Node& bsdf, const Number& alpha, int depth);
  Material heavier(const Node& bsdf, int depth);
  std::optional<Texture> texture(const Node& node, Rgb& constant);
  Texture checker(const Node& node);

  Described& scene_;
  std::map<std::string, Node> named_;
  std::map<std::string, size_t> made_, images_;
  std::optional<size_t> plain_;
};

}  // namespace tdpt::foreign::tungsten
