#include "tools/tdpt-info/knowledge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/words.h"
#include "libcommon/film/film_file.h"
#include "libcommon/formats/cut.h"
#include "libcommon/formats/dimacs.h"
#include "libcommon/formats/environment.h"
#include "libcommon/formats/light_tables.h"
#include "libcommon/formats/portal.h"
#include "libcommon/formats/viewpoint.h"
#include "libcommon/math/reach.h"
#include "libcommon/scene/scene.h"

namespace tdpt {
namespace {

using Json = nlohmann::ordered_json;

// A file that was made from a scene, for cameras: the only one is "camera", several are "camera_1"
// and so on.
template <class File>
void describe(const File& file, const std::vector<std::string>& cameras, const char* kind,
              Knowledge& k) {
  k.kind = kind;
  k.scene = file.scene_hash;
  k.provenance = file.provenance;
  for (size_t i = 0; i < cameras.size(); ++i)
    k.facts[cameras.size() == 1 ? "camera" : fmt::format("camera_{}", i + 1)] = cameras[i];
}

void add_bottleneck(Knowledge& k, bool bottleneck, const std::string& reason) {
  k.facts["bottleneck"] = bottleneck;
  if (!bottleneck) k.facts["reason"] = reason;
}

// Layers of channels given by full name: "albedo" for albedo.R; those of the picture itself have
// none.
std::vector<std::string> layers_of(const std::vector<std::string>& channels) {
  std::set<std::string> layers;
  for (const std::string& channel : channels)
    if (const size_t dot = channel.rfind('.'); dot != std::string::npos)
      layers.insert(channel.substr(0, dot));
  return {layers.begin(), layers.end()};
}

// Of the box around all triangles [m]: six digits, the precision of floats.
double longest_side(const Scene& scene) {
  Extent box;
  for (const Triangle& t : scene.triangles)
    for (const uint32_t v : t.vertex) box.add(Vec3d(scene.positions[v]));
  return std::stod(fmt::format("{:.6g}", max_component(box.size()) / scene.frame.scale));
}

// ---- One function for each kind ----

void add_scene(const Scene& scene, Knowledge& k) {
  k.kind = "scene";
  k.hash = scene.hash;
  size_t emitting = 0;
  for (const Triangle& t : scene.triangles)
    emitting += max_component(scene.materials[t.material].emission) > 0;
  std::vector<std::string> cameras;
  for (const Camera& camera : scene.cameras) cameras.push_back(camera.name);
  k.facts["triangles"] = scene.triangles.size();
  k.facts["materials"] = scene.materials.size();
  k.facts["images"] = scene.images.size();
  k.facts["cameras"] = cameras;
  Json animations = Json::array();
  for (const AnimationFacts& a : scene.animations)
    animations.push_back({{"name", a.name}, {"seconds", a.seconds}});
  k.facts["animations"] = animations;
  k.facts["emitting_triangles"] = emitting;
  k.facts["lamps"] = scene.lights.size();
  k.facts["longest_side_m"] = longest_side(scene);
  k.facts["files_beside_it"] = scene.files.size();
  std::vector<std::string> warnings = scene.warnings;
  if (const std::string missing = scene.missing_camera(); !missing.empty())
    warnings.push_back(missing);
  k.facts["warnings"] = warnings;
}

// To the millimetre.
Json place(const Vec3d& v) {
  const auto rounded = [](double x) { return std::round(1000 * x) / 1000 + 0.0; };
  return {rounded(v.x), rounded(v.y), rounded(v.z)};
}

// Its middle, and the direction in which light passes it.
Json portal_facts(const Portal& portal) {
  const auto& t = portal.triangles.front();
  const Vec3d &a = portal.vertices[t[0]], &b = portal.vertices[t[1]], &c = portal.vertices[t[2]];
  Vec3d middle{};
  for (const Vec3d& v : portal.vertices) middle += v / static_cast<double>(portal.vertices.size());
  Json facts{{"name", portal.name},
             {"area_m2", area_of(portal)},
             {"middle_m", place(middle)},
             {"light_to", place(normalize(cross(b - a, c - a)))},
             {"triangles", portal.triangles.size()}};
  if (!portal.figures.empty()) facts["figures"] = portal.figures;
  if (!portal.cameras.empty()) facts["cameras"] = portal.cameras;
  return facts;
}

void add_portals(const PortalFile& file, Knowledge& k) {
  describe(file, file.made_for, "portals", k);
  Json portals = Json::array();
  for (const Portal& portal : file.portals) portals.push_back(portal_facts(portal));
  k.facts["portals"] = portals;
}

// Portals made by a program are marked; drawn ones are triangles without a lamp or a camera.
void add_gltf(const std::string& path, const std::string& bytes, Knowledge& k) {
  if (bytes.find("portal.0") != std::string::npos ||
      bytes.find(kPortalVersionKey) != std::string::npos)
    return add_portals(read_portals(path), k);
  try {
    add_scene(read_gltf(path), k);
  } catch (const InputError& of_scene) {
    PortalFile file;
    try {
      file = read_portals(path);
    } catch (const InputError&) {
      throw of_scene;
    }
    if (file.cameras > 0 || file.lamps > 0) throw;
    add_portals(file, k);
  }
}

void add_network(const DimacsFile& file, Knowledge& k) {
  describe(file, file.cameras, "flow network", k);
  k.facts["nodes"] = file.network.nodes;
  k.facts["arcs"] = file.network.arcs.size();
  k.facts["patches"] = file.patches.size();
}

void add_cut(const CutFile& file, Knowledge& k) {
  describe(file, file.cameras, "cut", k);
  add_bottleneck(k, file.bottleneck, file.reason);
  Json cuts = Json::array();
  for (const Bottleneck& cut : file.cuts)
    cuts.push_back({{"flow", cut.flow}, {"conductance", cut.conductance}});
  k.facts["cuts"] = cuts;
  k.facts["pivot_pairs"] = file.arcs.size();
}

void add_grid(const LightGrid& grid, const char* kind, Knowledge& k) {
  describe(grid, grid.cameras, kind, k);
  add_bottleneck(k, grid.bottleneck, grid.reason);
  k.facts["voxels"] = grid.dim;
  k.facts["voxel_m"] = grid.voxel;
  k.facts["lines"] = grid.lines.size();
  k.facts["cuts"] = grid.cuts.size();
  k.facts["kept_share"] = grid.flux_share;
}

void add_film(const FilmFile& file, Knowledge& k) {
  k.kind = "film";
  k.facts["width"] = file.film.width();
  k.facts["height"] = file.film.height();
  k.facts["samples"] = words_of(file.film.ranges());
  k.facts["missing"] = words_of(file.gaps());
  k.facts["spp_of_the_picture"] = file.facts.spp;
  std::vector<std::string> channels;
  for (const std::string& layer : file.film.options().layers)
    if (!layer.empty()) channels.push_back(layer + ".R");
  for (const auto& [name, values] : file.channels) channels.push_back(name);
  k.facts["layers"] = layers_of(channels);
  k.facts["derived"] = file.facts.derived;
  k.facts["goes_on"] = !file.facts.state.empty();
  k.facts["processor"] = file.facts.processor;
  for (const auto& [name, value] : file.facts.shape) {
    if (name == "scene") k.scene = value;
    k.facts[name] = value;
  }
}

void add_picture(const std::string& bytes, const std::string& name, Knowledge& k) {
  const ExrFile exr = parse_exr(bytes, name);
  k.provenance = provenance_of(exr);
  if (is_film(exr)) return add_film(parse_film(bytes, name), k);
  k.kind = "picture";
  k.facts["width"] = exr.picture.width;
  k.facts["height"] = exr.picture.height;
  const std::vector<std::string> channels = exr_channels(bytes, name);
  std::vector<std::string> own;
  std::copy_if(channels.begin(), channels.end(), std::back_inserter(own),
               [](const std::string& c) { return c.find('.') == std::string::npos; });
  k.facts["channels"] = own;
  k.facts["layers"] = layers_of(channels);
  for (const auto& [key, value] : exr.attributes)
    if (key != provenance_attribute) k.facts[key] = value;
}

void add_environment(const std::string& bytes, const std::string& name, Knowledge& k) {
  k.kind = "environment";
  const Sky::Map map = parse_environment(bytes, name);
  k.facts["width"] = map.width;
  k.facts["height"] = map.height;
}

bool is_json(const std::string& bytes) {
  const size_t first = bytes.find_first_not_of(" \t\r\n");
  return first != std::string::npos && bytes[first] == '{';
}

// Some readers open a file themselves: standard input is copied to a temporary one.
Knowledge knowledge_of_input() {
  const std::string path = keep_elsewhere("standard-input", read_file("-"));
  if (path.empty()) throw InputError("(standard input)", "", "cannot be kept while it is read");
  const std::unique_ptr<const char, int (*)(const char*)> removed(path.c_str(), std::remove);
  try {
    Knowledge k = knowledge_of(path);
    k.path = "-";
    return k;
  } catch (const InputError& e) {
    throw InputError(replaced(e.what(), path, display_name("-")));
  }
}

}  // namespace

Knowledge knowledge_of(const std::string& path) {
  if (path == "-") return knowledge_of_input();
  const std::string bytes = read_file(path), name = display_name(path);
  Knowledge k;
  k.path = path;
  k.hash = content_hash(bytes);
  const auto begins = [&](std::string_view magic) {
    return bytes.compare(0, magic.size(), magic) == 0;
  };
  if (begins("\x76\x2f\x31\x01")) {
    add_picture(bytes, name, k);
  } else if (begins("glTF") || is_json(bytes)) {
    add_gltf(path, bytes, k);
  } else if (begins(" BDV")) {
    add_grid(read_light_grid(bytes, name), "light grid", k);
  } else if (begins("cut,") || begins("i,j,k")) {
    add_grid(parse_light_tables({{name, bytes}}), "table of a light grid", k);
  } else if (begins("#?")) {
    add_environment(bytes, name, k);
  } else if (begins("c tdpt cut")) {
    add_cut(read_cut(path), k);
  } else if (begins("c") || begins("p ")) {
    add_network(read_dimacs(path), k);
  } else {
    throw InputError(name, "", "is none of the files of these programs");
  }
  return k;
}

namespace {

// The figures of a portal by which people judge it.
constexpr std::array kJudged{"conductance", "flux_share", "sky", "support", "tightness"};

// "area_m2 1.8, middle_m 1 1 0, figures flux_share 0.71, sky 0": a record without its name.
std::string words_of(const Json& value, bool judged_alone = false) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return number_words(value.get<double>());
  if (!value.is_structured()) return value.dump();
  std::string text;
  for (const auto& [key, part] : value.items()) {
    if (key == "name" || (judged_alone && std::ranges::count(kJudged, key) == 0)) continue;
    if (!text.empty()) text += value.is_object() ? ", " : " ";
    if (value.is_object()) text += key + " ";
    text += words_of(part, key == "figures");
  }
  return text;
}

// A fact; one that is a list of records or warnings has a line for each of them.
std::string fact_text(const std::string& name, const Json& value) {
  if (value.is_array() && !value.empty() && value[0].is_object()) {
    std::string text;
    for (const Json& record : value)
      text += fmt::format("  {}: {}\n", shown(record.value("name", name), 60),
                          shown(words_of(record), 400));
    return text;
  }
  if (name == "warnings" && !value.empty()) {
    std::string text;
    for (const std::string warning : value)
      text += fmt::format("  warning: {}\n", shown(warning, 400));
    return text;
  }
  std::string words = value.is_string()
                          ? value.get<std::string>()
                          : value.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (words.empty() || words == "[]") words = "none";
  if (const auto camera = name.starts_with("camera") ? parse_viewpoint(words) : std::nullopt)
    words = tdpt::words_of(*camera);
  return fmt::format("  {}: {}\n", shown(name, 40), shown(words, 400));
}

}  // namespace

std::string text_of(const Knowledge& k) {
  std::string text = fmt::format("{}: {}\n  hash: {}\n", display_name(k.path), k.kind, k.hash);
  if (!k.scene.empty()) text += fmt::format("  of scene: {}\n", shown(k.scene));
  for (const auto& [name, value] : k.facts.items()) text += fact_text(name, value);
  for (const std::string& line : k.provenance.lines)
    text += fmt::format("  {}\n", shown(line, 400));
  return text;
}

std::string json_of(const Knowledge& k) {
  Json json{{"file", k.path}, {"kind", k.kind}, {"intact", true}, {"hash", k.hash}};
  json["scene"] = k.scene.empty() ? Json() : Json(k.scene);
  json["facts"] = k.facts;
  json["provenance"] = k.provenance.lines;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace tdpt
