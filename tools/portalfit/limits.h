// The numbers that a verdict of portalfit hangs on.
#pragma once
#include <cstddef>

#include "libcommon/formats/light_grid.h"

namespace tdpt {

/// Lengths are relative unless a unit is given.
struct FitLimits {
  // What makes an opening.
  double threshold = 0.02;      ///< smallest share of a camera's light that makes a portal
  double least_part = 0.25;     ///< of the threshold, before parts are joined
  double support = 0.5;         ///< smallest share of the probes that join the two sides
  double one_opening = 0.9;     ///< support below which a part of it may be the opening
  double sure = 0.8;            ///< support below which a denser part may be the opening
  double least_widening = 1.5;  ///< of the light, before or behind an opening, as areas
  double fewest_lines = 30;     ///< that make an opening
  double fewest_probes = 30;    ///< that tell its support
  double fewest_members = 30;   ///< crossing it, without which those that end on a jamb count, too
  double most_tried = 48;       ///< candidates of a cut
  double open_space = 0.2;      ///< conductance from which a portal is useless for certain
  double nearly_all = 0.95;     ///< of the light, explained: the rest is not worth a note

  // The lines of an opening.
  double dense_cell = 0.1;       ///< of the mean density: least of a cell in the bundle
  double points_per_cell = 8;    ///< of the finer histograms
  double grazing = 0.05;         ///< cosine with the normal below which a crossing is not clear
  double wider = 1.1;            ///< growth of an outline that takes all its lines
  double deeper = 0.5;           ///< shorter sides behind which lines that end there are its own
  double missing_at_waist = 3;   ///< worth of a line against area, in logarithms: at the waist
  double lines_at_waist = 2000;  ///< of a search for the waist

  // The tube that an opening cuts into its wall.
  double missing = 2;            ///< worth of a line against area: of a tube
  double missing_of_few = 0.3;   ///< of a plane of few lines
  double missing_of_known = 3;   ///< of a plane of lines that are known to pass
  double many = 500;             ///< lines that tell their mean direction
  double outside = 0.0006;       ///< share of the crossings beyond each side of an outline
  double outside_plane = 0.002;  ///< of planes
  double through = 0.002;        ///< smallest share of the lines held that pass both faces
  double least_cosine = 0.1;     ///< of a line, when slants are averaged
  double turn = 0.25;            ///< tangent between the starts of a search
  double most_tilt = 0.3;        ///< tangent of a step
  double rough_lines = 2000;     ///< of the first searches
  double fine_lines = 8192;      ///< of the others
  double rough_step = 0.3;       ///< first step of a search, in shorter sides
  double fine_step = 0.1;        ///< of a search that goes on
  double rough_last = 0.05;      ///< last step of the first searches
  double fine_last = 0.004;      ///< of the others
  double prism = 1.08;  ///< area on the faces over that in the middle, up to which a tube is one
  double widest = 1.5;  ///< up to which it is no room
  double dense_tube = 0.6;    ///< density of a tube over that of the narrowest plane
  double short_tube = 0.5;    ///< form factor of the faces up to which a tube is no plane
  double plane_holds = 0.97;  ///< share of a tube's lines with which a plane takes its place
  double blind_end = 0.1;     ///< of the depth, within which lines end on the end of a room
  double clearly = 0.04;      ///< of the area, by which a tube is the lesser
  double near_wall = 0.966;   ///< cosine with a wall in which an opening may lie
  double square = 0.15;       ///< of the objective, by which it may be the worse there

  // Its outline.
  double most_corners = 12;
  double corner = 0.003;         ///< of the area: most that a corner saved may add
  double whole_corner = 0.03;    ///< the same where all lines are known to pass
  double within = 0.85;          ///< of the depth: where the outline is taken
  double clear = 0.2;            ///< shorter sides beyond the tube within which no clear line ends
  double least_clear = 1.0 / 3;  ///< share of the lines that a fit to clear lines needs
  double most_trimmed = 0.02;    ///< share of the lines that may be strays
  double sparse = 10;            ///< area over lines of a strip that strays reach
  double worth_trimming = 0.01;  ///< of the area

  // Several openings.
  double denser = 1.3;          ///< lines per area of a part over those of the whole
  double promised = 0.8;        ///< of the density of the whole, below which no part is fitted
  double least_of_whole = 0.1;  ///< share of its lines that a part needs
  double most_fitted = 2;       ///< parts
  double same_opening = 0.7;    ///< share of the light that passes both of two that are one
  double most_of_light = 0.5;   ///< of an opening, with which a smaller one takes its place
  double slant = 0.5;           ///< sine between planes that bound each other
  double most_clipped = 0.25;   ///< of the area, that another's plane may cut off
  double reach = 1.5;           ///< growth of the area within which things are near
  double reach_of_lines = 2;    ///< of lines
  double least_left = 0.5;      ///< of the lines of an opening that is fitted again
  double shared = 0.01;         ///< of its lines, from which openings share some
  double growth = 1.5;          ///< of others, first time that lines are divided
  double next_growth = 1.2;     ///< second time
  double mostly_open = 0.8;     ///< share of a joint outline that is joined across mullions
  double open_enough = 0.3;     ///< across thin bars
  double thin_bar = 2;          ///< voxels
  double mullion = 0.25;        ///< of the narrower part's shorter side: a wider bar is a pier
  double flat = 0.15;           ///< of the shorter side: most distance from the joint plane
  double turned = 0.97;         ///< cosine between normals in one plane

  // Figures.
  double fewest_in_cone = 60;  ///< lines that tell a density
  double full = 0.5;           ///< of the fullest voxel, for the paper's rule

  /// Whether so few lines make no opening.
  bool few(size_t lines) const { return static_cast<double>(lines) < fewest_lines; }
};

/// What openings are fitted to.
struct FitInput {
  const LightGrid& grid;
  const FitLimits& limits;
};

}  // namespace tdpt
