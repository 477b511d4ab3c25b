#include "libcommon/scene/lights.h"

#include <numeric>

#include "libcommon/scene/ies.h"
#include "libcommon/scene/texture.h"
#include "shaders/shared/elementary.h"

namespace tdpt::shader {
namespace {

// The shared source compiled for doubles.
struct Lamps {
  using Real = double;
  using Lamp = tdpt::Lamp;
  const uint32_t* light_words = nullptr;  // of the current profile
  const uint32_t& load_light_word(uint32_t i) const { return light_words[i]; }
#include "shaders/shared/path/lamp.h"
};

}  // namespace
}  // namespace tdpt::shader

namespace tdpt {
namespace {

using std::numbers::pi;
using Kind = PunctualLight::Kind;

constexpr double kLeastShare = 0.01;  // of the mean power

// Mean luminance over a triangle. Textures are sampled on a lattice; an emitter that falls between
// its points keeps some weight, since one that is never chosen would be missing from the picture.
double mean_luminance(const Scene& scene, uint32_t triangle) {
  const Material& m = scene.material_of(triangle);
  const double factor = luminance(m.emission);
  if (!m.maps[MAP_EMISSION] || factor <= 0) return factor;
  constexpr int n = 8;
  double sum = 0;
  int places = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j, ++places)
      sum += luminance(emission_at(scene, {triangle, (i + 1.0 / 3) / n, (j + 1.0 / 3) / n}));
  return 0.9 * sum / places + 0.1 * factor;
}

// Versine of the half angle of the emitted cone.
double cone(const PunctualLight& light) {
  if (light.profile) return 1 - std::cos(light.profile->reach);
  return light.kind == Kind::spot ? 1 - light.cos_outer : 2;
}

const uint32_t* words_of(const LightProfile* profile) {
  return profile ? profile->words.data() : nullptr;
}

}  // namespace

Rgb LightSource::lamp_radiance(const Vec3d& w) const {
  return Rgb(shader::Lamps{words_of(profile())}.lamp_radiance(lamp_, w));
}

double LightSource::lamp_pdf_w(const Vec3d& w) const {
  return shader::Lamps{words_of(profile())}.lamp_pdf_w(lamp_, w);
}

double LightSource::lamp_per_pdf_w(const Vec3d& w) const {
  return shader::Lamps{words_of(profile())}.lamp_per_pdf_w(lamp_, w);
}

LightSource LightSource::punctual(const PunctualLight& light, double extent) {
  LightSource source(false);
  source.is_surface_ = false;
  Lamp& lamp = source.lamp_;
  lamp.position = light.position, lamp.direction = light.direction;
  lamp.intensity = Vec3d(light.intensity);
  lamp.parallel = light.kind == Kind::directional;
  lamp.extent = extent, lamp.pdf_w = 1 / extent;
  lamp.cone = cone(light);
  const bool spot = light.kind == Kind::spot;
  // Rounding must not exclude the direction opposite to the lamp's.
  lamp.edge = spot ? lamp.cone : 4;
  lamp.per_edge = spot ? 1 / std::max(1e-15, light.cos_inner - light.cos_outer) : 1;
  lamp.profile = shader::kNoProfile;
  if (light.profile) {
    source.profile_ = light.profile;
    lamp.profile = 0, lamp.across = light.across;
    // A rounded direction at the edge of the light must have a density.
    lamp.edge = 1.0001 * lamp.cone, lamp.per_edge = 1e6 / lamp.cone;
  }
  return source;
}

LightSource LightSource::all_around(const Sky& sky, double extent) {
  PunctualLight parallel;
  parallel.kind = Kind::directional;
  LightSource source = punctual(parallel, extent);
  source.sky_ = &sky;
  return source;
}

Lights::Lights(const Scene& scene) : scene_(scene) {
  const auto add = [&](double power) {
    powers_.push_back(power);
    power_ += power;
  };
  for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
    const double y = mean_luminance(scene, t);
    if (y <= 0) continue;
    triangles_.push_back(t);
    shapes_.push_back(shape_of(scene, t));
    add((scene.material_of(t).double_sided ? 2 : 1) * pi * y * shapes_.back().area);
  }
  if (!scene.lights.empty() || scene.sky)
    for (const Triangle& t : scene.triangles)
      for (uint32_t v : t.vertex)
        radius_ = std::max(radius_, 1.0001 * length(Vec3d(scene.positions[v])));
  for (const PunctualLight& light : scene.lights) {
    const double y = luminance(light.intensity);
    if (y <= 0) continue;
    const double extent =
        light.kind == Kind::directional ? pi * radius_ * radius_ : 2 * pi * cone(light);
    punctual_.push_back(LightSource::punctual(light, extent));
    add(y * extent * (light.profile ? light.profile->mean : 1));
  }
  if (scene.sky) {
    directions_ = SkyDirections(*scene.sky);
    const double disc = pi * radius_ * radius_;
    if (!directions_.empty() && disc > 0) {
      sky_ = LightSource::all_around(*scene.sky, disc);
      add(directions_.total() * disc);
    }
  }
  if (powers_.empty()) return;
  for (size_t i = 0; i < powers_.size(); ++i) emitted_.of(source_of(i)) += powers_[i];
  // Defensive sampling: a light billions of times fainter than the others would never be chosen,
  // and a room lit by it alone would be black. All raised lights together are chosen once in a
  // hundred times.
  const double least = kLeastShare * power_ / static_cast<double>(powers_.size());
  for (double& w : powers_) w = std::max(w, least);
}

