// The main() of the programs that measure: files, and options each followed by its value.
#pragma once
#include <cstdio>
#include <functional>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "libcommon/base/error.h"
#include "libcommon/formats/portal.h"

namespace tdpt {

using Files = std::vector<std::string>;

struct BenchOption {
  const char* name;
  /// A flag has no value; those of a list are parted by commas.
  std::variant<bool*, int*, uint64_t*, double*, std::string*, std::vector<std::string>*> target;
};

inline std::vector<std::string> listed(const std::string& list) {
  std::vector<std::string> words;
  std::istringstream in(list);
  for (std::string word; std::getline(in, word, ',');) words.push_back(word);
  return words;
}

/// Reads the command line and calls `run` with its files, at least `least_files` of them; its exit
/// code. `usage`: what is said of any other command line.
inline int run_bench(const std::vector<std::string>& words, const std::string& usage,
                     const std::vector<BenchOption>& options, size_t least_files,
                     const std::function<void(const Files&)>& run) {
  try {
    Files files;
    for (size_t i = 0; i < words.size(); ++i) {
      const BenchOption* option = nullptr;
      for (const BenchOption& o : options)
        if (words[i] == o.name) option = &o;
      if (!option && words[i].starts_with("--")) throw UsageError(usage);
      if (!option) {
        files.push_back(words[i]);
        continue;
      }
      if (auto* const flag = std::get_if<bool*>(&option->target)) {
        **flag = true;
        continue;
      }
      if (++i == words.size()) throw UsageError(usage);
      std::visit(
          [&value = words[i]](auto* target) {
            using Target = std::remove_pointer_t<decltype(target)>;
            if constexpr (std::is_same_v<Target, std::string>)
              *target = value;
            else if constexpr (std::is_same_v<Target, std::vector<std::string>>)
              *target = listed(value);
            else if constexpr (!std::is_same_v<Target, bool>)
              *target = static_cast<Target>(std::stod(value));
          },
          option->target);
    }
    if (files.size() < least_files) throw UsageError(usage);
    run(files);
    return 0;
  } catch (const Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return static_cast<int>(e.code);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}

/// The portals of all files from `first` on.
inline std::vector<Portal> portals_in(const Files& files, size_t first) {
  std::vector<Portal> portals;
  for (size_t i = first; i < files.size(); ++i)
    for (const Portal& p : read_portals(files[i]).portals) portals.push_back(p);
  return portals;
}

}  // namespace tdpt
