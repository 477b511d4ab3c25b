// Versions of our file formats: a whole number in each file. It grows when the reader of before
// would misunderstand the file, so a reader takes its own version and refuses every other one.
#pragma once
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/shown.h"

namespace tdpt {

/// What is written and read now. Where each file says it: the format's page in man/.
namespace format_version {
inline constexpr int max = 1, cut = 2, light_grid = 1, light_table = 1, portal = 1, picture = 1,
                     film = 1, plan = 1;
}

/// What is wrong with a file that says `found` as its version where `read` is read; "" when they
/// are the same.
inline std::string fault_of_version(std::string_view found, int read) {
  if (found == std::to_string(read)) return "";
  if (found.empty())
    return fmt::format("the file says no version of its format; this program reads version {}",
                       read);
  return fmt::format("this file has version {} of the format; this program reads version {}",
                     shown(found, 20), read);
}

/// Throws InputError for another version than `read`.
inline void check_version(const std::string& file, const std::string& place, std::string_view found,
                          int read) {
  if (const std::string fault = fault_of_version(found, read); !fault.empty())
    throw InputError(file, place, fault);
}

}  // namespace tdpt
