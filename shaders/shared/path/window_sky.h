// The sky as it is seen through the portals: tools/tdpt-render/path/light/window_sky.h in floats,
// where the method is told.
//
// Read behind lights.h, within a scope that has what that needs, load_sky_window(),
// load_window_frame() and scene_has_windows.
//
// Contents of cells are whole numbers. Sums over a rectangle are put together from its four
// corners, its four sides and its middle, none of which is a difference of floats: beside a sun in
// the same table the faintest part keeps its digits.

#include "shaders/shared/language.h"

/// Windows that may be seen from `position`: bit i of a mask.
SHARED uint windows_in_view(vec3 position) MEMBER_CONST {
  vec3 cell = (position - light_settings.view_low) * light_settings.view_scale;
  bool inside = cell.x >= 0.0f && cell.y >= 0.0f && cell.z >= 0.0f &&
                cell.x < float(light_settings.view_x) && cell.y < float(light_settings.view_y) &&
                cell.z < float(light_settings.view_z);
  if (!inside) return light_settings.view_beyond;
  uint row = uint(cell.z) * light_settings.view_y + uint(cell.y);
  return load_light_word(light_settings.first_view + row * light_settings.view_x + uint(cell.x));
}

SHARED vec3 to_frame(WindowFrame frame, vec3 v) MEMBER_CONST {
  return vec3(dot(frame.x, v), dot(frame.y, v), dot(frame.z, v));
}

/// c(x / z) in cells, z more than 0.
SHARED float in_cells(WindowFrame frame, float x, float z) MEMBER_CONST {
  return (x * reciprocal(z + abs(x)) + 1.0f) * (0.5f * float(frame.cells));
}

/// From inside and with a corner above the horizon, `at` in the frame.
SHARED bool sees_window(SkyWindow window, WindowFrame frame, vec3 at, vec3 facing) MEMBER_CONST {
  float height = window.z - at.z;
  if (!(height > 2e-6f)) return false;  // tdpt::PortalSet::kMargin
  if (is_zero(facing)) return true;
  vec3 front = to_frame(frame, facing);
  return front.x * ((front.x > 0.0f ? window.x1 : window.x0) - at.x) +
             front.y * ((front.y > 0.0f ? window.y1 : window.y0) - at.y) + front.z * height >
         0.0f;
}

/// What is drawn of a window: little less than there is, so that it is found in it again.
SHARED CellRect rect_of(SkyWindow window, WindowFrame frame, vec3 at) MEMBER_CONST {
  float height = window.z - at.z;
  float margin = 2.4e-7f * float(frame.cells);
  CellRect r;
  r.a0 = in_cells(frame, window.x0 - at.x, height) + margin;
  r.a1 = in_cells(frame, window.x1 - at.x, height) - margin;
  r.b0 = in_cells(frame, window.y0 - at.y, height) + margin;
  r.b1 = in_cells(frame, window.y1 - at.y, height) - margin;
  return r;
}

SHARED uint cell_at(WindowFrame frame, float a) MEMBER_CONST {
  return min(uint(max(a, 0.0f)), frame.cells - 1u);
}

/// Whole content of columns [i, k), rows [j, l).
SHARED uint whole_content(WindowFrame frame, uint i, uint k, uint j, uint l) MEMBER_CONST {
  uint low = frame.sums + i * (frame.cells + 1u);
  uint high = frame.sums + k * (frame.cells + 1u);
  return (load_light_word(high + l) - load_light_word(high + j)) -
         (load_light_word(low + l) - load_light_word(low + j));
}
/// Of columns [i, k), between b0 and b1.
SHARED float content_of_columns(WindowFrame frame, uint i, uint k, float b0,
                                float b1) MEMBER_CONST {
  uint j = cell_at(frame, b0);
  uint l = cell_at(frame, b1);
  float first = float(whole_content(frame, i, k, j, j + 1u));
  if (j == l) return first * (b1 - b0);
  float last = float(whole_content(frame, i, k, l, l + 1u));
  float middle = float(whole_content(frame, i, k, j + 1u, l));
  return first * (float(j + 1u) - b0) + middle + last * (b1 - float(l));
}
SHARED float content_of_rect(WindowFrame frame, CellRect r) MEMBER_CONST {
  uint i = cell_at(frame, r.a0);
  uint k = cell_at(frame, r.a1);
  float first = content_of_columns(frame, i, i + 1u, r.b0, r.b1);
  if (i == k) return first * (r.a1 - r.a0);
  float last = content_of_columns(frame, k, k + 1u, r.b0, r.b1);
  float middle = content_of_columns(frame, i + 1u, k, r.b0, r.b1);
  return first * (float(i + 1u) - r.a0) + middle + last * (r.a1 - float(k));
}

