// Importance-samples the sky through the portals, from any point of the camera's side, so that next
// events find the bright parts that a window shows.
//
// Method: portal-masked environment map sampling (Bitterli, Wyman and Pharr 2015; in pbrt-v4 as
// PortalImageInfiniteLight). Each facet of a portal [portals.h] has a bounding rectangle, with axes
// x, y in its plane and z out towards the sky. The sky is resampled over
//   a = c(w_x / w_z),  b = c(w_y / w_z),  c(t) = t / (1 + |t|) in (-1, 1),
// in which the rectangle stays a rectangle as seen from any point; sums over it are look-ups in a
// summed-area table. (The paper's c is the arc tangent, which is as uniform and slower.) A cell
// holds the luminance of the sky there times solid angle.
//
// As points on a portal, directions are drawn through the rectangle, or with a small share e
// through a surround that is larger on all sides [portals.h], so that sky seen beside a portal is
// sampled.
//
// S_F(x)  (1-e) times the light of the sky seen from x through the rectangle of facet F, plus e
// times
//         that through its surround; 0 behind it, if all of it is below the horizon of the surface
//         at x, and if walls are between
// W_F(w)  content of the cell of w over its size, da db
//   pdf_w(w) = sum over the F whose surround the ray (x, w) crosses of
//              (e + (1-e) if it crosses the rectangle) W_F(w) (da db / dw) / sum_F S_F(x)
//
// Directions beside the polygon in its rectangle, or hidden, are wasted. The table is an estimate:
// radiance is taken from the sky itself, and small bright parts are spread over the cells around,
// so that no cell that they touch counts as dark.
//
// Contents of cells are whole numbers. A sum over a rectangle is assembled from its four corners,
// four sides and interior, none of which is a difference of floats: even beside a sun in the same
// table the faintest part keeps its digits.
//
// Include after lights.h, in a scope that has what that needs, load_sky_window(),
// load_window_frame() and scene_has_windows. C++ also has SkyWindow and WindowFrame in doubles.

#include "shaders/shared/language.h"

/// A window's rectangle as seen from a point, in cells.
struct CellRect {
  REAL a0;
  REAL a1;
  REAL b0;
  REAL b1;
};

struct WindowView {
  CellRect rect;
  CellRect surround;
  REAL in_rect;  ///< the part of S_F through the rectangle alone
  REAL seen;     ///< S_F; if it is 0, the others have no meaning
};

SHARED VEC3 to_frame(IN(WindowFrame) frame, VEC3 v) MEMBER_CONST {
  return VEC3(dot(frame.x, v), dot(frame.y, v), dot(frame.z, v));
}

/// c(x / z) in cells, z > 0.
SHARED REAL in_cells(IN(WindowFrame) frame, REAL x, REAL z) MEMBER_CONST {
  return (x * reciprocal(z + abs(x)) + 1.0f) * (0.5f * REAL(frame.cells));
}

/// Whether `at` (in the frame) is inside and a corner of the surround is above the horizon.
SHARED bool sees_window(IN(SkyWindow) window, IN(WindowFrame) frame, VEC3 at,
                        VEC3 facing) MEMBER_CONST {
  REAL height = window.z - at.z;
  if (!(height > kPlaneMargin)) return false;
  if (is_zero(facing)) return true;
  VEC3 front = to_frame(frame, facing);
  REAL x = kSurroundMargin * (window.x1 - window.x0);
  REAL y = kSurroundMargin * (window.y1 - window.y0);
  return front.x * ((front.x > 0.0f ? window.x1 + x : window.x0 - x) - at.x) +
             front.y * ((front.y > 0.0f ? window.y1 + y : window.y0 - y) - at.y) +
             front.z * height >
         0.0f;
}

/// The sampled rectangle of a window, larger by a share of each side at either end: slightly
/// smaller, so that the density finds every sample in it.
SHARED CellRect rect_of(IN(SkyWindow) window, IN(WindowFrame) frame, VEC3 at,
                        REAL larger) MEMBER_CONST {
  REAL height = window.z - at.z;
  REAL margin = ROUNDING * REAL(frame.cells);
  REAL x = larger * (window.x1 - window.x0);
  REAL y = larger * (window.y1 - window.y0);
  CellRect r = {in_cells(frame, window.x0 - x - at.x, height) + margin,
                in_cells(frame, window.x1 + x - at.x, height) - margin,
                in_cells(frame, window.y0 - y - at.y, height) + margin,
                in_cells(frame, window.y1 + y - at.y, height) - margin};
  return r;
}

