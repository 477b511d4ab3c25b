// The numbers that a verdict of portalfit hangs on.
#pragma once
#include <cstddef>

#include "libcommon/formats/light_grid.h"

namespace tdpt {

/// Most of a thing is more than half of it.
inline constexpr double kMost = 0.5;

/// Each is a ratio unless a unit is given.
struct FitLimits {
  // What makes an opening.
  double threshold = 0.02;   ///< smallest share of a camera's light that makes a portal
  double least_part = 0.25;  ///< of the threshold: least light of a pane, before panes are joined
  double support = 0.5;      ///< least share of its probes that join the two sides
  double one_opening = 0.9;  ///< support below which one of two windows may be the opening
  double sure = 0.8;         ///< support below which a denser part may be the opening
  double fewest = 30;        ///< lines, or probes, that tell anything
  double most_tried = 48;    ///< candidates of a cut
  /// Least share of its outline that is an edge: of most openings it is 0.4 to 1, of planes across
  /// a room 0 to 0.2.
  double least_edge = 0.3;
  double beyond = 0.15;     ///< of its size: how much farther a room reaches
  double coarse = 4;        ///< voxels across, below which the grid does not show edges
  double open_space = 0.2;  ///< conductance from which a portal is useless for certain
  /// Ratio of areas from which one is clearly the wider: of a tube's faces over its middle, of what
  /// is near an outline over the outline.
  double widening = 1.5;

  // The lines of an opening.
  double dense_cell = 0.1;     ///< of the mean density: least of a cell in the bundle
  double points_per_cell = 8;  ///< of its finer histograms
  double grazing = 0.05;       ///< cosine with the normal below which a crossing is not clear
  double wider = 1.1;          ///< growth of an outline that takes all of its lines
  double deeper = 0.5;  ///< shorter sides before an opening: lines that end there are its own

  // The tube that an opening cuts into its wall.
  double missing = 2;           ///< worth of a line against area, in logarithms
  double missing_of_few = 0.3;  ///< the same of few lines
  double missing_of_known = 3;  ///< the same of lines that pass for certain
  double many = 500;            ///< lines that are not few: they tell their mean direction
  double outside = 0.0006;      ///< share of a tube's crossings beyond each side of its outline
  /// Share of the lines that is next to none: beyond each side of a plane's outline, and too few
  /// that pass both faces of a tube.
  double hardly_any = 0.002;
  double least_cosine = 0.1;  ///< of lines whose slants are averaged
  double turn = 0.25;         ///< tangent between the starts of a search
  double rough_lines = 2000;  ///< of the first searches
  double fine_lines = 8192;   ///< of the others
  double first_step = 0.3;    ///< of a search, in shorter sides, and the largest tilt of a step
  double fine_step = 0.1;     ///< of a search that goes on
  double rough_last = 0.05;   ///< last step of the first searches
  double fine_last = 0.004;   ///< of the others
  double prism = 1.08;        ///< area of a tube's faces over its middle's, up to which it is one
  double dense_tube = 0.6;    ///< least density of a tube over that of its narrowest plane
  double plane_holds = 0.97;  ///< share of a tube's lines with which a plane takes its place
  double blind_end = 0.1;     ///< of its depth, behind which lines end on the end of a room
  double clearly = 0.04;      ///< of the area, by which a tube is the lesser
  double near_wall = 0.966;   ///< cosine between a tube and a wall that it may lie in
  double square = 0.15;       ///< of the etendue, by which it may be the larger there

  // Its outline.
  double most_corners = 12;      ///< of a portal
  double corner = 0.003;         ///< of the area: most that one corner fewer may add
  double whole_corner = 0.03;    ///< the same of lines that pass for certain
  double within = 0.85;          ///< of the depth: where the outline is taken
  double clear = 0.2;            ///< shorter sides beside a tube, within which no clear line ends
  double least_clear = 1.0 / 3;  ///< share of the lines that must be clear for a fit to these alone
  double most_trimmed = 0.02;    ///< share of the lines that may be strays
  double sparse = 10;            ///< share of the area over that of the lines, where strays are
  double worth_trimming = 0.01;  ///< of the area

  // Several openings.
  double denser = 1.3;          ///< lines per area of a part over those of the whole
  double promised = 0.8;        ///< of the density of the whole: parts that promise less are left
  double least_of_whole = 0.1;  ///< share of its lines that a part has
  double most_fitted = 2;       ///< parts, those that promise most
  double slant = 0.5;           ///< sine between planes that bound each other
  double most_clipped = 0.25;   ///< share of an area that another's plane may cut off
  double reach_of_lines = 2;    ///< growth of an outline that has all lines near it
  double shared = 0.01;         ///< share of its lines, from which an opening is divided
  double next_growth = 1.2;     ///< of the others, the second time that it is
  double mostly_open = 0.8;     ///< of a joint outline: then panes are joined across mullions
  double open_enough = 0.3;     ///< of a joint outline: then they are across thin bars
  double thin_bar = 2;          ///< voxels
  double mullion = 0.25;        ///< of the narrower pane's shorter side: a wider bar is a pier
  double flat = 0.15;           ///< of the shorter side: most distance from the joint plane
  double turned = 0.97;         ///< least cosine between normals in one plane

  /// Whether so few lines tell nothing.
  bool few(size_t lines) const { return static_cast<double>(lines) < fewest; }
};

/// What openings are fitted to.
struct FitInput {
  const LightGrid& grid;
  const FitLimits& limits;
};

}  // namespace tdpt
