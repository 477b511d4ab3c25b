// The colours of all previews, in one place so that they mean the same everywhere, and the words of
// numbers.
#pragma once
#include <string>

#include "libcommon/draw/canvas.h"

namespace tdpt::draw {

/// 1234567 -> "1 234 567"; fractions are rounded to three digits.
std::string number(double value);
/// The file name of a path.
std::string base_name(const std::string& path);

inline constexpr Ink kPaper = ink(0xfbfbfb), kInk = ink(0x23262d), kMuted = ink(0x6d727c),
                     kFaint = ink(0xd9d6cf), kVoid = ink(0xe7e7e3), kClay = ink(0xdedbd4),
                     kLight = ink(0xf4b860), kCamera = ink(0x7aaedb), kBoth = ink(0xb06fa6),
                     kPivot = ink(0xb3243f), kPortal = ink(0x0f8b6d), kAlarm = ink(0xc4314b),
                     kLamp = ink(0xffe14d);
/// In plans: what is cut, panes, the camera's mark, refused openings.
inline constexpr Ink kCutWall = ink(0x3a3e46), kCutGlass = ink(0x4f9ac9),
                     kCutCamera = ink(0x2a6bab), kRefused = ink(0x8b8f97);

/// Colour map for amounts in [0,1]: from nearly the paper's colour over amber and red to dark
/// violet. Lightness falls monotonically, so more is always darker.
Ink heat(double amount);

/// How strongly light walks and camera walks reach a surface, each in [0,1]: clay if neither, amber
/// or blue if one, violet if both.
Ink reach(double light, double camera);

/// Colour of region k of n, in order from the light (0) to the camera (n - 1).
Ink region(int k, int n);

}  // namespace tdpt::draw