/// S_F of window i, and where; `r` is of no meaning where it is 0.
SHARED float seen_through(uint i, vec3 position, vec3 facing, OUT(CellRect) r) MEMBER_CONST {
  SkyWindow window = load_sky_window(i);
  WindowFrame frame = load_window_frame(window.frame);
  vec3 at = to_frame(frame, position);
  r.a0 = 0.0f;
  r.a1 = 0.0f;
  r.b0 = 0.0f;
  r.b1 = 0.0f;
  if (!sees_window(window, frame, at, facing)) return 0.0f;
  r = rect_of(window, frame, at);
  if (!(r.a0 < r.a1 && r.b0 < r.b1)) return 0.0f;
  return content_of_rect(frame, r) * frame.unit;
}

/// What all windows show of the sky from `position`, where the surface faces `facing` (0: both
/// ways): sum S_F.
SHARED float seen_through_windows(vec3 position, vec3 facing) MEMBER_CONST {
  float sum = 0.0f;
  CellRect r;
  for (uint rest = windows_in_view(position); rest != 0u; rest &= rest - 1u)
    sum += seen_through(uint(findLSB(rest)), position, facing, r);
  return sum;
}

/// Where the content from a0 on, between b0 and b1, is `share` of that between a0 and a1.
SHARED float drawn_column(WindowFrame frame, CellRect r, float share) MEMBER_CONST {
  uint first = cell_at(frame, r.a0);
  uint low = first;
  uint high = cell_at(frame, r.a1);
  if (low == high) return r.a0 + (r.a1 - r.a0) * share;
  float of_first =
      content_of_columns(frame, first, first + 1u, r.b0, r.b1) * (float(first + 1u) - r.a0);
  float wanted = share * content_of_rect(frame, r);
  // The last column that `wanted` reaches, and what lies before it.
  float before = 0.0f;
  while (low < high) {
    uint middle = (low + high + 1u) >> 1;
    float sum = of_first + content_of_columns(frame, first + 1u, middle, r.b0, r.b1);
    bool reached = sum <= wanted;
    before = reached ? sum : before;
    low = reached ? middle : low;
    high = reached ? high : middle - 1u;
  }
  float from = max(float(low), r.a0);
  float to = min(float(low + 1u), r.a1);
  float content = content_of_columns(frame, low, low + 1u, r.b0, r.b1);
  float within = content > 0.0f ? (wanted - before) * reciprocal(content) : 0.0f;
  return min(from + max(within, 0.0f), to);
}
/// The same down one column.
SHARED float drawn_row(WindowFrame frame, uint column, CellRect r, float share) MEMBER_CONST {
  uint first = cell_at(frame, r.b0);
  uint low = first;
  uint high = cell_at(frame, r.b1);
  if (low == high) return r.b0 + (r.b1 - r.b0) * share;
  float of_first = float(whole_content(frame, column, column + 1u, first, first + 1u)) *
                   (float(first + 1u) - r.b0);
  float wanted = share * content_of_columns(frame, column, column + 1u, r.b0, r.b1);
  float before = 0.0f;
  while (low < high) {
    uint middle = (low + high + 1u) >> 1;
    float sum = of_first + float(whole_content(frame, column, column + 1u, first + 1u, middle));
    bool reached = sum <= wanted;
    before = reached ? sum : before;
    low = reached ? middle : low;
    high = reached ? high : middle - 1u;
  }
  float from = max(float(low), r.b0);
  float to = min(float(low + 1u), r.b1);
  float content = float(whole_content(frame, column, column + 1u, low, low + 1u));
  float within = content > 0.0f ? (wanted - before) * reciprocal(content) : 0.0f;
  return min(from + max(within, 0.0f), to);
}

