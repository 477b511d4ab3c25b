// The pinhole camera: maps pixels to directions and back, and gives its importance:
// libcommon/scene/film_plane.h in floats. Include where `render` is.

#include "shaders/shared/language.h"

/// Unit direction through the raster position (x, y).
SHARED vec3 camera_direction(float x, float y) MEMBER_CONST {
  float u = (2.0f * x * reciprocal(float(render.width)) - 1.0f) * render.half_width;
  float v = (1.0f - 2.0f * y * reciprocal(float(render.height))) * render.half_height;
  return normalized(render.camera_forward + render.camera_right * u + render.camera_up * v);
}

/// Raster position for unit `w` (away from the camera); false if it misses the film.
SHARED bool camera_raster(vec3 w, OUT(float) x, OUT(float) y) MEMBER_CONST {
  x = 0.0f;
  y = 0.0f;
  float c = dot(w, render.camera_forward);
  if (!(c > 1e-30f)) return false;
  float across = dot(w, render.camera_right) * reciprocal(c * render.half_width);
  float down = dot(w, render.camera_up) * reciprocal(c * render.half_height);
  float width = float(render.width);
  float height = float(render.height);
  x = 0.5f * width * (1.0f + across);
  y = 0.5f * height * (1.0f - down);
  return x >= 0.0f && x < width && y >= 0.0f && y < height;
}

/// Density of w if the raster position is uniform over the whole film [1/sr].
SHARED float camera_pdf_w(vec3 w) MEMBER_CONST {
  float c = max(dot(w, render.camera_forward), 1e-9f);
  return reciprocal(render.film_area * c * c * c);
}

#include "shaders/shared/language_end.h"
