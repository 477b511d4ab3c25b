#include "libcommon/testing/rooms/room_bench.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace tdpt::testing {

namespace {

// names: of some of the kinds, separated by commas.
std::vector<RoomKind> those_of(const std::string& names, const std::vector<RoomKind>& kinds) {
  std::vector<RoomKind> found;
  std::istringstream words(names);
  for (std::string word; std::getline(words, word, ',');) {
    const auto kind =
        std::find_if(kinds.begin(), kinds.end(), [&](RoomKind k) { return word == name_of(k); });
    if (kind == kinds.end()) throw std::invalid_argument(word + " is no kind of room");
    found.push_back(*kind);
  }
  return found;
}

}  // namespace

RoomBench::RoomBench(int argc, char** argv, std::vector<RoomKind> kinds, uint64_t rooms,
                     std::map<std::string, std::string> own)
    : own_(std::move(own)), jobs_(std::max(1u, std::thread::hardware_concurrency())) {
  if (argc < 2 || argc % 2 != 0 || argv[1][0] == '-')
    throw std::invalid_argument("expected the folder of the programs, then options with values");
  bin_ = argv[1];
  uint64_t seed = 1;
  for (int i = 2; i + 1 < argc; i += 2) {
    const std::string name = argv[i], value = argv[i + 1];
    if (name == "--rooms")
      rooms = std::stoull(value);
    else if (name == "--seed")
      seed = std::stoull(value);
    else if (name == "--jobs")
      jobs_ = static_cast<unsigned>(std::stoul(value));
    else if (name == "--keep")
      folder_ = value;
    else if (name == "--kinds")
      kinds = those_of(value, kinds);
    else if (const auto at = own_.find(name); at != own_.end())
      at->second = value;
    else
      throw std::invalid_argument(name + " is no option of it");
  }
  if (folder_.empty()) folder_ = temporary_.emplace().path;
  std::filesystem::create_directories(folder_);
  for (const RoomKind kind : kinds)
    for (uint64_t i = 0; i < rooms; ++i) rooms_.push_back(known_room(kind, seed + i));
}

void RoomBench::each(const std::function<void(size_t)>& run,
                     const std::function<void(size_t)>& done) const {
  std::atomic<size_t> next{0};
  std::mutex one_at_a_time;
  std::vector<std::thread> workers;
  for (unsigned w = 0; w < jobs_; ++w)
    workers.emplace_back([&] {
      for (size_t i; (i = next++) < rooms_.size();) {
        run(i);
        const std::lock_guard lock(one_at_a_time);
        done(i);
      }
    });
  for (std::thread& worker : workers) worker.join();
}

}  // namespace tdpt::testing
