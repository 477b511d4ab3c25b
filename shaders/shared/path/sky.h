// Light from infinitely far away, sky and suns: its radiance along a direction, and importance
// sampling of directions. libcommon/scene/sky.h in floats.
//
// Include in a scope that has load_x(i) of light_word, sky_texel and sky_sun [tables.h],
// light_settings, scene_has_sky_map and scene_prefers: a GLSL file after its buffers, or the body
// of a C++ struct.
//
// Distributions are tables of whole numbers: entry i of n owns the 32-bit words from begin[i] to
// begin[i + 1], so that its probability in the density is exactly that of drawing it, however
// small. guide[s] is the entry of the first word of the s-th of n equal parts. Blocks of a map are
// such entries; a cell has a share of its block, in 65535ths.
//
// A row is found by the angle from the pole, and the position within a cell by the versine: near a
// pole the cosines of many rows are the same float.

#include "shaders/shared/language.h"

/// 32 bits: the 24 bits of `pick` in [0,1), and the lowest bits of another number.
SHARED uint pick_word(float pick, float other) MEMBER_CONST {
  return uint(pick * 16777216.0f) << 8 | (uint(other * 16777216.0f) & 255u);
}

/// The entry that owns `word`.
SHARED uint drawn_entry(uint begin, uint guide, uint entries, uint word) MEMBER_CONST {
  // The last entries may own no words.
  uint w = min(word, 0xFFFFFFFEu);
  uint slot = below(w, entries);
  uint low = load_light_word(guide + slot);
  uint high = load_light_word(guide + slot + 1u);
  while (low < high) {
    uint middle = (low + high + 1u) >> 1;
    bool above = load_light_word(begin + middle) <= w;
    low = above ? middle : low;
    high = above ? high : middle - 1u;
  }
  return low;
}
/// Its probability.
SHARED float share_of_entry(uint begin, uint entry) MEMBER_CONST {
  uint words = load_light_word(begin + entry + 1u) - load_light_word(begin + entry);
  return float(words) * 2.3283064365386963e-10f;
}

/// 1 - cos and 1 + cos of a row's upper edge, and the difference to its lower edge.
struct SkyRow {
  float north;
  float south;
  float height;
  float per_height;
};
SHARED SkyRow sky_row(uint row) MEMBER_CONST {
  uint at = light_settings.first_row + 4u * row;
  SkyRow r = {uintBitsToFloat(load_light_word(at)), uintBitsToFloat(load_light_word(at + 1u)),
              uintBitsToFloat(load_light_word(at + 2u)), uintBitsToFloat(load_light_word(at + 3u))};
  return r;
}
/// 1 / solid angle of a cell of the row [1/sr].
SHARED float per_solid_angle_of_cell(SkyRow row) MEMBER_CONST {
  return row.per_height * (float(light_settings.sky_width) * 0.159154943f);
}

/// The map position of unit `towards`.
SHARED SkyPlace place_in_sky(vec3 towards) MEMBER_CONST {
  SkyPlace place;
  place.towards = towards;
  float x = light_settings.sky_cos * towards.x - light_settings.sky_sin * towards.z;
  float z = light_settings.sky_sin * towards.x + light_settings.sky_cos * towards.z;
  float width = float(light_settings.sky_width);
  float a = (turns_of(x, -z) + 0.5f) * width - 0.5f;
  a = a < 0.0f ? a + width : a;
  place.column = min(uint(a), light_settings.sky_width - 1u);
  place.across = min(a - float(place.column), 1.0f);
  float s2 = x * x + z * z;
  float polar = turns_of(root(s2), towards.y) * (2.0f * float(light_settings.sky_height)) + 0.5f;
  place.row = min(uint(max(polar, 0.0f)), light_settings.sky_height);
  SkyRow row = sky_row(place.row);
  float versine = s2 * reciprocal(1.0f + abs(towards.y));  // from the nearer pole
  float below_edge = towards.y >= 0.0f ? versine - row.north : row.south - versine;
  place.down = min(max(below_edge * row.per_height, 0.0f), 1.0f);
  return place;
}

/// The direction of a map position.
SHARED vec3 towards_place(SkyPlace place) MEMBER_CONST {
  SkyRow row = sky_row(place.row);
  float down = place.down * row.height;
  float north = row.north + down;
  float south = max(row.south - down, 0.0f);
  float y = north < 1.0f ? 1.0f - north : south - 1.0f;
  float r = root(north * south);
  float turns =
      (float(place.column) + (place.across + 0.5f)) * reciprocal(float(light_settings.sky_width));
  turns = turns >= 1.0f ? turns - 1.0f : turns;
  float cosine;
  float sine;
  cos_sin_turns(turns, cosine, sine);
  float x = -r * sine;
  float z = r * cosine;
  return vec3(light_settings.sky_cos * x + light_settings.sky_sin * z, y,
              light_settings.sky_cos * z - light_settings.sky_sin * x);
}

