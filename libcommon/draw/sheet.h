// Headings, captions, scales and legends of previews.
#pragma once
#include <string>
#include <utility>

#include "libcommon/draw/colour.h"

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

}  // namespace tdpt::draw
