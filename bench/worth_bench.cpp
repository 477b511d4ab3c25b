// worth_bench BIN [OPTION VALUE]...: what portals are worth, measured. Renders generated rooms with
// their known openings as portals and without, against a long rendering, and sets beside the gain
// what portalfit expects of the portals it finds itself. Prints a row for each room on stderr and a
// table in markdown on stdout; doc/portal-worth.md comes from it.
//   --rooms N      rooms of each kind (2)
//   --seed N       of the first room of each kind (1)
//   --kinds A,B    only these kinds
//   --spp N        samples per pixel of what is judged (128); the reference has six times as many
//   --jobs N       rooms at a time, each on one thread (all cores)
//   --keep FOLDER  keeps scenes, pictures and what the stages wrote; pictures of an earlier run
//                  with the same options are not rendered again
//   --data FILE    a line for each room: kind, seed, measured gains, expected gain, for plots
//
// Efficiency = 1 / (v T), v = relMSE and T = CPU seconds of one sample per pixel. The gain is the
// ratio of two efficiencies. With m the relMSE between n samples and a reference of N samples of
// tdpt-org: m_org = v_org (1/n + 1/N), and for another integrator m = v/n + v_org/N.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/room_bench.h"
#include "libcommon/testing/known_rooms.h"
#include "libcommon/testing/portal_score.h"
#include "libcommon/testing/portal_stages.h"

namespace tdpt::testing {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr uint64_t kReference = 6;  // times as many samples

struct Row {
  bool failed = false;
  double area = 0;          // of the known openings [m2]
  double org = 0, ref = 0;  // measured gains of tdpt-org and of tdpt over bdpt
  double org_calm = 0;      // of tdpt-org with a thousandth of the pixels forgiven
  double conductance = 0,
         kept = 0;               // of the narrowest cut; share of the segments that are no leaks
  Json portals = Json::array();  // as portalfit reports them
  double expected = 0;           // the largest gain expected of one of them; 0: none found
};

Json json_of(const std::string& path) {
  std::ifstream in(path);
  return Json::parse(in, nullptr, false);
}

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<Portal> perfect_portals(const KnownRoom& room) {
  std::vector<Portal> portals;
  for (const KnownAperture& a : room.placed_apertures()) {
    Portal p;
    p.vertices = a.outline;
    const bool turned =
        dot(cross(a.outline[1] - a.outline[0], a.outline[2] - a.outline[0]), a.normal) < 0;
    for (uint32_t i = 2; i < a.outline.size(); ++i)
      p.triangles.push_back(turned ? std::array<uint32_t, 3>{0, i, i - 1}
                                   : std::array<uint32_t, 3>{0, i - 1, i});
    portals.push_back(p);
  }
  return portals;
}

double area_of(const std::vector<Portal>& portals) {
  double sum = 0;
  for (const Portal& p : portals)
    for (const auto& t : p.triangles)
      sum += 0.5 * length(cross(p.vertices[t[1]] - p.vertices[t[0]],
                                p.vertices[t[2]] - p.vertices[t[0]]));
  return sum;
}

class RoomRun {
 public:
  RoomRun(const RoomBench& bench, uint64_t spp, const KnownRoom& room, const fs::path& folder)
      : bench_(bench),
        spp_(spp),
        room_(room),
        stem_((folder / fs::path(room.file()).stem()).string()) {}

  Row run() {
    const std::string scene = room_.plan.glb(room_.writing);
    if (text_of(stem_ + ".glb") != scene)
      for (const char* of : {"reference", "bdpt", "tdpt", "tdpt-org"})
        fs::remove(stem_ + "." + of + ".exr");
    std::ofstream(stem_ + ".glb", std::ios::binary) << scene;
    const std::vector<Portal> portals = perfect_portals(room_);
    PortalFile file;
    file.portals = portals;
    std::ofstream(stem_ + ".true.glb", std::ios::binary) << portal_bytes(file);
    const double scale = room_.writing.placement.scale;
    row_.area = area_of(portals) / (scale * scale);
    find_portals();
    measure();
    if (!bench_.keeps()) {
      remove_stages(stem_);
      for (const char* end :
           {".true.glb", ".reference.exr", ".bdpt.exr", ".tdpt.exr", ".tdpt-org.exr"})
        fs::remove(stem_ + end);
    }
    return row_;
  }

 private:
  void command(const std::string& text) {
    if (std::system((bench_.bin() + "/" + text + " 2>>" + stem_ + ".txt").c_str()) != 0)
      row_.failed = true;
  }

  void find_portals() {
    row_.failed = run_stages({.bin = bench_.bin()}, stem_).failed;
    if (row_.failed) return;
    const Json cut = json_of(stem_ + ".mincut.json"), grid = json_of(stem_ + ".lightgrid.json"),
               fit = json_of(stem_ + ".portalfit.json");
    row_.conductance = 1;
    for (const Json& c : cut.at("cuts"))
      row_.conductance = std::min(row_.conductance, c.at("conductance").get<double>());
    const double visible = grid.at("visible"), kept = grid.at("kept");
    row_.kept = visible > 0 ? kept / visible : 0;
    row_.portals = fit.at("portals");
    for (const Json& p : row_.portals)
      row_.expected = std::max(row_.expected, p.value("expected_gain", 0.0));
  }

