// What --explain prints: the decisions of a run, each with its reason and its price.
#pragma once
#include <string>
#include <vector>

namespace tdpt {
class Phases;
}

namespace tdpt::cli {

/// Plain words without a full stop; numbers with their units.
struct Decision {
  std::string what;    ///< what is decided on
  std::string chosen;  ///< what was decided
  std::string reason;  ///< completes "because ..."
  std::string price;   ///< what that costs or saves: CPU seconds, rays, shares
};
using Decisions = std::vector<Decision>;

/// "what: chosen, because reason (price)"; without a price no brackets.
std::string sentence(const Decision& decision);

/// "1 round", "2 rounds".
std::string plural(size_t n, const char* noun);

/// "0.31 CPU s", of the phases so called together; of one that has not been, 0.
std::string price_of(const Phases& phases, const std::vector<std::string>& names);
/// The same of a number.
std::string price_of(double cpu_seconds);

}  // namespace tdpt::cli