SHARED vec3 sky_texel(uint i) MEMBER_CONST {
  return vec3(load_sky_texel(i).r, load_sky_texel(i).g, load_sky_texel(i).b);
}
/// The texels around a cell.
struct SkyCorners {
  uint upper_left;
  uint upper_right;
  uint lower_left;
  uint lower_right;
};
SHARED SkyCorners sky_corners(uint column, uint row) MEMBER_CONST {
  uint width = light_settings.sky_width;
  uint right = column + 1u == width ? 0u : column + 1u;
  uint upper = (row == 0u ? 0u : row - 1u) * width;
  uint lower = min(row, light_settings.sky_height - 1u) * width;
  SkyCorners c = {upper + column, upper + right, lower + column, lower + right};
  return c;
}

SHARED bool in_sun(SkySun sun, vec3 towards) MEMBER_CONST {
  vec3 d = towards - sun.towards;
  return 0.5f * dot(d, d) <= sun.versine;
}
SHARED vec3 towards_sun(SkySun sun, float u, float v) MEMBER_CONST {
  float h = v * sun.drawn;
  float r = root(h * (2.0f - h));
  float cosine;
  float sine;
  cos_sin_turns(u, cosine, sine);
  return normalized(to_world(onb_about(sun.towards), vec3(r * cosine, r * sine, 1.0f - h)));
}

/// Shares of the four cells in a block's row, in 65535ths of the whole block.
struct CellShares {
  uint first;
  uint second;
};
SHARED CellShares shares_of_row(uint entry, uint row) MEMBER_CONST {
  uint at = light_settings.first_cell + 8u * entry + 2u * row;
  CellShares shares = {load_light_word(at), load_light_word(at + 1u)};
  return shares;
}
SHARED uint low_half(uint word) MEMBER_CONST {
  return word & 0xFFFFu;
}
SHARED uint sum_of_shares(CellShares s) MEMBER_CONST {
  return low_half(s.first) + (s.first >> 16) + low_half(s.second) + (s.second >> 16);
}
/// Which of four weights `share` in [0,1) of their sum falls on; rescales `share` to [0,1) within
/// it.
SHARED uint one_of_four(uint w0, uint w1, uint w2, uint w3, INOUT(float) share) MEMBER_CONST {
  float left = share * float(w0 + w1 + w2 + w3);
  float f0 = float(w0);
  float f1 = float(w0 + w1);
  float f2 = float(w0 + w1 + w2);
  uint i = (left >= f0 ? 1u : 0u) + (left >= f1 ? 1u : 0u) + (left >= f2 ? 1u : 0u);
  float begin = i == 0u ? 0.0f : i == 1u ? f0 : i == 2u ? f1 : f2;
  uint width = i == 0u ? w0 : i == 1u ? w1 : i == 2u ? w2 : w3;
  share = min((left - begin) * reciprocal(float(max(width, 1u))), 0.99999994f);
  return i;
}

/// Part of a cell that contains `place`.
SHARED uint part_of_cell(float place, uint parts) MEMBER_CONST {
  return min(uint(place * float(parts)), parts - 1u);
}

/// Samples a point in a block of fine cells.
SHARED SkyPlace place_in_block(SkyTable table, uint entry, float u_, float v_) MEMBER_CONST {
  float u = u_;
  float v = v_;
  uint row = entry / table.columns * table.block;
  uint column = entry % table.columns * table.block;
  if (table.block > 1u) {
    uint down = one_of_four(
        sum_of_shares(shares_of_row(entry, 0u)), sum_of_shares(shares_of_row(entry, 1u)),
        sum_of_shares(shares_of_row(entry, 2u)), sum_of_shares(shares_of_row(entry, 3u)), v);
    CellShares cells = shares_of_row(entry, down);
    row += down;
    column += one_of_four(low_half(cells.first), cells.first >> 16, low_half(cells.second),
                          cells.second >> 16, u);
  }
  SkyPlace place;
  place.column = column / table.split_x;
  place.row = row / table.split_y;
  float per_x = reciprocal(float(table.split_x));
  float per_y = reciprocal(float(table.split_y));
  float left = float(column % table.split_x);
  float top = float(row % table.split_y);
  float across = u;
  float down = v;
  if (scene_has_sky_map) {
    SkyCorners c = sky_corners(place.column, place.row);
    float c00 = luminance(sky_texel(c.upper_left));
    float c10 = luminance(sky_texel(c.upper_right));
    float c01 = luminance(sky_texel(c.lower_left));
    float c11 = luminance(sky_texel(c.lower_right));
    float x0 = left * per_x;
    float y0 = top * per_y;
    float x1 = x0 + per_x;
    float y1 = y0 + per_y;
    float w00 = between_corners(c00, c10, c01, c11, x0, y0);
    float w10 = between_corners(c00, c10, c01, c11, x1, y0);
    float w01 = between_corners(c00, c10, c01, c11, x0, y1);
    float w11 = between_corners(c00, c10, c01, c11, x1, y1);
    down = drawn_linear(w00 + w10, w01 + w11, v);
    across = drawn_linear(w00 * (1.0f - down) + w01 * down, w10 * (1.0f - down) + w11 * down, u);
  }
  // Slightly off the sides, so that lookups find the same part.
  const float margin = 1e-6f;
  place.across = (left + min(max(across, margin), 1.0f - margin)) * per_x;
  place.down = (top + min(max(down, margin), 1.0f - margin)) * per_y;
  place.towards = towards_place(place);
  return place;
}

