#include "libcommon/scene/gltf/parts.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "libcommon/base/file.h"
#include "libcommon/base/provenance.h"
#include "libcommon/scene/ies.h"

namespace tdpt::gltf {

namespace {

using std::numbers::pi;
constexpr const char *kPunctual = "KHR_lights_punctual", *kIes = "EXT_lights_ies",
                     *kArea = "EXT_lights_area";
// Memory per byte of a profile's text: a quarter is mirrored to a full circle, and a number takes
// two bytes.
constexpr uint64_t kMostPerByte = 40;
constexpr const char* kFlatLight = "lights with a flat transform are left out";
constexpr uint32_t kCorners = kMostOfAreaLight - 1;  // of a disk
// An area light reflects so much. Renderers whose area lights stop none let it pass; a black light
// over a room of albedo 0.7 took 2.5 % of that room's light, one that reflects as the room does 0.1
// %.
constexpr float kAlbedo = 0.8f;

std::string excess(double intensity) {
  return fmt::format("has an intensity of {}, expected at most 1e30", intensity);
}

/// The product of a light's color and `number`.
Vec3d read_intensity(const Value& light, double number) {
  const Vec3d intensity = light["color"].triple(Vec3d(1), 0) * number;
  if (!(max_component(intensity) <= kMostIntensity))
    light.fail_because(excess(max_component(intensity)));
  return intensity;
}

/// The map of a node without its scale, shear and mirroring: unit axes, orthogonal and
/// right-handed, Z that of the node. Empty if the node's map destroys its Z or leaves no plane.
std::optional<Affine> axes_of_light(const Affine& map) {
  const Vec3d z = direction_of(map.z), along_x = direction_of(map.x);
  Vec3d x = direction_of(along_x - z * dot(along_x, z));
  if (x == Vec3d()) x = direction_of(cross(direction_of(map.y), z));
  if (z == Vec3d() || x == Vec3d()) return {};
  return Affine{x, cross(z, x), z, map.t};
}

struct Lamp {
  PunctualLight light;  ///< but for intensity and place
  double number = 0;    ///< its intensity in the file
  Vec3d intensity;      ///< times its color
};

Lamp read_lamp(const Value& v) {
  Lamp out;
  out.number = v["intensity"].number(1, 0);
  out.intensity = read_intensity(v, out.number);
  PunctualLight& light = out.light;
  light.name = v["name"].text();
  light.kind = static_cast<PunctualLight::Kind>(
      v["type"].needed().one_of({"point", "spot", "directional"}, 0));
  if (light.kind != PunctualLight::Kind::spot) return out;
  const Value spot = v["spot"];
  const double inner = spot["innerConeAngle"].number(0),
               outer = spot["outerConeAngle"].number(pi / 4);
  // Files round pi/2 to single precision.
  if (!(inner >= 0 && inner <= outer && outer > 0 && outer <= pi / 2 + 1e-6))
    spot.fail_because(
        fmt::format("has an inner cone of {} and an outer one of {}, expected "
                    "0 <= inner <= outer, 0 < outer <= pi/2",
                    inner, outer));
  light.cos_inner = std::cos(inner);
  light.cos_outer = std::max(std::cos(outer), 0.0);
  return out;
}

struct Profile {
  std::string name, uri;
  size_t view = kNone;  ///< kNone: the uri counts
  std::shared_ptr<const LightProfile> read;
};

Profile read_profile(const Value& v) {
  const Profile out{v["name"].text(), v["uri"].text(), v["bufferView"].index("bufferViews"), {}};
  if (out.view == kNone) v["uri"].needed("a profile needs one or a bufferView");
  return out;
}

struct AreaLamp {
  std::string name;
  Vec3d radiance;
  double size = 1, aspect = 1;
  bool disk = false;
};

AreaLamp read_area_lamp(const Value& v) {
  AreaLamp out;
  out.name = v["name"].text();
  out.disk = v["type"].needed().one_of({"rect", "disk"}, 0) == 1;
  out.radiance = read_intensity(v, v["intensity"].number(1000, 0));
  out.size = v["size"].number_above_0(1);
  out.aspect = v["rect"]["aspect"].number_above_0(1);
  return out;
}

class LightReader {
 public:
  LightReader(const Document& d, Scene& scene, std::vector<Vec3d>& world, Notes& notes)
      : d_(d), scene_(scene), world_(world), notes_(notes) {
    const auto lights = [&](const char* name) {
      return d.root().extension(name)["lights"].items();
    };
    for (const Value& v : lights(kPunctual)) lamps_.push_back(read_lamp(v));
    for (const Value& v : lights(kIes)) profiles_.push_back(read_profile(v));
    for (const Value& v : lights(kArea)) area_lamps_.push_back(read_area_lamp(v));
  }

