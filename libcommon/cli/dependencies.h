// Dependency files as compilers write them with -MF: a Make rule that lists what a result was made
// from.
#pragma once
#include <string>
#include <vector>

namespace tdpt::cli {

/// The command line without the program, with -MF FILE and -MQ TARGET (also as one word) replaced
/// by the settings that they stand for: CLI11 takes a single dash for a single letter.
std::vector<std::string> without_short_forms(int argc, const char* const* argv);

/// Throws UsageError for a name that Make cannot express: with ;, a tab or a line break, with a
/// trailing backslash, or of the form archive(member).
void check_make_name(const std::string& name);

/// "target: inputs" without a recipe, then an empty rule for each input: if one of them is gone,
/// the target is out of date, and Make does not ask for a rule to make the input. Names are quoted
/// for GNU Make; "-" and duplicates are left out.
std::string make_rule(const std::string& target, const std::vector<std::string>& read);

}  // namespace tdpt::cli
