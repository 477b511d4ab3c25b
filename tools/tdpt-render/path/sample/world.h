// What a picture is made of: a world, the view of it, and the openings that light comes in by.
#pragma once
#include <memory>

#include "libcommon/math/sequence.h"
#include "libcommon/scene/film_plane.h"
#include "libcommon/trace/tracer.h"
#include "tools/tdpt-render/path/light/next_event.h"

namespace tdpt {

/// What depends on neither camera nor portals.
struct World {
  World(const Scene& scene_, bool culls) : scene(scene_), tracer(scene_, culls), lights(scene_) {
    layered = !scene_.smooth.empty();
    for (const Material& m : scene_.materials)
      layered |= !m.plain, absorbing |= m.solid && max_component(m.absorption) > 0;
  }

  const Scene& scene;
  Tracer tracer;
  Lights lights;
  std::vector<RectLight> rect_lights = rect_lights_of(scene, LightSelection(lights));
  bool layered = false;    ///< some surface is more than diffuse about its geometric normal
  bool absorbing = false;  ///< some solid absorbs light
};

struct View {
  FilmPlane film;
  CameraBlur blur;  ///< of what the film sees
  /// What a sample sees by: blur takes three numbers.
  FilmPlane of_sample(Sequence& numbers) const {
    if (!blur.any()) return film;
    const auto [u, v, time] = numbers.uniforms<3>();
    return blur.draw(film, u, v, time);
  }
};

/// Portals, and how lights are selected with regard to them. The world must outlive it.
struct Openings {
  /// `shares`: of the kinds of light; none: by power. Tables of `before` are reused [WindowSky].
  Openings(const World& world, const std::vector<Portal>& given,
           const std::optional<Lights::KindProbabilities>& shares = {},
           const WindowSky& before = {})
      : portals(given, world.scene.frame),
        windows(world.scene.sky.get(), world.tracer, portals, before),
        selection(world.lights, shares,
                  portals.empty() || !world.lights.sky()
                      ? SkyDirections()
                      : SkyDirections(*world.scene.sky, [&](const Vec3d& towards) {
                          return portals.guide_total_along(-towards);
                        })) {}

  PortalSet portals;
  WindowSky windows;
  LightSelection selection;
};

/// What a picture shows. Pictures of one scene share its world.
struct Vista {
  Vista(std::shared_ptr<const World> world_, const Camera& camera, int width, int height,
        const std::vector<Portal>& portals, const WindowSky& before = {})
      : world(std::move(world_)),
        view{FilmPlane(camera, width, height), {}},
        openings(*world, portals, {}, before) {}
  /// With a world of its own.
  Vista(const Scene& scene, const Camera& camera, int width, int height,
        const std::vector<Portal>& portals)
      : Vista(std::make_shared<World>(scene, camera.culls), camera, width, height, portals) {}

  NextEvents next_events() const {
    return {openings.selection, openings.windows, world->rect_lights};
  }

  std::shared_ptr<const World> world;
  View view;
  Openings openings;
};

}  // namespace tdpt
