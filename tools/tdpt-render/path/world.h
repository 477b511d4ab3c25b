// What a path lives in.
#pragma once
#include "libcommon/scene/emitters.h"
#include "libcommon/scene/film_plane.h"
#include "libcommon/scene/scene.h"
#include "libcommon/trace/tracer.h"
#include "tools/tdpt-render/portals.h"

namespace tdpt {

struct World {
  World(const Scene& scene_, const Camera& camera, int width, int height,
        const std::vector<Portal>& portals_)
      : scene(scene_),
        tracer(scene_),
        emitters(scene_),
        film(camera, width, height),
        portals(portals_, scene_.frame) {}

  const Scene& scene;
  Tracer tracer;
  Emitters emitters;
  FilmPlane film;
  PortalSet portals;
};

}  // namespace tdpt