SHARED vec3 uniform_direction(float u, float v) MEMBER_CONST {
  float h = 2.0f * v;
  float r = root(h * (2.0f - h));
  float cosine;
  float sine;
  cos_sin_turns(u, cosine, sine);
  return vec3(r * cosine, 1.0f - h, r * sine);
}

/// place_in_sky(), or without a position if there is no map that depends on it.
SHARED SkyPlace any_place(vec3 towards) MEMBER_CONST {
  if (scene_has_sky_map || scene_prefers) return place_in_sky(towards);
  SkyPlace place = {towards, 0u, 0u, 0.0f, 0.0f};
  return place;
}

SHARED SkyPlace drawn_in_sky(SkyTable table, uint word, float u, float v) MEMBER_CONST {
  uint entry = drawn_entry(table.begin, table.guide, table.entries, word);
  bool sun = entry >= table.blocks;
  if (!sun && (scene_has_sky_map || table.columns > 1u)) return place_in_block(table, entry, u, v);
  vec3 towards = uniform_direction(u, v);
  if (sun) towards = towards_sun(load_sky_sun(entry - table.blocks), u, v);
  return any_place(towards);
}

/// Probability of a cell.
SHARED float share_of_cell(SkyTable table, uint column, uint row) MEMBER_CONST {
  if (table.block == 1u) return share_of_entry(table.begin, row * table.columns + column);
  uint entry = (row >> 2) * table.columns + (column >> 2);
  CellShares cells = shares_of_row(entry, row & 3u);
  uint pair = (column & 2u) == 0u ? cells.first : cells.second;
  uint share = (column & 1u) == 0u ? low_half(pair) : pair >> 16;
  return share_of_entry(table.begin, entry) * (float(share) * 1.52590219e-5f);
}

SHARED InSky look_in_sky(SkyPlace place) MEMBER_CONST {
  InSky in_sky;
  in_sky.radiance = light_settings.sky_colour;
  in_sky.plain_w = light_settings.colour_w;
  float per_mean = 0.0f;
  float y = 1.0f;
  SkyTable start = light_settings.start;
  bool prefers = scene_prefers && start.blocks > 0u;
  bool parts = prefers && start.split_x * start.split_y > 1u;
  // The part of the cell, and its mean.
  uint x_part = parts ? part_of_cell(place.across, start.split_x) : 0u;
  uint y_part = parts ? part_of_cell(place.down, start.split_y) : 0u;
  if (scene_has_sky_map || prefers) per_mean = per_solid_angle_of_cell(sky_row(place.row));
  if (scene_has_sky_map) {
    SkyCorners c = sky_corners(place.column, place.row);
    vec3 c00 = sky_texel(c.upper_left);
    vec3 c10 = sky_texel(c.upper_right);
    vec3 c01 = sky_texel(c.lower_left);
    vec3 c11 = sky_texel(c.lower_right);
    vec3 upper = c00 * (1.0f - place.across) + c10 * place.across;
    vec3 lower = c01 * (1.0f - place.across) + c11 * place.across;
    in_sky.radiance = upper * (1.0f - place.down) + lower * place.down;
    y = luminance(in_sky.radiance);
    float per_area = per_mean;
    float mean = 0.25f * luminance(c00 + c10 + c01 + c11);
    per_mean = mean > 1e-30f ? per_area * reciprocal(mean) : 0.0f;
    in_sky.plain_w = share_of_cell(light_settings.plain, place.column, place.row) * (y * per_mean);
    if (parts) {
      mean = between_corners(luminance(c00), luminance(c10), luminance(c01), luminance(c11),
                             (float(x_part) + 0.5f) * reciprocal(float(start.split_x)),
                             (float(y_part) + 0.5f) * reciprocal(float(start.split_y)));
      per_mean = mean > 1e-30f ? per_area * reciprocal(mean) : 0.0f;
    }
  }
  in_sky.start_w = in_sky.plain_w;
  if (prefers)
    in_sky.start_w = share_of_cell(start, place.column * start.split_x + x_part,
                                   place.row * start.split_y + y_part) *
                     (y * per_mean * float(start.split_x * start.split_y));
  for (uint i = 0u; i < light_settings.suns; ++i) {
    if (!in_sun(load_sky_sun(i), place.towards)) continue;
    in_sky.radiance = in_sky.radiance + load_sky_sun(i).radiance;
    in_sky.plain_w += load_sky_sun(i).plain_w;
    in_sky.start_w += load_sky_sun(i).start_w;
  }
  return in_sky;
}

/// Radiance and densities along unit `towards`; there must be a sky.
SHARED InSky look_at_sky(vec3 towards) MEMBER_CONST {
  return look_in_sky(any_place(towards));
}

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
SHARED uint window_sum(WindowFrame frame, uint i) MEMBER_CONST {
  return load_light_word(frame.sums + i);
}

#include "shaders/shared/language_end.h"
