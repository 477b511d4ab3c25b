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
  double threshold = 0.02;  ///< smallest share of a camera's light that makes a portal
  double fewest = 30;       ///< lines, or probes, that tell anything
  /// Least share of its outline that is an edge: of most openings it is 0.4 to 1, of planes across
  /// a room 0 to 0.2.
  double least_edge = 0.3;
  /// Voxels: narrower bars do not show, nor do edges of what is less than twice as wide.
  double resolved = 2;
  /// Ratio of areas up to which they are alike: of a prism's faces and middle, of an outline and
  /// one that takes all of its lines.
  double alike = 1.08;
  /// Ratio of areas from which one is clearly the wider: of a tube's faces over its middle, of what
  /// is near an outline over the outline.
  double widening = 1.5;

  // The lines of an opening.
  double dense_cell = 0.1;     ///< of the mean density: least of a cell in the bundle
  double points_per_cell = 8;  ///< of its finer histograms
  /// Cosine with the normal: a crossing with less is not clear, and counts as this where slants are
  /// averaged.
  double grazing = 0.05;

  // The tube that an opening cuts into its wall.
  double missing = 2;           ///< worth of a line against area, in logarithms
  double missing_of_few = 0.3;  ///< the same of few lines
  double missing_of_known = 3;  ///< the same of lines that pass for certain
  double many = 500;            ///< lines that are not few: they tell their mean direction
  double outside = 0.0006;      ///< share of a tube's crossings beyond each side of its outline
  /// Share of the lines that is next to none: beyond each side of a plane's outline, and too few
  /// that pass both faces of a tube.
  double hardly_any = 0.002;
  double turn = 0.25;         ///< tangent between the starts of a search
  double rough_lines = 2000;  ///< of the first searches
  double fine_lines = 8192;   ///< of the others
  double first_step = 0.3;    ///< of a search, in shorter sides, and the largest tilt of a step
  double fine_step = 0.1;     ///< of a search that goes on
  double rough_last = 0.05;   ///< last step of the first searches
  double fine_last = 0.004;   ///< of the others
  double plane_holds = 0.97;  ///< share of a tube's lines with which a plane takes its place
  double blind_end = 0.1;     ///< of its depth, behind which lines end on the end of a room
  /// Cosine between planes that may be one, such as a tube's and a wall's; others bound each other.
  double parallel = 0.966;
  double square = 0.15;  ///< of the etendue, by which it may be the larger there

  // Its outline.
  /// Of an area or of lines, what does not matter: what one corner fewer adds, or strays; and lines
  /// that two openings share.
  double slight = 0.01;
  double within = 0.85;        ///< of the depth: where the outline is taken
  double most_trimmed = 0.02;  ///< share of the lines that may be strays
  double sparse = 10;          ///< share of the area over that of the lines, where strays are
  /// Of its shorter side or its size, how far what belongs to an opening may be from it: lines that
  /// end before it or behind it, mullions within it, panes that are not quite in one plane; a room
  /// that it opens into goes on farther than that.
  double beside = 0.2;

  // Several openings.
  double denser = 1.3;  ///< lines per area of a part over those of the whole
  /// Share that stands for the whole: open of a joint outline, then panes are joined across
  /// mullions; light of two cameras that passes both portals, then they are one; support, and with
  /// less one of two windows may be the opening.
  double mostly = 0.8;

  /// Whether so few lines tell nothing.
  bool few(size_t lines) const { return static_cast<double>(lines) < fewest; }
};

/// What openings are fitted to.
struct FitInput {
  const LightGrid& grid;
  const FitLimits& limits;
};

}  // namespace tdpt
