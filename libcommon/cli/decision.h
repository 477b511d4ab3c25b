// What --explain prints: the decisions of a run, each with its reason and its price.
#pragma once
#include <string>
#include <vector>

namespace tdpt {
class Phases;
}

namespace tdpt::cli {

/// In plain words without a full stop; numbers with their units.
struct Decision {
  std::string what;    ///< what is decided on
  std::string chosen;  ///< what was decided
  std::string reason;  ///< completes "because ..."; may be empty
  std::string price;   ///< what it costs or saves: CPU seconds, rays, shares
};
using Decisions = std::vector<Decision>;

/// "what: chosen, because reason (price)"; without what is empty.
std::string sentence(const Decision& decision);

/// "1 round", "2 rounds".
std::string plural(size_t n, const char* noun);

/// "0.31 CPU s": the phases of these names together; a phase that did not run counts 0.
std::string price_of(const Phases& phases, const std::vector<std::string>& names);
/// The same for a number.
std::string price_of(double cpu_seconds);

}  // namespace tdpt::cli
