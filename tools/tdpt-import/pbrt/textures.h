// Named textures, and parameters that are a texture or a value.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "tools/tdpt-import/pbrt/context.h"
#include "tools/tdpt-import/pbrt/parameters.h"

namespace tdpt::foreign::pbrt {

class Textures {
 public:
  /// `type`: "float", "spectrum" or "color"; `kind`: "imagemap", "scale", ...; `key` is
  /// taken when something names the texture.
  void make(Context& context, const std::string& name, const std::string& type,
            const std::string& kind, const Parameters& list, const Key& key);

  Colour colour(Context& context, const Parameters& list, const std::string& name,
                const Rgb& absent, Use use = Use::reflectance) const;
  Number number(Context& context, const Parameters& list, const std::string& name,
                double absent) const;
  std::optional<Number> number(Context& context, const Parameters& list,
                               const std::string& name) const;

 private:
  std::string named(const Parameters& list, const std::string& name) const;
  template <class Value>
  Value made(Context& context, const std::string& kind, const Parameters& list);
  template <class Value>
  Value get(Context& context, const Parameters& list, const std::string& name, double absent) const;

  std::map<std::string, Colour> colours_;
  std::map<std::string, Number> numbers_;
  std::map<std::string, Key> keys_;
  std::map<std::string, size_t> depths_;  // of textures that are made of others
  mutable size_t below_ = 0;              // greatest depth that was asked for since make() began
};

/// A file's picture at the coordinates of the mesh, as an "imagemap" has it. `srgb`: see Texture.
Texture picture(Context& context, const std::string& file, const Place& place, bool srgb);

}  // namespace tdpt::foreign::pbrt
