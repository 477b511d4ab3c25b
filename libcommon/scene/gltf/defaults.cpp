#include "libcommon/scene/gltf/defaults.h"

#include <algorithm>
#include <charconv>
#include <string_view>

#include <fmt/format.h>

#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/scene/gltf/document.h"

namespace tdpt {

namespace {

using gltf::Json;
using gltf::Value;

std::optional<float> number(std::string_view text) {
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

/// Extras of the default scene; absent if it has none.
std::optional<Value> extras_of(const std::string& file, const Json& gltf) {
  const Value root(file, gltf);
  const std::vector<Value> scenes = root["scenes"].items();
  if (scenes.empty()) return {};
  const size_t shown = root["scene"].index("scenes");
  const Value extras = scenes[shown == tdpt::gltf::kNone ? 0 : shown]["extras"];
  return extras.json().is_object() ? std::optional(extras) : std::nullopt;
}

/// A colour as an array becomes "R,G,B".
std::string read_environment(const Value& v) {
  const Json& j = v.json();
  std::string text, expected = "a file, or R,G,B: three numbers from 0 to 1e30";
  if (!v) return text;
  if (j.is_array() && j.size() == 3 &&
      std::all_of(j.begin(), j.end(), [](const Json& c) { return c.is_number(); }))
    text = fmt::format("{},{},{}", j[0].get<double>(), j[1].get<double>(), j[2].get<double>());
  else if (j.is_string())
    text = j.get<std::string>();
  if (text.empty()) v.fail(expected);
  if (means_colour(text) && !parse_colour(text, expected))
    v.fail_because(fmt::format("is \"{}\", expected {}", shown(text), expected));
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

SceneDefaults defaults_of(const nlohmann::json& gltf, const std::string& file) {
  SceneDefaults d;
  const std::string name = display_name(file);
  const std::optional<Value> extras = extras_of(name, gltf);
  if (!extras) return d;
  d.place = extras->place();
  const auto number = [&](const char* key, double low, double high) -> std::optional<double> {
    const Value v = (*extras)[key];
    return v ? std::optional(v.number(0, low, high)) : std::nullopt;
  };
  const auto pixels = [&](const char* key) {
    return static_cast<int>((*extras)[key].integer(0, 1, 65536));
  };
  d.rotation = number("tdpt_environment_rotation", -360, 360);
  d.scale = number("tdpt_environment_scale", 1e-9, 1e9);
  d.width = pixels("tdpt_width");
  d.height = pixels("tdpt_height");
  d.camera = (*extras)["tdpt_camera"].text();
  d.environment = read_environment((*extras)["tdpt_environment"]);
  find_environment_file(file, d);
  return d;
}

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

SceneFiles files_of_scene(const std::string& path) {
  SceneFiles files;
  const std::string bytes = read_file(path);
  try {
    const nlohmann::json json = gltf::parse_json(gltf::split_chunks(bytes, path).json, path);
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