const LightSource& Lights::source_of(size_t entry) const {
  if (entry < triangles_.size()) return surfaces_[0];
  const size_t lamp = entry - triangles_.size();
  return lamp < punctual_.size() ? punctual_[lamp] : *sky_;
}

LightSelection::LightSelection(const Lights& lights,
                               const std::optional<Lights::KindProbabilities>& shares,
                               SkyDirections preferred)
    : lights_(&lights),
      preferred_(std::move(preferred)),
      pdf_A_(lights.scene_.triangles.size(), 0.0f) {
  std::vector<double> weights = lights.powers_;
  if (weights.empty()) return;
  const double all = std::accumulate(weights.begin(), weights.end(), 0.0);
  Lights::KindProbabilities powers;
  for (size_t i = 0; i < weights.size(); ++i) {
    powers.of(lights.source_of(i)) += weights[i];
    shares_.of(lights.source_of(i)) += weights[i] / all;
  }
  if (shares) {
    shares_ = *shares;
    for (size_t i = 0; i < weights.size(); ++i)
      weights[i] *= shares_.of(lights.source_of(i)) / powers.of(lights.source_of(i));
  }
  table_ = CumulativeTable(weights);
  for (uint32_t i = 0; i < lights.triangles_.size(); ++i)
    pdf_A_[lights.triangles_[i]] = static_cast<float>(table_.pdf_1(i) / lights.shapes_[i].area);
  if (lights.sky_) sky_pdf_1_ = pdf_1(weights.size() - 1);
}

Lights::InSky LightSelection::look(const Sky::Place& place) const {
  Lights::InSky in_sky{lights_->scene_.sky->radiance(place), lights_->directions_.pdf_w(place)};
  if (preferred_.empty() || !lights_->scene_.sky->one_colour())
    in_sky.start_w = start_w(place, in_sky.plain_w);
  return in_sky;
}

double LightSelection::start_w(const Sky::Place& place, double plain_w) const {
  return preferred_.empty() ? plain_w
                            : (1 - kPreferred) * plain_w + kPreferred * preferred_.pdf_w(place);
}

Lights::Point LightSelection::sample(Rng& rng) const {
  const double pick = rng.uniform();
  const double u = rng.uniform();
  const double v = rng.uniform();
  const double side = rng.uniform();
  return sample(pick, u, v, side);
}

Lights::Point LightSelection::sample(double pick, double u, double v, double side) const {
  const Lights& all = *lights_;
  const uint32_t i = table_.sample(pick);
  Lights::Point point;
  if (i == all.triangles_.size() + all.punctual_.size()) {
    point.source = all.sky();
    const double share = preferred_.empty() ? 0 : kPreferred;
    const Sky::Place place = side < share
                                 ? preferred_.draw(side / share, u, v)
                                 : all.directions_.draw((side - share) / (1 - share), u, v);
    point.position = -place.towards;
    point.in_sky = look(place);
    point.pdf = pdf(*all.sky_, point.triangle, point.position, point.in_sky);
    return point;
  }
  if (i >= all.triangles_.size()) {
    const LightSource& source = all.source_of(i);
    point.source = &source;
    point.position = source.at_infinity() ? source.lamp().direction : source.lamp().position;
    point.pdf = table_.pdf_1(i);
    return point;
  }
  point.triangle = all.triangles_[i];
  const TriangleShape& s = all.shapes_[i];
  uniform_triangle(u, v, point.b1, point.b2);
  point.position = s.p0 + s.e1 * point.b1 + s.e2 * point.b2;
  const bool both = all.scene_.material_of(point.triangle).double_sided;
  point.source = &all.surface(both);
  const bool back = both && side < 0.5;
  point.normal = back ? -s.normal : s.normal;
  point.pdf = pdf_A_[point.triangle];
  return point;
}

Lights::Ray Lights::leave(const Point& point, double u, double v) const {
  const shader::Lamps text{words_of(point.source->profile())};
  if (point.source->at_infinity())
    return {text.before_the_disc(point.position, radius_, u, v), point.position};
  if (point.source->is_surface())
    return {point.position, normalize(cosine_hemisphere(point.normal, u, v))};
  return {point.position, text.leave_lamp(point.source->lamp_, u, v)};
}

}  // namespace tdpt
