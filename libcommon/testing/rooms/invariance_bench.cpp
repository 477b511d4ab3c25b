// invariance_bench BIN [ROOMS]: writes the same rooms in different ways and measures how far their
// portals move. Prints a table in Markdown on stdout, with distances in voxels of the light grid.
// The first row is for another seed, for comparison with chance.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/known_rooms.h"
#include "libcommon/testing/rooms/portal_score.h"
#include "libcommon/testing/rooms/portal_stages.h"

namespace tdpt::testing {
namespace {

struct Variant {
  const char* name;
  Writing writing;
  const char* seed = "";
};

std::vector<Variant> variants() {
  std::vector<Variant> all(10);
  all[0].name = "as it is";
  all[1].name = "another seed", all[1].seed = "--seed 77";
  all[2].name = "every triangle in 4", all[2].writing.splitting = Splitting::in_4;
  all[3].name = "every triangle in 144", all[3].writing.splitting = Splitting::in_144;
  all[4].name = "slivers", all[4].writing.splitting = Splitting::slivers;
  all[5].name = "triangles in another order", all[5].writing.shuffle = 5;
  all[6].name = "lamp 1000 times as bright", all[6].writing.power = 1000;
  all[7].name = "turned by 33 degrees", all[7].writing.placement.axis = {0.3, 1, 0.2};
  all[7].writing.placement.angle = 0.576;
  all[8].name = "in centimetres", all[8].writing.placement.scale = 100;
  all[9].name = "10 km away", all[9].writing.placement.move = {8000, 100, -6000};
  return all;
}

void measure(const std::string& bin, uint64_t rooms) {
  const RoomKind kinds[] = {RoomKind::hole, RoomKind::through_floor, RoomKind::two_openings,
                            RoomKind::holes_in_row, RoomKind::slit};
  const TempFolder folder;
  const std::string stem = (folder.path / "room").string();
  std::printf("| change | rooms | same number | median distance | 90 %% | largest |\n");
  std::printf("|---|---|---|---|---|---|\n");
  std::vector<StagesRun> first;
  for (const Variant& variant : variants()) {
    std::vector<double> distances;
    size_t at = 0, same = 0;
    for (const RoomKind kind : kinds)
      for (uint64_t seed = 1; seed <= rooms; ++seed, ++at) {
        const KnownRoom room = known_room(kind, seed);
        std::ofstream(stem + ".glb", std::ios::binary) << room.plan.glb(variant.writing);
        PortalStages stages{bin, {}, static_cast<int>(std::thread::hardware_concurrency())};
        for (const char* name : {"ffgraph", "lightgrid"}) stages.options[name] = variant.seed;
        StagesRun run = run_stages(stages, stem);
        if (first.size() == at) {  // the unmodified room
          first.push_back(run);
          continue;
        }
        std::vector<Portal> base = first[at].portals;
        for (Portal& portal : base)
          for (Vec3d& v : portal.vertices) v = variant.writing.placement(v);
        if (base.size() != run.portals.size()) {
          std::fprintf(stderr, "%s: %s: %zu portals, %zu before\n", room.file().c_str(),
                       variant.name, run.portals.size(), base.size());
          continue;
        }
        ++same;
        double worst = 0;
        for (const Portal& portal : run.portals)
          worst = std::max(worst, distance_to_nearest(portal, base));
        distances.push_back(worst / run.voxel);
        std::fprintf(stderr, "%s: %s: %.3f voxels\n", room.file().c_str(), variant.name,
                     distances.back());
      }
    if (distances.empty()) continue;
    std::sort(distances.begin(), distances.end());
    std::printf("| %s | %zu | %zu | %.2f | %.2f | %.2f |\n", variant.name, at, same,
                distances[distances.size() / 2], distances[distances.size() * 9 / 10],
                distances.back());
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace tdpt::testing

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: invariance_bench BIN [ROOMS]\n");
    return 2;
  }
  tdpt::testing::measure(argv[1], argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 3);
}
