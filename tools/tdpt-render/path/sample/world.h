// What a picture is made of: a world, the view of it, and the openings that light comes in by.
#pragma once
#include <memory>
#include <string>

#include "libcommon/math/sequence.h"
#include "libcommon/scene/film_plane.h"
#include "libcommon/trace/tracer.h"
#include "tools/tdpt-render/path/bsdf/scatter.h"
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
                          return portals.portal_guide_total(true, -towards, {}, shader::FROM_LIGHT);
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

// Turns a hit, or a place on a light, into a point of a path with its material.

/// Sets `p` to the place where a ray has hit.
void place_on_surface(const World& world, const Hit& hit, Point& p);

/// Sets `p` to the sky, where a ray along unit `w` leaves the scene, which must have a sky.
void place_in_sky(const LightSelection& selection, const Vec3d& w, Point& p);

/// Sets `p` to a place on a light. An emitter that is not opaque shines in proportion to its
/// coverage, since no ray decides here whether it is hit.
void place_on_light(const World& world, const Lights::Point& light, Point& p);

// Lamps that coincide with another surface: a light panel modelled in the plane of its ceiling, or
// a mesh that is there twice.
//
// Which of two coincident surfaces a ray hits is decided by rounding. Camera walks would hit such a
// lamp only sometimes, next events would always reach it, and integrators would differ in
// brightness. So the lamp is moved in front of the other surface by a hair; one that emits on both
// sides becomes two single-sided ones, in front of the other surface and behind it.

/// Emitting triangles that are covered: a ray to some point on an emitting side hits another
/// triangle there; if that emits too, the later of both counts. Tested with 8 to 256 rays each,
/// which depend on the seed: an overlap that few of them hit may be missed.
std::vector<uint32_t> covered_lamps(const Scene& scene, const Tracer& tracer, uint32_t seed);

struct OpenWorld {
  std::shared_ptr<const World> world;
  size_t uncovered = 0;  ///< triangles of the file that were moved
};
/// The world of the scene, with covered lamps moved along their normals until none is found.
OpenWorld open_world(Scene& scene, bool culls);

/// Reports how many triangles were moved, and how far.
std::string uncovered_sentence(size_t triangles, const Frame& frame);

}  // namespace tdpt