SHARED uint cell_at(IN(WindowFrame) frame, REAL a) MEMBER_CONST {
  return min(uint(max(a, 0.0f)), frame.cells - 1u);
}

/// Total of whole cells in columns [i, k), rows [j, l).
SHARED uint whole_content(IN(WindowFrame) frame, uint i, uint k, uint j, uint l) MEMBER_CONST {
  uint low = i * (frame.cells + 1u);
  uint high = k * (frame.cells + 1u);
  return (window_sum(frame, high + l) - window_sum(frame, high + j)) -
         (window_sum(frame, low + l) - window_sum(frame, low + j));
}
/// The same between b0 and b1, not whole rows.
SHARED REAL content_of_columns(IN(WindowFrame) frame, uint i, uint k, REAL b0,
                               REAL b1) MEMBER_CONST {
  uint j = cell_at(frame, b0);
  uint l = cell_at(frame, b1);
  REAL first = REAL(whole_content(frame, i, k, j, j + 1u));
  if (j == l) return first * (b1 - b0);
  REAL last = REAL(whole_content(frame, i, k, l, l + 1u));
  REAL middle = REAL(whole_content(frame, i, k, j + 1u, l));
  return first * (REAL(j + 1u) - b0) + middle + last * (b1 - REAL(l));
}
SHARED REAL content_of_rect(IN(WindowFrame) frame, CellRect r) MEMBER_CONST {
  if (!(r.a0 < r.a1 && r.b0 < r.b1)) return 0.0f;
  uint i = cell_at(frame, r.a0);
  uint k = cell_at(frame, r.a1);
  REAL first = content_of_columns(frame, i, i + 1u, r.b0, r.b1);
  if (i == k) return first * (r.a1 - r.a0);
  REAL last = content_of_columns(frame, k, k + 1u, r.b0, r.b1);
  REAL middle = content_of_columns(frame, i + 1u, k, r.b0, r.b1);
  return first * (REAL(i + 1u) - r.a0) + middle + last * (r.a1 - REAL(k));
}

SHARED WindowView view_of_window(uint i, VEC3 position, VEC3 facing) MEMBER_CONST {
  IN(SkyWindow) window = load_sky_window(i);
  IN(WindowFrame) frame = load_window_frame(window.frame);
  VEC3 at = to_frame(frame, position);
  CellRect none = {0.0f, 1.0f, 0.0f, 1.0f};
  WindowView view = {none, none, 0.0f, 0.0f};
  if (!sees_window(window, frame, at, facing)) return view;
  view.rect = rect_of(window, frame, at, 0.0f);
  view.surround = rect_of(window, frame, at, kSurroundMargin);
  view.in_rect = (1.0f - REAL(kSurroundShare)) * content_of_rect(frame, view.rect) * frame.unit;
  view.seen = view.in_rect + kSurroundShare * content_of_rect(frame, view.surround) * frame.unit;
  return view;
}

/// Sum S_F of the sky that all windows show from `position` to a surface that faces `facing` (0:
/// both ways).
SHARED REAL seen_through_windows(VEC3 position, VEC3 facing) MEMBER_CONST {
  REAL sum = 0.0f;
  for (uint rest = windows_in_view(position); rest != 0u; rest &= rest - 1u)
    sum += view_of_window(uint(findLSB(rest)), position, facing).seen;
  return sum;
}

/// Content of columns [i, k) between r.b0 and r.b1; `rows`: of rows [i, k) of one column.
SHARED REAL content_along(IN(WindowFrame) frame, bool rows, uint column, CellRect r, uint i,
                          uint k) MEMBER_CONST {
  if (rows) return REAL(whole_content(frame, column, column + 1u, i, k));
  return content_of_columns(frame, i, k, r.b0, r.b1);
}
/// Importance-samples a: the content from a0 to it, between b0 and b1, is `share` of that up to a1.
/// `rows`: samples b likewise, down one column.
SHARED REAL drawn_along(IN(WindowFrame) frame, bool rows, uint column, CellRect r,
                        REAL share) MEMBER_CONST {
  REAL begin = rows ? r.b0 : r.a0;
  REAL end = rows ? r.b1 : r.a1;
  uint first = cell_at(frame, begin);
  uint low = first;
  uint high = cell_at(frame, end);
  if (low == high) return begin + (end - begin) * share;
  REAL of_first =
      content_along(frame, rows, column, r, first, first + 1u) * (REAL(first + 1u) - begin);
  REAL all =
      rows ? content_of_columns(frame, column, column + 1u, r.b0, r.b1) : content_of_rect(frame, r);
  REAL wanted = share * all;
  // The last cell that `wanted` reaches, and the content before it.
  REAL before = 0.0f;
  while (low < high) {
    uint middle = (low + high + 1u) >> 1;
    REAL sum = of_first + content_along(frame, rows, column, r, first + 1u, middle);
    bool reached = sum <= wanted;
    before = reached ? sum : before;
    low = reached ? middle : low;
    high = reached ? high : middle - 1u;
  }
  REAL from = max(REAL(low), begin);
  REAL to = min(REAL(low + 1u), end);
  REAL content = content_along(frame, rows, column, r, low, low + 1u);
  REAL within = content > 0.0f ? (wanted - before) * reciprocal(content) : 0.0f;
  return min(from + max(within, 0.0f), to);
}

