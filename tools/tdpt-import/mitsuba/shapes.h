// Mitsuba's shapes as placed meshes.
#pragma once
#include <functional>
#include <map>
#include <set>

#include "tools/tdpt-import/mitsuba/surfaces.h"

namespace tdpt::foreign::mitsuba {

class Shapes {
 public:
  Shapes(Described& scene, Source& source, Textures& textures, Surfaces& surfaces)
      : scene_(scene), source_(source), textures_(textures), surfaces_(surfaces) {}

  /// A shape of the scene, with all that it holds.
  void add(const Object& shape) { place(shape, {}, false); }
  /// Whether an emitter makes a shape a portal.
  bool is_used(const Object& emitter) const { return portals_.contains(&emitter); }
  /// When all is read: names bodies that a camera sees from behind.
  void tell_backs();

 private:
  void place(const Object& shape, const Affine& outer, bool in_group);
  void place_instance(const Object& shape, const Affine& outer);
  std::optional<Shape> geometry(const Object& shape);
  std::optional<Shape> round_or_flat(const Object& shape);
  Shape from_file(const Object& shape);
  size_t mesh(const std::string& key, const std::function<Mesh()>& make);
  void dress(const Object& shape, Shape& out);

  Described& scene_;
  Source& source_;
  Textures& textures_;
  Surfaces& surfaces_;
  std::map<std::string, size_t> meshes_;
  std::set<size_t> with_normals_;                 ///< meshes whose files give normals
  std::vector<std::pair<Place, size_t>> bodies_;  ///< one-sided ones, with their shapes' indices
  std::map<size_t, size_t> green_down_;           ///< materials with their normal maps turned
  std::set<const Object*> portals_;               ///< emitters of shapes
  size_t visited_ = 0;
};

}  // namespace tdpt::foreign::mitsuba
