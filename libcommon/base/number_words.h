// Numbers formatted for people. Files, JSON and provenance use their own formats.
#pragma once
#include <string>

namespace tdpt {

/// `digits` significant digits, without an exponent from 1e-4 to 1e7: "0.00031", "140", "5300000".
std::string number_words(double value, int digits = 3);
/// "15 %" of 0.153, "100 %" of 1.
std::string percent_words(double share, int digits = 2);
/// "4.7 s", "3 minutes", "12 hours": two digits.
std::string duration_words(double seconds);

}  // namespace tdpt
