// What a path lives in.
#pragma once
#include "libcommon/scene/film_plane.h"
#include "libcommon/scene/lights.h"
#include "libcommon/scene/scene.h"
#include "libcommon/trace/tracer.h"
#include "tools/tdpt-render/portals.h"

namespace tdpt {

struct World {
  World(const Scene& scene_, const Camera& camera, int width, int height,
        const std::vector<Portal>& portals_)
      : scene(scene_),
        tracer(scene_),
        lights(scene_),
        film(camera, width, height),
        portals(portals_, scene_.frame) {
    for (const Material& m : scene_.materials)
      absorbing |= m.solid && max_component(m.absorption) > 0;
  }

  const Scene& scene;
  Tracer tracer;
  Lights lights;
  FilmPlane film;
  PortalSet portals;
  bool absorbing = false;  ///< some solid takes light away on the way through
};

}  // namespace tdpt