  struct Measured {
    double seconds, relmse, calm;
  };
  double render(const std::string& integrator, uint64_t spp, uint64_t seed,
                const std::string& picture) {
    const std::string stats = stem_ + "." + integrator + ".stats.json";
    if (!fs::exists(picture))
      command(
          fmt::format("tdpt-render --threads 1 --quiet --no-provenance {0}.glb {1} --integrator "
                      "{2} --spp {3} --seed {4} --width 48 --height 36 -o {5} --json >{6}",
                      stem_, integrator == "bdpt" ? "" : "--portal " + stem_ + ".true.glb",
                      integrator, spp, seed, picture, stats));
    const Json j = json_of(stats);
    return row_.failed ? 0 : j.at("cpu_seconds").get<double>();
  }
  Measured judge(const std::string& integrator) {
    const std::string picture = stem_ + "." + integrator + ".exr";
    Measured m{render(integrator, spp_, 1, picture), 0, 0};
    const std::string report = stem_ + ".exrdiff.json";
    command("exrdiff --json " + picture + " " + stem_ + ".reference.exr >" + report);
    if (row_.failed) return m;
    const Json j = json_of(report);
    m.relmse = j.at("relmse");
    m.calm = j.at("relmse_trimmed");
    return m;
  }

  void measure() {
    if (row_.failed) return;
    render("tdpt-org", kReference * spp_, 2, stem_ + ".reference.exr");
    const Measured bdpt = judge("bdpt"), ref = judge("tdpt"), org = judge("tdpt-org");
    if (row_.failed) return;
    const double k = kReference;
    // v per sample times n, up to the factor n that all have in common.
    const auto gain = [&](double b, double o, double other, double seconds, bool is_org) {
      const double v_org = o / (1 + 1 / k);
      const double v_b = b - v_org / k, v = is_org ? v_org : other - v_org / k;
      return v_b * bdpt.seconds / (v * seconds);
    };
    row_.org = gain(bdpt.relmse, org.relmse, 0, org.seconds, true);
    row_.org_calm = gain(bdpt.calm, org.calm, 0, org.seconds, true);
    row_.ref = gain(bdpt.relmse, org.relmse, ref.relmse, ref.seconds, false);
  }

  const RoomBench& bench_;
  uint64_t spp_;
  const KnownRoom& room_;
  std::string stem_;
  Row row_;
};

void print_row(const KnownRoom& room, const Row& r) {
  if (r.failed) {
    std::fprintf(stderr, "%s FAILED\n", room.file().c_str());
    return;
  }
  std::fprintf(stderr,
               "%-13s %2llu  area %.4g  org %.2f (calm %.2f)  tdpt %.2f  conductance %.3g kept "
               "%.2f  expected %.2f  lamp %s\n",
               name_of(room.kind), static_cast<unsigned long long>(room.seed), r.area, r.org,
               r.org_calm, r.ref, r.conductance, r.kept, r.expected, room.lamp.c_str());
}

void print_table(const std::vector<KnownRoom>& rooms, const std::vector<Row>& rows) {
  std::printf(
      "| room | openings [m2] | lamp | tdpt-org / bdpt | tdpt / bdpt | portals found | expected | "
      "measured / expected |\n|---|---|---|---|---|---|---|---|\n");
  double sum = 0, square = 0, n = 0, close = 0;
  for (size_t i = 0; i < rooms.size(); ++i) {
    const Row& r = rows[i];
    if (r.failed) continue;
    std::printf("| %s %llu | %.3g | %s | %.2f | %.2f | %zu |", name_of(rooms[i].kind),
                static_cast<unsigned long long>(rooms[i].seed), r.area, rooms[i].lamp.c_str(),
                r.org, r.ref, r.portals.size());
    if (!(r.expected > 0)) {
      std::printf(" - | - |\n");
      continue;
    }
    std::printf(" %.2f | %.2f |\n", r.expected, r.org / r.expected);
    const double e = std::log(r.org / r.expected);
    sum += e, square += e * e, ++n;
    close += std::abs(e) <= std::log(2.0);
  }
  if (n > 1) {
    const double mean = sum / n;
    std::printf(
        "\nMeasured over expected: geometric mean %.2f, standard deviation a factor of %.2f; %g of "
        "%g rooms within a factor of two.\n",
        std::exp(mean), std::exp(std::sqrt(std::max(0.0, square / n - mean * mean))), close, n);
  }
}

void write_data(const std::string& path, const std::vector<KnownRoom>& rooms,
                const std::vector<Row>& rows) {
  std::ofstream out(path);
  for (size_t i = 0; i < rooms.size(); ++i)
    if (const Row& r = rows[i]; !r.failed)
      out << fmt::format("{} {} {} {} {} {} {} {} {} {}\n", name_of(rooms[i].kind), rooms[i].seed,
                         r.org, r.ref, r.expected, r.org_calm, r.area, r.conductance, r.kept,
                         r.portals.dump());
}

int main_of(int argc, char** argv) {
  std::vector<RoomKind> kinds = all_room_kinds();
  // One has no opening to put a portal into, the other needs a thousand times the samples.
  std::erase(kinds, RoomKind::open_room);
  std::erase(kinds, RoomKind::keyhole);
  const RoomBench bench(argc, argv, kinds, 2, {{"--spp", "128"}, {"--data", ""}});
  const uint64_t spp = std::stoull(bench.own("--spp"));
  const std::vector<Row> rows = bench.rows<Row>(
      [&](const KnownRoom& room, const fs::path& folder) {
        return RoomRun(bench, spp, room, folder).run();
      },
      print_row);
  print_table(bench.rooms(), rows);
  if (!bench.own("--data").empty()) write_data(bench.own("--data"), bench.rooms(), rows);
  return 0;
}

}  // namespace
}  // namespace tdpt::testing

int main(int argc, char** argv) {
  try {
    return tdpt::testing::main_of(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "worth_bench: %s\n", e.what());
    return 1;
  }
}
