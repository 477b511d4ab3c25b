// Makes names unique.
#pragma once
#include <map>
#include <set>
#include <string>

#include <fmt/format.h>

namespace tdpt {

class DistinctNames {
 public:
  /// The first of the two names that is not empty and not taken. If there is none, the first that
  /// is not empty, or `otherwise`, with a number: "door.1".
  std::string take(const std::string& first, const std::string& second,
                   const std::string& otherwise) {
    for (const std::string& name : {first, second})
      if (!name.empty() && taken_.insert(name).second) return name;
    const std::string base = !first.empty() ? first : !second.empty() ? second : otherwise;
    if (taken_.insert(base).second) return base;
    size_t& k = numbers_[base];  // all numbers below are taken
    std::string name;
    do name = fmt::format("{}.{}", base, ++k);
    while (!taken_.insert(name).second);
    return name;
  }

 private:
  std::set<std::string> taken_;
  std::map<std::string, size_t> numbers_;
};

}  // namespace tdpt
