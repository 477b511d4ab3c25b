// portals_bench BIN [OPTION VALUE]...: runs the four stages on generated rooms with known openings
// and scores the portals. Prints a row for each room on stderr and tables in Markdown on stdout.
//   --rooms N      rooms of each kind (20)
//   --seed N       of the first room of each kind (1)
//   --kinds A,B    only these kinds
//   --jobs N       rooms at a time, each on one thread (all cores)
//   --keep FOLDER  keeps scenes and the output of the stages
//   --ffgraph, --mincut, --lightgrid, --portalfit "OPTIONS"   for a stage
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/known_rooms.h"
#include "libcommon/testing/rooms/portal_score.h"
#include "libcommon/testing/rooms/portal_stages.h"

namespace tdpt::testing {
namespace {
namespace fs = std::filesystem;

struct Row {
  PortalScore score;
  StagesRun run;
};

// A keyhole need not be found if a note warns that light may pass undetected.
bool said_so(const KnownRoom& room, const StagesRun& run) {
  return room.kind == RoomKind::keyhole && run.portals.empty() &&
         run.said.find("where no walk passed") != std::string::npos;
}

Row run(const PortalStages& stages, bool keeps, const KnownRoom& room, const fs::path& folder) {
  const std::string stem = (folder / fs::path(room.file()).stem()).string();
  std::ofstream(stem + ".glb", std::ios::binary) << room.plan.glb(room.writing);
  Row row;
  PortalStages with_sky = stages;
  with_sky.sky = room.sky;
  row.run = run_stages(with_sky, stem);
  row.score = score(row.run.portals, said_so(room, row.run) ? std::vector<KnownAperture>{}
                                                            : room.placed_apertures());
  if (!keeps) remove_stages(stem);
  return row;
}

const char* const kSplittings[] = {"whole", "in 4", "in 144", "slivers"};

void print_row(const KnownRoom& room, const Row& row) {
  const PortalScore& s = row.score;
  const Placement& p = room.writing.placement;
  std::fprintf(stderr,
               "%-5s %-14s %3llu  portals %zu/%zu  coverage %.4f  tightness %.3f  angle %5.2f  "
               "strays %zu  lamp %-7s wall %.3f %-7s scale %g %s %.2f s%s\n",
               s.right() ? "ok" : "MISS", name_of(room.kind),
               static_cast<unsigned long long>(room.seed), s.portals, s.openings, s.coverage,
               s.tightness, s.angle, s.strays, room.lamp.c_str(),
               room.apertures.empty() ? 0 : room.apertures[0].thickness,
               kSplittings[static_cast<size_t>(room.writing.splitting)], p.scale,
               p.angle != 0 ? "turned" : "", row.run.cpu_seconds, row.run.failed ? "  FAILED" : "");
  if (s.portals < s.openings || s.strays > 0)
    std::fprintf(stderr, "      %s", row.run.said.c_str());
}

struct Tally {
  std::string name;
  size_t rooms = 0, right = 0, covered = 0, tight = 0, straight = 0, counted = 0, strays = 0;
  double seconds = 0;
  std::vector<double> coverages, tightnesses, angles;

