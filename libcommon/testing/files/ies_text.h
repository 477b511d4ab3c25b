// Text of an IES LM-63 file.
#pragma once
#include <fmt/format.h>

#include <string>
#include <vector>

namespace tdpt::testing {

struct IesText {
  int type = 1;  ///< 1: C, 2: B, 3: A
  double multiplier = 1, ballast = 1;
  std::vector<double> vertical, horizontal{0};
  std::vector<double> candela;  ///< by horizontal angle, then by vertical
  std::string tilt = "NONE";

  std::string text() const {
    const auto lines = [](const std::vector<double>& v) {
      return fmt::format("{}\n", fmt::join(v, " "));
    };
    return fmt::format(
               "IESNA:LM-63-2002\n[MANUFAC] none\nTILT={}\n1 1000 {} {} {} {} 2 0 0 0\n{} 1 60\n",
               tilt, multiplier, vertical.size(), horizontal.size(), type, ballast) +
           lines(vertical) + lines(horizontal) + lines(candela);
  }
};

}  // namespace tdpt::testing
