#include "libcommon/scene/gltf/defaults.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/scene/gltf/checker.h"
#include "libcommon/scene/gltf/document.h"

namespace tdpt {

namespace {

using gltf::Json;

constexpr std::array kKeys{"tdpt_environment",
                           "tdpt_environment_rotation",
                           "tdpt_environment_scale",
                           "tdpt_width",
                           "tdpt_height",
                           "tdpt_camera"};

/// Extras of the default scene; `place` becomes their place in the file. Null: none.
const Json* extras_of(const Json& gltf, std::string& place) {
  if (!gltf.is_object()) return nullptr;
  const auto scenes = gltf.find("scenes");
  if (scenes == gltf.end() || !scenes->is_array()) return nullptr;
  const auto shown = gltf.find("scene");
  const double index = shown != gltf.end() && shown->is_number() ? shown->get<double>() : 0;
  if (!(index >= 0 && index < static_cast<double>(scenes->size()))) return nullptr;
  const Json& scene = (*scenes)[static_cast<size_t>(index)];
  if (!scene.is_object()) return nullptr;
  const auto extras = scene.find("extras");
  if (extras == scene.end() || !extras->is_object()) return nullptr;
  place = gltf::place("scenes", static_cast<size_t>(index)) + ".extras";
  return &*extras;
}

/// A colour as an array becomes "R,G,B".
std::string environment_of(const gltf::Checker& c, const Json& value, const std::string& at) {
  const char* const kExpected = "a file, or R,G,B: three numbers from 0 to 1e30";
  std::string text;
  if (value.is_array() && value.size() == 3 &&
      std::all_of(value.begin(), value.end(), [](const Json& v) { return v.is_number(); }))
    text = fmt::format("{},{},{}", value[0].get<double>(), value[1].get<double>(),
                       value[2].get<double>());
  else if (value.is_string())
    text = value.get<std::string>();
  else
    c.fail(at, value, kExpected);
  if (text.empty()) c.fail(at, value, kExpected);
  std::string expected;
  if (means_colour(text) && !parse_colour(text, expected)) c.fail(at, text, expected);
  return text;
}

/// A file with exactly this name takes precedence, even if the name looks like a URI.
std::string path_of(const Namer& namer, const std::string& name, const std::string& at) {
  try {
    return local_file(namer, name, at).path;
  } catch (const NothingThere&) {
    const std::string decoded = gltf::percent_decode(name);
    if (decoded == name) throw;
    return local_file(namer, decoded, at).path;
  }
}

void find_environment_file(const std::string& file, SceneDefaults& d) {
  if (!d.has_environment() || means_colour(d.environment)) return;
  try {
    d.environment_file = path_of({display_name(file), folder_of(file)}, d.environment,
                                 d.place_of("tdpt_environment"));
  } catch (const InputError& e) {
    d.environment_fault = std::make_shared<const InputError>(e);
  }
}

void warn_of_meaningless(const Json& extras, SceneDefaults& d) {
  for (const auto& [key, value] : extras.items())
    if (key.starts_with("tdpt_") && std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end())
      d.warnings.push_back(fmt::format("{}.{} means nothing, expected one of {}", d.place,
                                       shown(key, 60), fmt::join(kKeys, ", ")));
  for (const char* key : {"tdpt_environment_rotation", "tdpt_environment_scale"})
    if (d.environment.empty() && extras.contains(key))
      d.warnings.push_back(d.place_of(key) + " means nothing without tdpt_environment");
}

}  // namespace

SceneDefaults defaults_of(const nlohmann::json& gltf, const std::string& file) {
  SceneDefaults d;
  const Json* const found = extras_of(gltf, d.place);
  if (!found) return d;
  Json extras = *found;
  const std::string name = display_name(file);
  gltf::Checker c(extras, name);
  c.check(extras, d.place,
          {gltf::number("tdpt_environment_rotation", false, -360, 360),
           gltf::number("tdpt_environment_scale", false, 1e-9, 1e9),
           gltf::integer("tdpt_width", false, 1, 65536),
           gltf::integer("tdpt_height", false, 1, 65536), gltf::text("tdpt_camera")});
  if (extras.contains("tdpt_environment"))
    d.environment = environment_of(c, extras["tdpt_environment"], d.place_of("tdpt_environment"));
  const auto number = [&](const char* key) -> std::optional<double> {
    if (!extras.contains(key)) return {};
    return extras[key].get<double>();
  };
  d.rotation = number("tdpt_environment_rotation");
  d.scale = number("tdpt_environment_scale");
  d.width = extras.value("tdpt_width", 0);
  d.height = extras.value("tdpt_height", 0);
  d.camera = extras.value("tdpt_camera", std::string());
  find_environment_file(file, d);
  warn_of_meaningless(extras, d);
  return d;
}

namespace {

std::optional<float> number(std::string_view text) {
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

}  // namespace

bool means_colour(const std::string& text) {
  if (text.find('/') != std::string::npos) return false;
  for (const char* suffix : {".exr", ".hdr", ".pic"})
    if (text.ends_with(suffix)) return false;
  return text.find(',') != std::string::npos || number(text);
}

std::optional<Rgb> parse_colour(const std::string& text, std::string& expected) {
  Rgb colour{};
  size_t start = 0;
  for (int c = 0; c < 3; ++c) {
    const size_t end = c < 2 ? text.find(',', start) : text.size();
    const auto value = end == std::string::npos
                           ? std::nullopt
                           : number(std::string_view(text).substr(start, end - start));
    if (!value || !(*value >= 0 && *value <= kBrightestSky)) {
      expected = "a file, or R,G,B: three numbers from 0 to 1e30";
      return {};
    }
    colour[c] = *value;
    start = end + 1;
  }
  if (max_component(colour) >= kFaintestSky) return colour;
  expected = "a colour that is not black";
  return {};
}

namespace {

void add(const std::string& name, std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

void add_uris(const nlohmann::json& gltf, std::vector<std::string>& names) {
  using Pointer = nlohmann::json::json_pointer;
  for (const char* list : {"/buffers", "/images", "/extensions/EXT_lights_ies/lights"})
    for (const nlohmann::json& one : gltf.value(Pointer(list), nlohmann::json::array())) {
      if (!one.is_object() || !one.contains("uri") || !one["uri"].is_string()) continue;
      const std::string uri = one["uri"].get<std::string>();
      if (!uri.starts_with("data:")) add(gltf::percent_decode(uri), names);
    }
}

}  // namespace

SceneFiles files_of_scene(const std::string& path) {
  SceneFiles files;
  const std::string bytes = read_file(path);
  try {
    std::vector<std::string> ignored;
    const nlohmann::json json =
        gltf::parse_json(gltf::split_chunks(bytes, path, ignored).json, path);
    add_uris(json, files.beside);
    const SceneDefaults defaults = defaults_of(json, path);
    files.has_environment = defaults.has_environment();
    if (files.has_environment)  // the name as written, or decoded; a colour is no file
      for (const std::string& name :
           {defaults.environment, gltf::percent_decode(defaults.environment)})
        add(name, files.beside);
  } catch (const InputError&) {
  } catch (const nlohmann::json::exception&) {
  }
  return files;
}

}  // namespace tdpt