/// Unit, towards the sky; `seen` more than 0, that of `position`. Three numbers in [0,1).
SHARED vec3 towards_window(vec3 position, vec3 facing, float seen, float pick, float u,
                           float v) MEMBER_CONST {
  float left = pick * seen;
  uint chosen = 0u;
  CellRect of_chosen;
  of_chosen.a0 = 0.0f;
  of_chosen.a1 = 1.0f;
  of_chosen.b0 = 0.0f;
  of_chosen.b1 = 1.0f;
  CellRect r;
  for (uint rest = windows_in_view(position); rest != 0u && left >= 0.0f; rest &= rest - 1u) {
    uint i = uint(findLSB(rest));
    float through = seen_through(i, position, facing, r);
    if (!(through > 0.0f)) continue;
    chosen = i;
    of_chosen = r;
    left = left < through ? -1.0f : left - through;
  }
  WindowFrame frame = load_window_frame(load_sky_window(chosen).frame);
  float a = drawn_column(frame, of_chosen, u);
  float b = drawn_row(frame, cell_at(frame, a), of_chosen, v);
  float per_cells = 2.0f * reciprocal(float(frame.cells));
  float c = a * per_cells - 1.0f;
  float d = b * per_cells - 1.0f;
  // Of t = c / (1 - |c|), times both denominators.
  float of_c = max(1.0f - abs(c), 1e-7f);
  float of_d = max(1.0f - abs(d), 1e-7f);
  return normalized(frame.x * (c * of_d) + frame.y * (d * of_c) + frame.z * (of_c * of_d));
}

/// W(w) (da db / dw) over the frame's unit; `local` unit in the frame, local.z more than 0.
SHARED float density_in_frame(WindowFrame frame, vec3 local) MEMBER_CONST {
  uint i = cell_at(frame, in_cells(frame, local.x, local.z));
  uint j = cell_at(frame, in_cells(frame, local.y, local.z));
  float n = float(frame.cells);
  float per_across = reciprocal((abs(local.x) + local.z) * (abs(local.y) + local.z));
  return float(whole_content(frame, i, i + 1u, j, j + 1u)) * (0.25f * n * n) * local.z *
         (per_across * per_across);
}

/// Density of towards_window() [1/sr].
SHARED float windows_pdf_w(vec3 position, vec3 facing, float seen, vec3 towards) MEMBER_CONST {
  float sum = 0.0f;
  for (uint rest = windows_in_view(position); rest != 0u; rest &= rest - 1u) {
    SkyWindow window = load_sky_window(uint(findLSB(rest)));
    WindowFrame frame = load_window_frame(window.frame);
    vec3 local = to_frame(frame, towards);
    if (!(local.z > 1e-12f)) continue;
    vec3 at = to_frame(frame, position);
    // Where the plane is passed, by the differences that rect_of() takes.
    float height = window.z - at.z;
    float x = local.x * height;
    float y = local.y * height;
    if (x < (window.x0 - at.x) * local.z || x > (window.x1 - at.x) * local.z ||
        y < (window.y0 - at.y) * local.z || y > (window.y1 - at.y) * local.z)
      continue;
    if (sees_window(window, frame, at, facing)) sum += density_in_frame(frame, local) * frame.unit;
  }
  return sum * reciprocal(max(seen, 1e-30f));
}

#include "shaders/shared/language_end.h"
