#include "tools/tdpt-import/pbrt/context.h"

#include <algorithm>

#include "tools/tdpt-import/images.h"

namespace tdpt::foreign::pbrt {

size_t Context::image(const std::string& name, const Place& place) {
  const auto [it, is_new] = images_.try_emplace(name, scene.images.size());
  if (is_new) {
    Image image;
    image.name = name;
    image.bytes = source.read_picture(name, place);
    scene.images.push_back(std::move(image));
  }
  return it->second;
}

bool Context::has_alpha(size_t image) {
  const auto [it, is_new] = has_alpha_.try_emplace(image, false);
  if (is_new) {
    const Texels texels =
        decode(scene.images[image].bytes, source.shown_name(scene.images[image].name));
    it->second =
        std::any_of(texels.alpha.begin(), texels.alpha.end(), [](float a) { return a < 1; });
  }
  return it->second;
}

}  // namespace tdpt::foreign::pbrt
