// Versions of our file formats: an integer in each file. It grows when an older reader would
// misinterpret the file, so a reader accepts exactly its own version.
#pragma once
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"

namespace tdpt {

/// Versions written and read now. Each format's page in man/ says where its file holds it.
namespace format_version {
inline constexpr int max = 1, cut = 4, light_grid = 1, portal = 1, picture = 1, film = 4;
}

/// Error message if a file's version is `found` but `read` is expected; "" if they are equal.
inline std::string fault_of_version(std::string_view found, int read) {
  if (found == std::to_string(read)) return "";
  if (found.empty())
    return fmt::format("the file says no version of its format; this program reads version {}",
                       read);
  return fmt::format("this file has version {} of the format; this program reads version {}",
                     shown(found, 20), read);
}

/// Throws InputError for any other version than `read`.
inline void check_version(const std::string& file, const std::string& place, std::string_view found,
                          int read) {
  if (const std::string fault = fault_of_version(found, read); !fault.empty())
    throw InputError(file, place, fault);
}

}  // namespace tdpt
