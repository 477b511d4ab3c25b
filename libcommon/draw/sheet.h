// Colours, headings, captions, scales and legends of previews.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include "libcommon/draw/canvas.h"

namespace tdpt::draw {

/// Width of every preview [pixels] and the margins around its panels.
inline constexpr int kSheetWidth = 1600;
inline constexpr double kMargin = 36, kHeading = 92, kCaption = 40;
inline constexpr double kTitleSize = 17, kTextSize = 10.5, kSmallSize = 9;

/// Title and a plain sentence at the top left.
void heading(Canvas& canvas, const std::string& title, const std::string& sentence);
/// A line of text below a panel.
void caption(Canvas& canvas, const Box& panel, const std::string& words);
/// A bar of a round length in metres that ends at `right`, labelled above; returns its left end.
double scale_bar(Canvas& canvas, Point right, double pixels_per_metre);
/// Legend of heat(), from left to right, with a label at each end and a title above.
void heat_bar(Canvas& canvas, const Box& bar, const std::string& title, const std::string& low,
              const std::string& high);
/// Swatches with labels in a row from `start`; when full, in further rows kKeyRow below.
inline constexpr double kKeyRow = 26;
void key(Canvas& canvas, Point start, const std::vector<std::pair<Ink, std::string>>& entries);
/// Legend of reach(): light to the right, camera upwards.
void reach_square(Canvas& canvas, const Box& square, const std::string& light,
                  const std::string& camera);

/// 1234567 -> "1 234 567"; fractions are rounded to three digits.
std::string number(double value);
/// The file name of a path.
std::string base_name(const std::string& path);

// The colours of all previews, in one place so that they mean the same everywhere.

inline constexpr Ink kPaper = ink(0xfbfbfb), kInk = ink(0x23262d), kMuted = ink(0x6d727c),
                     kFaint = ink(0xd9d6cf), kVoid = ink(0xe7e7e3), kClay = ink(0xdedbd4),
                     kLight = ink(0xf4b860), kCamera = ink(0x7aaedb), kBoth = ink(0xb06fa6),
                     kPivot = ink(0xb3243f), kPortal = ink(0x0f8b6d), kAlarm = ink(0xc4314b),
                     kLamp = ink(0xffe14d);
/// Of plans: what is cut, the ground around a cellar, panes, the camera's mark, refused openings.
inline constexpr Ink kCutWall = ink(0x3a3e46), kCutEarth = ink(0xcfc8ba), kCutGlass = ink(0x4f9ac9),
                     kCutCamera = ink(0x2a6bab), kRefused = ink(0x8b8f97);

/// As vertex colours of a file, opaque by default.
std::array<uint8_t, 4> bytes_of(const Ink& c, uint8_t alpha = 255);

/// Colour map for amounts in [0,1]: from nearly the paper's colour over amber and red to dark
/// violet. Lightness falls monotonically, so more is always darker.
Ink heat(double amount);

/// How strongly light walks and camera walks reach a surface, each in [0,1]: clay if neither, amber
/// or blue if one, violet if both.
Ink reach(double light, double camera);

/// Colour of region k of n, in order from the light (0) to the camera (n - 1).
Ink region(int k, int n);

}  // namespace tdpt::draw