/// Unit direction towards the sky; `seen` is that of `position` and must be positive. Three numbers
/// in [0,1).
SHARED VEC3 towards_window(VEC3 position, VEC3 facing, REAL seen, REAL pick, REAL u,
                           REAL v) MEMBER_CONST {
  REAL left = pick * seen;
  uint chosen = 0u;
  CellRect of_chosen = {0.0f, 1.0f, 0.0f, 1.0f};
  for (uint rest = windows_in_view(position); rest != 0u && left >= 0.0f; rest &= rest - 1u) {
    uint i = uint(findLSB(rest));
    WindowView view = view_of_window(i, position, facing);
    if (!(view.seen > 0.0f)) continue;
    chosen = i;
    if (left < view.in_rect)
      of_chosen = view.rect;
    else
      of_chosen = view.surround;
    left = left < view.seen ? -1.0f : left - view.seen;
  }
  IN(WindowFrame) frame = load_window_frame(load_sky_window(chosen).frame);
  REAL a = drawn_along(frame, false, 0u, of_chosen, u);
  REAL b = drawn_along(frame, true, cell_at(frame, a), of_chosen, v);
  REAL per_cells = 2.0f * reciprocal(REAL(frame.cells));
  REAL c = a * per_cells - 1.0f;
  REAL d = b * per_cells - 1.0f;
  // t = c / (1 - |c|), multiplied by both denominators.
  REAL of_c = max(1.0f - abs(c), 1e-7f);
  REAL of_d = max(1.0f - abs(d), 1e-7f);
  return normalized(frame.x * (c * of_d) + frame.y * (d * of_c) + frame.z * (of_c * of_d));
}

/// W(w) (da db / dw) over the frame's unit; `local`: unit in the frame, local.z > 0.
SHARED REAL density_in_frame(IN(WindowFrame) frame, VEC3 local) MEMBER_CONST {
  uint i = cell_at(frame, in_cells(frame, local.x, local.z));
  uint j = cell_at(frame, in_cells(frame, local.y, local.z));
  REAL n = REAL(frame.cells);
  REAL per_across = reciprocal((abs(local.x) + local.z) * (abs(local.y) + local.z));
  return REAL(whole_content(frame, i, i + 1u, j, j + 1u)) * (0.25f * n * n) * local.z *
         (per_across * per_across);
}

/// Density of towards_window() [1/sr].
SHARED REAL windows_pdf_w(VEC3 position, VEC3 facing, REAL seen, VEC3 towards) MEMBER_CONST {
  REAL sum = 0.0f;
  for (uint rest = windows_in_view(position); rest != 0u; rest &= rest - 1u) {
    IN(SkyWindow) window = load_sky_window(uint(findLSB(rest)));
    IN(WindowFrame) frame = load_window_frame(window.frame);
    VEC3 local = to_frame(frame, towards);
    if (!(local.z > 1e-12f)) continue;
    VEC3 at = to_frame(frame, position);
    // Where it crosses the plane, by the same differences as in rect_of().
    REAL height = window.z - at.z;
    REAL x = local.x * height;
    REAL y = local.y * height;
    // Distances beside the rectangle, > 0 outside.
    REAL off_x = max((window.x0 - at.x) * local.z - x, x - (window.x1 - at.x) * local.z);
    REAL off_y = max((window.y0 - at.y) * local.z - y, y - (window.y1 - at.y) * local.z);
    REAL more = kSurroundMargin * local.z;
    if (off_x > more * (window.x1 - window.x0) || off_y > more * (window.y1 - window.y0)) continue;
    REAL share = max(off_x, off_y) > 0.0f ? REAL(kSurroundShare) : REAL(1.0f);
    if (sees_window(window, frame, at, facing))
      sum += share * density_in_frame(frame, local) * frame.unit;
  }
  return sum * reciprocal(max(seen, 1e-30f));
}

#include "shaders/shared/language_end.h"
