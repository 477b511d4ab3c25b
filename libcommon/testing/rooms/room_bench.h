// Shared by benchmarks over generated rooms: which rooms, how many in parallel, and where
// intermediate files are kept.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/known_rooms.h"

namespace tdpt::testing {

/// Arguments BIN [OPTION VALUE]...: --rooms, --seed, --kinds A,B, --jobs, --keep FOLDER, and the
/// benchmark's own options.
class RoomBench {
 public:
  /// `rooms` per kind unless --rooms says otherwise. `own`: the benchmark's own options with their
  /// defaults. Throws std::invalid_argument for unknown options.
  RoomBench(int argc, char** argv, std::vector<RoomKind> kinds, uint64_t rooms,
            std::map<std::string, std::string> own);

  const std::string& bin() const { return bin_; }  ///< folder of the programs
  bool keeps() const { return !temporary_; }
  const std::string& own(const std::string& name) const { return own_.at(name); }
  const std::vector<KnownRoom>& rooms() const { return rooms_; }

  /// Calls run(room, folder) for every room, in parallel, and after each, one at a time, done(room,
  /// row). Returns the rows in the order of the rooms.
  template <class Row>
  std::vector<Row> rows(
      const std::function<Row(const KnownRoom&, const std::filesystem::path&)>& run,
      const std::function<void(const KnownRoom&, const Row&)>& done) const {
    std::vector<Row> rows(rooms_.size());
    each([&](size_t i) { rows[i] = run(rooms_[i], folder_); },
         [&](size_t i) { done(rooms_[i], rows[i]); });
    return rows;
  }

 private:
  void each(const std::function<void(size_t)>& run, const std::function<void(size_t)>& done) const;

  std::string bin_;
  std::map<std::string, std::string> own_;
  std::vector<KnownRoom> rooms_;
  unsigned jobs_;
  std::optional<TempFolder> temporary_;
  std::filesystem::path folder_;
};

}  // namespace tdpt::testing
