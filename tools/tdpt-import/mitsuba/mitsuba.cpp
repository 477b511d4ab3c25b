#include "tools/tdpt-import/mitsuba/mitsuba.h"

#include <fmt/format.h>

#include "libcommon/base/shown.h"
#include "tools/tdpt-import/mitsuba/lights.h"
#include "tools/tdpt-import/mitsuba/sensor.h"
#include "tools/tdpt-import/mitsuba/shapes.h"
#include "tools/tdpt-import/mitsuba/surfaces.h"
#include "tools/tdpt-import/mitsuba/xml.h"

namespace tdpt::foreign {

Described read_mitsuba(Source& source, const std::map<std::string, std::string>& parameters) {
  using namespace mitsuba;
  const Document document = parse(source, parameters);
  Described scene;
  Textures textures(scene, source);
  Surfaces surfaces(scene, source, textures);
  Shapes shapes(scene, source, textures, surfaces);
  for (const Value& v : document.scene->values) {
    if (!v.object) continue;  // what the scene itself is told, such as a name
    if (v.tag == "shape")
      shapes.add(*v.object);
    else if (v.tag == "emitter")
      add_light(*v.object, scene, source, textures);
    else if (v.tag == "sensor")
      add_camera(*v.object, scene, source);
    else if (v.tag == "subsurface")
      source.lose(v.place, "subsurface scattering is left out");
    // Others are how to render, or wait for a reference to them.
  }
  return scene;
}

}  // namespace tdpt::foreign
