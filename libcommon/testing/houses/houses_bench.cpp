// What light passes the openings of a building on its way to a camera, and how right portals are.
//
//   houses_bench paths SCENE CAMERA SKY|- PATHS   draws light paths into the file PATHS
//   houses_bench score SCENE CAMERA OPENINGS PATHS [PORTALS]...   a line of JSON per portal file
#include <cstdio>
#include <fstream>

#include <nlohmann/json.hpp>

#include "libcommon/base/file.h"
#include "libcommon/formats/environment.h"
#include "libcommon/testing/houses/house_score.h"

namespace tdpt::testing {
namespace {

constexpr uint64_t kWalks = 4 << 20;
constexpr int kDepth = 24;
constexpr size_t kKept = 20000;

void draw(const std::string& file, const std::string& camera, const std::string& sky,
          const std::string& out) {
  Scene scene = read_gltf(file);
  open_glass(scene);
  take_lamps_as(scene, scene.lamp_units.kind);
  if (sky != "-") scene.sky = std::make_shared<Sky>(parse_environment(read_file(sky), sky), 0.0);
  const LightPaths paths = light_paths(scene, scene.camera(camera), kWalks, kDepth, kKept);
  std::ofstream(out, std::ios::binary) << text_of(paths);
  std::fprintf(stderr, "%s %s: %zu paths, %.0f effective\n", file.c_str(), camera.c_str(),
               paths.paths.size(), paths.effective);
}

nlohmann::json json_of(const HouseScore& score, const std::vector<HouseOpening>& openings,
                       const std::vector<Portal>& portals) {
  nlohmann::json out{{"openings", nlohmann::json::array()}, {"portals", nlohmann::json::array()}};
  for (size_t o = 0; o < openings.size(); ++o) {
    const OpeningScore& s = score.openings[o];
    if (s.light < 0.001 && s.portals.empty()) continue;
    const Vec3d way = openings[o].part.normal * (s.forward ? 1 : -1);
    out["openings"].push_back({{"name", openings[o].name},
                               {"kind", openings[o].kind},
                               {"state", openings[o].state},
                               {"rooms", openings[o].rooms},
                               {"light", s.light},
                               {"towards", {way.x, way.y, way.z}},
                               {"coverage", s.coverage},
                               {"tightness", s.tightness},
                               {"angle", s.angle},
                               {"portals", s.portals},
                               {"right", s.right()}});
  }
  for (size_t p = 0; p < portals.size(); ++p) {
    std::vector<std::string> names;
    for (const size_t o : score.portals[p].openings) names.push_back(openings[o].name);
    out["portals"].push_back({{"area", area_of(portals[p])},
                              {"light", score.portals[p].light},
                              {"tightness", score.portals[p].tightness},
                              {"angle", score.portals[p].angle},
                              {"openings", names}});
  }
  return out;
}

void score(const std::vector<std::string>& words) {
  Scene scene = read_gltf(words[1]);
  for (Material& m : scene.materials)
    if (m.transmission > 0)
      m.alpha_mode = Material::Alpha::blend, m.alpha = 0, m.maps[MAP_BASE] = {};
  const Tracer tracer(scene);
  const std::vector<HouseOpening> openings = read_openings(words[3]);
  const LightPaths paths = read_light_paths(words[4]);
  for (size_t i = 5; i < std::max<size_t>(words.size(), 6); ++i) {
    const std::vector<Portal> portals =
        i < words.size() ? read_portals(words[i]).portals : std::vector<Portal>{};
    std::puts(json_of(score_house(scene, tracer, openings, paths, portals), openings, portals)
                  .dump()
                  .c_str());
  }
}

}  // namespace
}  // namespace tdpt::testing

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    if (words.size() == 5 && words[0] == "paths")
      tdpt::testing::draw(words[1], words[2], words[3], words[4]);
    else if (words.size() >= 5 && words[0] == "score")
      tdpt::testing::score(words);
    else
      throw std::invalid_argument(
          "expected: paths SCENE CAMERA SKY|- PATHS, or score SCENE CAMERA OPENINGS PATHS "
          "[PORTALS]...");
  } catch (const std::exception& e) {
    std::fprintf(stderr, "houses_bench: %s\n", e.what());
    return 1;
  }
}
