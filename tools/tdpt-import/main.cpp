// tdpt-import: scenes of Mitsuba, pbrt and Tungsten as glTF.
#include <fmt/format.h>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/cli.h"
#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/gltf/gltf.h"

namespace tdpt {
namespace {

constexpr cli::Program kProgram{
    "tdpt-import",
    "Converts scenes of Mitsuba, pbrt and Tungsten to glTF.",
    "Scene to write (.glb); its environment and portals become files beside it",
    cli::Result::binary,
    cli::kLibraries,
    cli::kCommit,
    cli::kQuiet};

struct ImportOptions {
  std::string scene;
  std::vector<std::string> parameters;
  bool strict = false, allow_missing = false;
  std::string up = "auto";
  int64_t texture_size = 0;
};

void declare_options(cli::Options& options, ImportOptions& a) {
  options.argument("scene", a.scene,
                   "Scene of Tungsten (.json), Mitsuba 0.4 to 3 (.xml) or pbrt-v3 and -v4 (.pbrt)");
  options.flag("--strict", a.strict, "Write nothing if anything of the scene would be lost");
  options.flag("--allow-missing", a.allow_missing,
               "Go on without pictures and meshes that are missing");
  options.option("-D,--define", a.parameters, "NAME=VALUE",
                 "Set a parameter $NAME of a Mitsuba scene");
  options.choice("--up", a.up, {"auto", "x", "y", "z"},
                 "Axis of the scene that points up; auto goes by the camera");
  options.option("--texture-size", a.texture_size, "PIXELS",
                 "Scale larger textures down until no side is longer; 0 keeps all as they are", 0,
                 16384);
}

using Parameters = std::map<std::string, std::string>;

struct Format {
  const char *name, *suffix, *begins;  // what the text begins with, for files of other suffixes
  foreign::Described (*read)(foreign::Source&, const Parameters&);
};
constexpr Format kFormats[] = {
    {"Tungsten", ".json", "{", [](auto& source, auto&) { return foreign::read_tungsten(source); }},
    {"Mitsuba", ".xml", "<", foreign::read_mitsuba},
    {"pbrt", ".pbrt", nullptr, [](auto& source, auto&) { return foreign::read_pbrt(source); }}};

const Format& format_of(const std::string& path, const std::string& text) {
  const std::string suffix = std::filesystem::path(path).extension().string();
  if (suffix == ".gltf" || text.starts_with("glTF"))
    throw InputError(display_name(path), "", "is a glTF scene already: give it to tdpt as it is");
  for (const Format& f : kFormats)
    if (suffix == f.suffix) return f;
  const size_t first = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  for (const Format& f : kFormats)
    if (f.begins ? text.substr(first, 1) == f.begins : text.find("WorldBegin") != text.npos)
      return f;
  throw InputError(display_name(path), "",
                   "is no scene of Tungsten (.json), Mitsuba (.xml) or pbrt (.pbrt)");
}

Parameters parameters_of(const ImportOptions& a, const Format& format) {
  Parameters out;
  for (const std::string& p : a.parameters) {
    const size_t equals = p.find('=');
    if (equals == p.npos || equals == 0)
      throw UsageError("--define: \"" + shown(p) + "\" is not of the form NAME=VALUE");
    out[p.substr(0, equals)] = p.substr(equals + 1);
  }
  if (!out.empty() && format.read != foreign::read_mitsuba)
    throw UsageError("--define: only Mitsuba's scenes have parameters");
  return out;
}

std::string line_of(const foreign::Source::Loss& loss) {
  const std::string where =
      loss.first.file + (loss.first.where.empty() ? "" : ":" + loss.first.where);
  return fmt::format("{}: {}{}", where, loss.sentence,
                     loss.times > 1 ? fmt::format(" ({} times)", loss.times) : "");
}

void report(const cli::Common& common, const foreign::Described& scene,
            const foreign::GltfOutput& w, const std::string& environment,
            const std::string& portals) {
  std::string light = counted(w.emitters, "emitting triangle");
  if (!scene.lamps.empty()) light += ", " + counted(scene.lamps.size(), "lamp");
  if (!environment.empty())
    light += ", the environment in " + environment;
  else if (scene.sky)
    light += ", one colour of sky";
  common.note(fmt::format("{} in {}, {}, {}; light: {}.", counted(w.triangles, "triangle"),
                          counted(w.shapes, "shape"), counted(w.materials, "material"),
                          counted(w.textures, "texture"), light));
  if (!portals.empty())
    common.note(fmt::format("{} in {}: tdpt renders through {}, tdpt-render does with --portal {}.",
                            counted(scene.portals.size(), "portal"), portals,
                            scene.portals.size() > 1 ? "them" : "it", portals));
  if (scene.cameras.empty())
    common.note("The scene has no camera: give one to the renderer (--frame, --look-from).");
  common.explain_by([&] {
    const foreign::Frame& f = w.frame;
    return cli::Decisions{
        {"up", (f.downwards ? "-" : "+") + f.up, "it becomes +y, which is up in glTF", ""},
        {"handedness", f.mirrored ? "left" : "right",
         f.mirrored ? "the camera shows a mirror image, so x changes its sign"
                    : "the camera shows no mirror image",
         ""}};
  });
}

std::string json_of(const foreign::Described& scene, const foreign::GltfOutput& w,
                    const std::vector<foreign::Source::Loss>& losses, const char* format) {
  nlohmann::ordered_json out = {{"format", format},
                                {"triangles", w.triangles},
                                {"shapes", w.shapes},
                                {"materials", w.materials},
                                {"textures", w.textures},
                                {"cameras", scene.cameras.size()},
                                {"emitting_triangles", w.emitters},
                                {"lamps", scene.lamps.size()},
                                {"environment", scene.sky.has_value()},
                                {"portals", scene.portals.size()}};
  out["losses"] = nlohmann::ordered_json::array();
  for (const auto& loss : losses)
    out["losses"].push_back({{"file", loss.first.file},
                             {"place", loss.first.where},
                             {"what", loss.sentence},
                             {"times", loss.times}});
  return out.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

int run(const ImportOptions& a, const cli::Common& common) {
  foreign::Source source(a.scene, a.allow_missing);
  const Format& format = format_of(a.scene, source.text());
  const foreign::Described scene = format.read(source, parameters_of(a, format));
  source.lose_unread();
  if (scene.shapes.empty())
    throw InputError(display_name(a.scene), "", "has no shape that can be read");

  std::vector<std::string> others;
  for (const auto& file : source.files())
    if (file.path != a.scene) others.push_back(file.path);
  common.also_read(others);

  const std::filesystem::path output = common.output;
  const std::string stem = output.stem().string();
  const Provenance provenance = common.provenance({{a.scene, source.files().front().hash, {}}});
  const foreign::GltfOutput w = write_gltf(
      scene,
      {a.up, static_cast<int>(a.texture_size), stem + ".environment", format.name, provenance},
      source);

  if (a.strict && !source.losses().empty()) {
    for (size_t i = 1; i < source.losses().size(); ++i) common.warn(line_of(source.losses()[i]));
    throw InputError(line_of(source.losses().front()) + " (--strict)");
  }
  std::vector<OutputFile> files{{common.output, w.glb}};
  const auto beside = [&](const std::string& file, const std::string& bytes, const char* what) {
    if (bytes.empty()) return std::string();
    if (common.output == "-")
      throw UsageError(std::string(what) + " a file beside the scene, so -o must name a file");
    const std::filesystem::path path = output.parent_path() / file;
    for (const auto& read : source.files())
      if (std::filesystem::path(read.path).lexically_normal() == path.lexically_normal())
        throw UsageError(path.string() + " would be written over a file that the scene uses");
    files.push_back({path.string(), bytes});
    return path.string();
  };
  const std::string environment = beside(stem + ".environment" + w.environment_suffix,
                                         w.environment, "the environment becomes");
  const std::string portals = beside(stem + ".portal.glb", w.portals, "the portals become");
  write_outputs(files);
  for (const auto& loss : source.losses()) common.warn(line_of(loss));
  report(common, scene, w, environment, portals);
  common.summary(json_of(scene, w, source.losses(), format.name));
  return 0;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
