// The units of a scene: of its lamps, and of its lengths.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tdpt {

// Units of a file's lamps. glTF prescribes candela and lux, and nits for surfaces; exporters write
// what they have, Blender for one candela beside surfaces in W/m2/sr.

struct AreaLight;
struct PunctualLight;
struct Scene;

struct LampUnits {
  enum class Kind : uint8_t {
    radiometric,  ///< W/sr, W/m2 and W/m2/sr, or whatever units the emitting surfaces use
    photometric,  ///< lm/sr, lm/m2 and lm/m2/sr, beside surfaces in W/m2/sr
    watts,        ///< all but parallel light: total power, for a spot without its cone [W]
  };
  Kind kind = Kind::radiometric;
  /// A sentence: the units and the evidence for them; empty if there is nothing to report.
  std::string reason{};

  static constexpr double kLumensPerWatt = 683;
};

/// "radiometric", "photometric", "watts", in the order of LampUnits::Kind.
const std::vector<std::string>& names_of_lamp_units();

/// An intensity as stored in the file.
struct LampNumber {
  double value;
  bool directional;
};

/// Infers the units from the exporter (asset.generator) and, since files do not record the
/// exporter's mode, the digits of the numbers: people set lamps to 60 W, not to 59.87.
LampUnits lamp_units_of(std::string_view generator, const std::vector<LampNumber>& lamps);

/// Whether asset.generator is Blender's exporter.
bool is_blender(std::string_view generator);

/// Factor from these units to W/sr or W/m2.
double to_radiometric(LampUnits::Kind units, bool directional);
/// For this lamp. A profile is in candela, never in watts.
double to_radiometric(LampUnits::Kind units, const PunctualLight& lamp);

/// For this area light, to W/m2/sr.
double to_radiometric(LampUnits::Kind units, const AreaLight& light);

/// Converts the scene's lamps, as read from the file, from these units. Call once. Throws
/// InputError if the radiance of an area light is beyond single precision.
void take_lamps_as(Scene& scene, LampUnits::Kind units);

// Guesses the unit of a scene from its rooms. glTF is in metres; in a scene of centimetres the
// light of a lamp falls with a distance that is a hundred times too long.
//
// Method: height of a room = from the first surface below a point to the first above it, where the
// point is a camera or a lamp. The median of these heights, in metres, tells the unit: no storey is
// 50 m high, and in each other unit most are near 2.7 m. Without a ceiling, and so for landscapes,
// nothing is told.

struct SceneUnit {
  const char* name;  ///< "centimetres"
  double metres;     ///< one of it
  double height;     ///< of a room, taken as metres
};

/// Nothing for a scene that seems to be in metres, or that does not tell.
std::optional<SceneUnit> unit_of(const Scene& scene);

}  // namespace tdpt
