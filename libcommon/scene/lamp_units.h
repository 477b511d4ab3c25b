// What the numbers of a file's lamps stand for. glTF has candela and lux, and nits for surfaces;
// programs write what they have, and Blender candela beside surfaces in W/m2/sr.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tdpt {

struct PunctualLight;
struct Scene;

struct LampUnits {
  enum class Kind : uint8_t {
    radiometric,  ///< W/sr and W/m2, or whatever the emitting surfaces are in, too
    photometric,  ///< lm/sr and lm/m2, beside surfaces in W/m2/sr
    watts,        ///< points and spots: power in all directions, had they no cone [W]
  };
  Kind kind = Kind::radiometric;
  /// What the lamps are and who says so, to be told; empty where there is nothing to tell.
  std::string reason{};

  static constexpr double kLumensPerWatt = 683;
};

/// "radiometric", "photometric", "watts", in the order of LampUnits::Kind.
const std::vector<std::string>& names_of_lamp_units();

/// An intensity as a file has it.
struct LampNumber {
  double value;
  bool directional;
};

/// By who wrote the file (asset.generator), his version and, as files do not tell his mode, the
/// digits of the numbers: people set lamps to 60 W, not to 59.87.
LampUnits lamp_units_of(std::string_view generator, const std::vector<LampNumber>& lamps);

/// Whether asset.generator is Blender's exporter.
bool is_blender(std::string_view generator);

/// What a number of these units is multiplied by to be W/sr or W/m2.
double to_radiometric(LampUnits::Kind units, bool directional);
/// Of this lamp. A profile is in candela: never in watts.
double to_radiometric(LampUnits::Kind units, const PunctualLight& lamp);

/// Takes the scene's lamps, which are as the file has them, as these. Once.
void take_lamps_as(Scene& scene, LampUnits::Kind units);

}  // namespace tdpt