  void add(const PlacedNode& n) {
    const Node& node = d_.nodes[n.node];
    if (node.lamp != kNone) add_lamp(n, lamps_[node.lamp]);
    if (node.luminaire.light != kNone) add_luminaire(n, node.luminaire);
    if (node.area_light != kNone) add_area_light(n, area_lamps_[node.area_light]);
  }

  LampUnits units() const {
    std::vector<LampNumber> numbers;
    for (const Lamp& l : lamps_)
      if (l.number > 0)
        numbers.push_back({l.number, l.light.kind == PunctualLight::Kind::directional});
    const std::string generator = generator_of(d_);
    // Only luminaires, in candela, and area lights, in nits, beside surfaces in W/m2/sr. The
    // numbers of area lights do not tell the exporter's mode: Blender's writes none.
    if (numbers.empty() && is_blender(generator))
      return {LampUnits::Kind::photometric,
              scene_.area_lights.empty()
                  ? ""
                  : "area lights are taken as nits, divided by 683 lm/W: so their extension "
                    "defines them"};
    return lamp_units_of(generator, numbers);
  }

 private:
  void add_lamp(const PlacedNode& n, const Lamp& lamp) {
    if (max_component(lamp.intensity) <= 0) return;
    PunctualLight out = lamp.light;
    if (out.name.empty()) out.name = d_.nodes[n.node].name;
    out.intensity = Rgb(lamp.intensity);
    out.position = n.to_world.t;
    if (out.kind != PunctualLight::Kind::point) {
      out.direction = direction_of(-n.to_world.z);
      if (out.direction == Vec3d()) return notes_.add(kFlatLight, place("nodes", n.node));
    }
    scene_.lights.push_back(out);
  }

  std::shared_ptr<const LightProfile> profile(size_t index) {
    Profile& p = profiles_[index];
    if (p.read) return p.read;
    const std::string where = fmt::format("extensions.{}.{}", kIes, place("lights", index));
    std::string file, owned;
    if (p.view == kNone) owned = read_uri(d_, p.uri, where + ".uri", file);
    if (!file.empty()) {
      scene_.files.push_back(file);
      scene_.hash = content_hash(scene_.hash + owned);
    }
    const std::string_view text = p.view == kNone ? owned : view_bytes(d_, p.view);
    bytes_of_profiles_ += text.size();
    expect_memory(d_.file, where, fmt::format("{} bytes of profiles", bytes_of_profiles_),
                  kMostPerByte * bytes_of_profiles_);
    p.read = std::make_shared<LightProfile>(
        read_ies(text, file.empty() ? d_.file : file, file.empty() ? where : ""));
    return p.read;
  }

  void add_luminaire(const PlacedNode& n, const Luminaire& luminaire) {
    const size_t index = luminaire.light;
    PunctualLight out;
    out.name = profiles_[index].name.empty() ? d_.nodes[n.node].name : profiles_[index].name;
    out.profile = profile(index);
    const double greatest = luminaire.multiplier * out.profile->peak;
    if (!(greatest <= kMostIntensity)) d_.fail(place("nodes", n.node), excess(greatest));
    const Vec3d intensity = min(luminaire.colour, Vec3d(1)) * greatest;
    if (max_component(intensity) <= 0) return;
    out.intensity = Rgb(intensity);
    out.position = n.to_world.t;
    const std::optional<Affine> axes = axes_of_light(n.to_world);
    if (!axes) return notes_.add(kFlatLight, place("nodes", n.node));
    out.direction = normalize(-axes->z);
    out.across = normalize(axes->x);
    scene_.lights.push_back(out);
  }

