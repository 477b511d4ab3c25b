// Transformations of coordinates, and colours and spectra of parameters as linear Rec.709.
//
// pbrt-v3 (core/paramset.cpp, spectrum.cpp) renders in RGB: a spectrum becomes the linear Rec.709
// of its XYZ, without regard to the white of the lights, so that a constant 1 is no grey. pbrt-v4
// (paramdict.cpp, lights.cpp, util/spectrum.cpp) renders in wavelengths under lights of daylight
// D65, where a constant reflectance is grey.
#include <algorithm>
#include <cmath>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/pbrt/pbrt.h"

namespace tdpt::foreign::pbrt {

size_t Context::image(const std::string& name, const Place& place) {
  const auto [it, is_new] = images.try_emplace(name, scene.images.size());
  if (is_new) scene.images.push_back({name, source.read_picture(name, place)});
  return it->second;
}

Texels Context::texels(size_t image) const {
  return decode(scene.images[image].bytes, source.shown_name(scene.images[image].name));
}

// ---- Transformations ----

void require_finite(const Affine& a, const Place& place) {
  for (const Vec3d& column : {a.x, a.y, a.z, a.t})
    if (!is_finite(column)) Source::fail(place, "the transformation is too large");
}

Affine inverse(const Affine& a, const Place& place) {
  // Columns are scaled to keep the products in range.
  const double sx = length(a.x), sy = length(a.y), sz = length(a.z);
  const Vec3d x = a.x / sx, y = a.y / sy, z = a.z / sz;
  const double det = dot(cross(x, y), z);
  if (!(std::abs(det) > 1e-12)) Source::fail(place, "the transformation flattens space");
  Affine b{cross(y, z) / (det * sx), cross(z, x) / (det * sy), cross(x, y) / (det * sz), {}};
  b = b.transposed();
  b.t = b.vector(a.t) * -1.0;
  require_finite(b, place);
  return b;
}

Vec3f vec_at(const std::vector<double>& numbers, size_t i) {
  return {static_cast<float>(numbers[3 * i]), static_cast<float>(numbers[3 * i + 1]),
          static_cast<float>(numbers[3 * i + 2])};
}

// ---- Colours and spectra ----

namespace {

using Samples = std::vector<std::array<double, 2>>;

Rgb with_luminance_1(const Rgb& c) {
  const float y = luminance(c);
  return y > 0 ? c / y : c;
}

// Colour of a spectrum as it is, not relative to the spectrum of equal energy.
Rgb unadapted(const Samples& samples) {
  return rgb_of_spectrum(samples) * rgb_of_xyz(Rgb(1));
}

Rgb of_samples(const Context& context, const Samples& samples, Role role) {
  if (role == Role::light) {
    const Rgb c = unadapted(samples);
    return context.v4 ? with_luminance_1(c) : c;
  }
  return context.v4 ? rgb_of_spectrum(samples) : unadapted(samples);
}

// Luminance of a black body whose spectrum has its maximum at 1.
float luminance_of_normalised(double kelvin) {
  constexpr double kSecond = 1.438776877e7, kWien = 2.8977721e6;  // nm K
  const auto planck = [&](double nm) {
    return std::pow(nm, -5) / std::expm1(kSecond / (nm * kelvin));
  };
  const double most = planck(kWien / kelvin);
  Samples samples;
  for (int nm = 360; nm <= 830; nm += 5)
    samples.push_back({static_cast<double>(nm), planck(nm) / most});
  return luminance(unadapted(samples));
}

Rgb of_blackbody(const Context& context, const Parameter& p) {
  if (p.numbers.size() != 1 && p.numbers.size() != 2)
    Source::fail(p.place, fmt::format("\"{}\" must be a temperature in kelvin", shown(p.name)));
  const double kelvin = p.numbers[0];
  if (!(kelvin >= 100 && kelvin <= 1e6))
    Source::fail(p.place, fmt::format("{} kelvin are not between 100 and 1000000", kelvin));
  const float scale = p.numbers.size() == 2 ? static_cast<float>(p.numbers[1]) : 1.0f;
  return rgb_of_blackbody(kelvin) * (context.v4 ? scale : scale * luminance_of_normalised(kelvin));
}

Samples sorted_samples(const std::vector<double>& numbers, const Place& place) {
  if (numbers.empty() || numbers.size() % 2)
    Source::fail(place, "a spectrum must be pairs of a wavelength and a value");
  Samples samples;
  for (size_t i = 0; i < numbers.size(); i += 2) samples.push_back({numbers[i], numbers[i + 1]});
  std::stable_sort(samples.begin(), samples.end(),
                   [](const auto& a, const auto& b) { return a[0] < b[0]; });
  return samples;
}

// "metal-Cu-eta", "metal-Cu-k", and as pbrt-v3 says the same, often without the file:
// "spds/Cu.eta.spd".
std::optional<Rgb> of_metal(const std::string& name) {
  const size_t first = name.starts_with("metal-") ? 6 : name.find_last_of("/\\") + 1;
  const size_t end = std::min(name.find_first_of("-.", first), name.size());
  const std::string metal = name.substr(first, end - first), part = name.substr(end);
  std::optional<std::array<Rgb, 2>> both = conductor_named(metal);
  // Brass by refractiveindex.info; the oxides hardly absorb.
  if (metal == "CuZn") both = {{{0.444f, 0.527f, 1.094f}, {3.695f, 2.765f, 1.829f}}};
  if (metal == "MgO") both = {{Rgb(1.735f), Rgb(0)}};
  if (metal == "TiO2") both = {{{2.59f, 2.65f, 2.80f}, Rgb(0)}};
  if (both && (part == "-eta" || part == ".eta.spd")) return (*both)[0];
  if (both && (part == "-k" || part == ".k.spd")) return (*both)[1];
  return {};
}

// A spectrum of pbrt's own, or of a file.
Rgb of_name(const Entity& e, const Parameter& p, const std::string& name, Role role) {
  Source& source = e.context.source;
  if (role == Role::index) {
    if (const auto metal = of_metal(name); metal && !source.has(name, p.place)) return *metal;
    if (const auto ior = ior_named(name)) return Rgb(static_cast<float>(*ior));
  }
  if (name == "stdillum-A") return rgb_of_blackbody(2856);
  if (name.starts_with("stdillum-") || name.starts_with("illum-")) {
    if (name != "stdillum-D65")
      source.lose(p.place, fmt::format("the spectrum \"{}\" becomes white", shown(name)));
    return Rgb(1);
  }
  const std::string bytes = source.read(name, p.place);
  Tokens tokens(bytes, source.shown_name(name));
  std::vector<double> numbers;
  while (tokens.peek().kind != Token::Kind::end) numbers.push_back(tokens.number_of(tokens.next()));
  return of_samples(e.context, sorted_samples(numbers, p.place), role);
}

Rgb of_three(const Parameter& p) {
  if (p.numbers.size() != 3)
    Source::fail(p.place, fmt::format("\"{}\" must be three numbers", shown(p.name)));
  return vec_at(p.numbers, 0);
}

}  // namespace

std::optional<Rgb> Entity::spectrum(const std::string& name, Role role) const {
  const Parameter* p = find(name, {"rgb", "color", "xyz", "blackbody", "spectrum"});
  if (!p) return {};
  const Rgb colour = p->type == "xyz"         ? rgb_of_xyz(of_three(*p))
                     : p->type == "blackbody" ? of_blackbody(context, *p)
                     : p->type != "spectrum"  ? of_three(*p)
                     : p->strings.size() == 1
                         ? of_name(*this, *p, p->strings[0], role)
                         : of_samples(context, sorted_samples(p->numbers, p->place), role);
  if (!is_finite(colour))
    Source::fail(p->place, fmt::format("the values of \"{}\" are too large", shown(name)));
  return max(colour, Rgb(0));
}

double Entity::index(const std::string& name, double absent) const {
  if (const double* v = numbers(name, {"float"}, 1)) return *v;
  const auto value = spectrum(name, Role::index);
  return value ? value->y : absent;
}

}  // namespace tdpt::foreign::pbrt
