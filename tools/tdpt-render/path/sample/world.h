// Scene, acceleration structure, lights, portals and camera, shared by all samples.
#pragma once
#include "libcommon/scene/camera_blur.h"
#include "libcommon/scene/lights.h"
#include "libcommon/scene/scene.h"
#include "libcommon/trace/tracer.h"
#include "tools/tdpt-render/path/light/next_event.h"
#include "tools/tdpt-render/portals/portals.h"

namespace tdpt {

struct World {
  World(const Scene& scene_, const Camera& camera, int width, int height,
        const std::vector<Portal>& portals_)
      : scene(scene_), tracer(scene_, camera.culls), lights(scene_), film(camera, width, height) {
    layered = !scene_.smooth.empty();
    for (const Material& m : scene_.materials) {
      layered = layered || !m.plain;
      absorbing = absorbing || (m.solid && max_component(m.absorption) > 0);
    }
    fill_openings(PortalSet(portals_, scene_.frame));
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Replaces the portals.
  void fill_openings(PortalSet set) {
    portals = std::move(set);
    windows = WindowSky(scene.sky.get(), tracer, portals, windows);
    if (portals.empty())
      lights.prefer(nullptr);
    else
      lights.prefer([this](const Vec3d& towards) { return portals.guide_total_along(-towards); });
  }

  const Scene& scene;
  Tracer tracer;
  Lights lights;
  FilmPlane film;
  CameraBlur blur;    ///< of what the film sees
  PortalSet portals;  ///< changed by fill_openings() and, temporarily, during exploration
  WindowSky windows;
  NextEvents next_events{scene, lights, windows};
  bool layered = false;    ///< some surface is more than diffuse about its geometric normal
  bool absorbing = false;  ///< some solid absorbs light
};

}  // namespace tdpt
