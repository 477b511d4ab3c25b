// Dependency files as compilers write them with -MF: a rule that tells Make what a result was made
// from.
#pragma once
#include <string>
#include <vector>

namespace tdpt::cli {

/// The command line without the program, -MF FILE and -MQ TARGET (also in one word) as CLI11 knows
/// the settings that they are short for: it takes one dash for one letter.
std::vector<std::string> without_short_forms(int argc, const char* const* argv);

/// Throws UsageError where Make has no way to write this name: with ;, a tab or a line break, with
/// a backslash at its end, or of the form archive(member).
void check_make_name(const std::string& name);

/// "target: what was read", without recipe, then of each file read an empty rule: when one of them
/// is gone, the target is out of date, and Make asks for no rule that makes it. Names are quoted as
/// GNU Make wants; "-" and names that came before are left out.
std::string make_rule(const std::string& target, const std::vector<std::string>& read);

}  // namespace tdpt::cli