  void add(const Row& row) {
    const PortalScore& s = row.score;
    ++rooms;
    right += s.right();
    covered += s.coverage >= 0.98;
    tight += s.tightness >= 0.90;
    straight += s.angle <= 3;
    counted += s.right_number();
    strays += s.strays;
    coverages.push_back(s.coverage);
    tightnesses.push_back(s.tightness);
    angles.push_back(s.angle);
    seconds += row.run.cpu_seconds;
  }
  double percent_right() const {
    return 100 * static_cast<double>(right) / static_cast<double>(rooms);
  }
};

double median(std::vector<double> v) {
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

void print_line(const Tally& t) {
  std::printf("| %s | %zu | %zu | %zu | %zu | %zu | %zu | %zu | %.4f | %.3f | %.2f | %.2f |\n",
              t.name.c_str(), t.rooms, t.right, t.covered, t.tight, t.straight, t.counted, t.strays,
              median(t.coverages), median(t.tightnesses), median(t.angles),
              t.seconds / static_cast<double>(t.rooms));
}

// Targets: percentage of rooms in which all four scores are right.
constexpr double kTogether = 95, kEachKind = 80;

void print_verdict(const std::vector<Tally>& kinds, const Tally& all) {
  const auto share = [](const Tally& t) {
    return fmt::format("{} of {} rooms right, {:.1f} %", t.right, t.rooms, t.percent_right());
  };
  const Tally& worst = *std::min_element(
      kinds.begin(), kinds.end(),
      [](const Tally& a, const Tally& b) { return a.percent_right() < b.percent_right(); });
  std::string below;
  for (const Tally& t : kinds)
    if (t.percent_right() < kEachKind) below += (below.empty() ? "" : ", ") + t.name;
  fmt::print(
      "\nAll kinds together: {} (target: {} %).  \n"
      "The worst kind: {}, {} (target: {} %); below that: {}.\n",
      share(all), kTogether, worst.name, share(worst), kEachKind, below.empty() ? "none" : below);
}

void print_table(const std::vector<KnownRoom>& rooms, const std::vector<Row>& rows) {
  std::vector<Tally> kinds;
  Tally all;
  all.name = "all kinds together";
  for (size_t i = 0; i < rooms.size(); ++i) {
    const char* const name = name_of(rooms[i].kind);
    if (kinds.empty() || kinds.back().name != name) kinds.emplace_back().name = name;
    kinds.back().add(rows[i]);
    all.add(rows[i]);
  }
  std::printf(
      "| kind | rooms | all four | coverage >= 0.98 | tightness >= 0.90 | angle <= 3 | right "
      "number "
      "| strays | median coverage | median tightness | median angle | CPU s |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  if (rooms.empty()) return;
  for (const Tally& kind : kinds) print_line(kind);
  print_line(all);
  print_verdict(kinds, all);
}

struct Asked {
  PortalStages stages;
  std::vector<RoomKind> kinds = all_room_kinds();
  uint64_t rooms = 20, seed = 1;
  unsigned jobs = std::max(1u, std::thread::hardware_concurrency());
  std::string keep;
};

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

Asked asked_of(int argc, char** argv) {
  if (argc < 2 || argc % 2 != 0 || argv[1][0] == '-')
    throw std::invalid_argument("expected the folder of the programs, then options with values");
  Asked a;
  a.stages.bin = argv[1];
  a.kinds.insert(a.kinds.end(), sky_room_kinds().begin(), sky_room_kinds().end());
  for (int i = 2; i + 1 < argc; i += 2) {
    const std::string name = argv[i], value = argv[i + 1];
    if (name == "--rooms")
      a.rooms = std::stoull(value);
    else if (name == "--seed")
      a.seed = std::stoull(value);
    else if (name == "--jobs")
      a.jobs = static_cast<unsigned>(std::stoul(value));
    else if (name == "--keep")
      a.keep = value;
    else if (name == "--kinds")
      a.kinds = those_of(value, a.kinds);
    else if (name == "--ffgraph" || name == "--mincut" || name == "--lightgrid" ||
             name == "--portalfit")
      a.stages.options[name.substr(2)] = value;
    else
      throw std::invalid_argument(name + " is no option of it");
  }
  return a;
}

void run_all(const Asked& asked) {
  const TempFolder temporary;
  const fs::path folder = asked.keep.empty() ? temporary.path : fs::path(asked.keep);
  fs::create_directories(folder);
  std::vector<KnownRoom> rooms;
  for (const RoomKind kind : asked.kinds)
    for (uint64_t i = 0; i < asked.rooms; ++i) rooms.push_back(known_room(kind, asked.seed + i));
  std::vector<Row> rows(rooms.size());
  std::atomic<size_t> next{0};
  std::mutex one_at_a_time;
  std::vector<std::thread> workers;
  for (unsigned w = 0; w < asked.jobs; ++w)
    workers.emplace_back([&] {
      for (size_t i; (i = next++) < rooms.size();) {
        rows[i] = run(asked.stages, !asked.keep.empty(), rooms[i], folder);
        const std::lock_guard lock(one_at_a_time);
        print_row(rooms[i], rows[i]);
      }
    });
  for (std::thread& worker : workers) worker.join();
  print_table(rooms, rows);
}

}  // namespace
}  // namespace tdpt::testing

int main(int argc, char** argv) {
  try {
    tdpt::testing::run_all(tdpt::testing::asked_of(argc, argv));
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "portals_bench: %s\n", e.what());
    return 1;
  }
}