  /// Adds black triangles that emit from their front, which faces -Z of the node: a rectangle is
  /// two, a disk a polygon of 64 corners and of the disk's area. Each light has a material of its
  /// own, whose emission is in the units of the file [take_lamps_as()].
  void add_area_light(const PlacedNode& n, const AreaLamp& l) {
    if (max_component(l.radiance) <= 0) return;
    if (max_component(l.radiance) < kFaintestEmission)
      return notes_.add(kFaint, place("nodes", n.node));
    const std::optional<Affine> axes = axes_of_light(n.to_world);
    if (!axes) return notes_.add(kFlatLight, place("nodes", n.node));
    const double size =
        l.size * std::max({length(n.to_world.x), length(n.to_world.y), length(n.to_world.z)});
    scene_.area_lights.push_back({static_cast<uint32_t>(scene_.materials.size()),
                                  size * size * (l.disk ? pi / 4 : l.aspect)});
    Material& m = scene_.materials.emplace_back();
    m.name = l.name.empty() ? d_.nodes[n.node].name : l.name;
    m.base_color = Rgb(kAlbedo);
    m.emission = Rgb(l.radiance);

    // Counter-clockwise as seen from -Z: a rectangle, or a disk around its first corner.
    const auto first = static_cast<uint32_t>(world_.size());
    const auto add_corner = [&](double x, double y) {
      world_.push_back(axes->point({x, y, 0}));
      if (!is_finite(world_.back()))
        d_.fail(place("nodes", n.node),
                "its transform takes an area light beyond double precision");
    };
    const auto add_triangle = [&](uint32_t b, uint32_t c) {
      scene_.triangles.push_back(
          {{first, first + b, first + c}, scene_.area_lights.back().material});
    };
    const double y = 0.5 * size, x = y * l.aspect;
    if (!l.disk) {
      add_corner(-x, -y), add_corner(-x, y), add_corner(x, y), add_corner(x, -y);
      add_triangle(1, 2), add_triangle(2, 3);
      return;
    }
    // A regular polygon of n corners has the area n/2 R^2 sin(2 pi / n), which is pi for the disk
    // of radius 1.
    constexpr double kTurn = 2 * pi / kCorners;
    const double radius = y * std::sqrt(kTurn / std::sin(kTurn));
    add_corner(0, 0);
    for (uint32_t i = 0; i < kCorners; ++i) {
      const double angle = -2 * pi * i / kCorners;
      add_corner(radius * std::cos(angle), radius * std::sin(angle));
      add_triangle(1 + i, 1 + (i + 1) % kCorners);
    }
  }

  const Document& d_;
  Scene& scene_;
  std::vector<Vec3d>& world_;  // vertices [m]
  Notes& notes_;
  std::vector<Lamp> lamps_;
  std::vector<Profile> profiles_;
  std::vector<AreaLamp> area_lamps_;
  uint64_t bytes_of_profiles_ = 0;
};

}  // namespace

void read_lights(const Document& d, const PlacedNodes& nodes, Scene& scene,
                 std::vector<Vec3d>& world, Notes& notes) {
  LightReader lights(d, scene, world, notes);
  for (const PlacedNode& n : nodes.of_scene)
    if (n.visible) lights.add(n);
  if (scene.has_lamps()) scene.lamp_units = lights.units();
}

std::string generator_of(const Document& d) {
  const Json& generator = d.root()["asset"]["generator"].json();
  return generator.is_string() ? generator.get<std::string>() : "";
}

void to_canonical(const Document& d, const Frame& frame, PunctualLight& light) {
  light.position = frame.to_canonical(light.position);
  if (light.kind == PunctualLight::Kind::directional) return;
  const Vec3d canonical = Vec3d(light.intensity) * frame.scale * frame.scale;
  const double most = max_component(canonical);
  if (!(most >= kLeastIntensity && most <= kMostIntensity))
    d.fail(fmt::format("extensions.{}", light.profile ? kIes : kPunctual),
           fmt::format("an intensity of {} W/sr is {} for a scene {} m long",
                       max_component(light.intensity), most > 1 ? "too much" : "too little",
                       2 / frame.scale));
  light.intensity = Rgb(canonical);
}

}  // namespace tdpt::gltf
