// The words that renderers have for surfaces, as glTF's surfaces. What one cannot say is the
// caller's to name as lost.
#pragma once
#include <optional>
#include <string>

#include "tools/tdpt-import/described.h"

namespace tdpt::foreign {

/// A function of a colour or number, per texel if it has a texture; of each component alone.
Colour through(const Colour& c, const std::function<Rgb(const Rgb&)>& f);
Colour through(const Colour& c, const std::function<float(float)>& f);
Number through(const Number& n, const std::function<float(float)>& f);

/// Lambertian of this reflectance.
Material diffuse(const Colour& reflectance);

/// Lambertian base under a dielectric interface of relative index `ior` and GGX `alpha` (0:
/// smooth). `reflectance` is that of the base itself. `nonlinear`: light that the interface throws
/// back onto the base is coloured again, so that of what enters R (1 - F) / (1 - R F) comes out, F
/// the interface's mean reflectance from inside; otherwise R comes out.
Material plastic(const Colour& reflectance, double ior, const Number& alpha, bool nonlinear);

/// The same with a layer below the interface that absorbs: exp(-`depth`) straight through it.
Material plastic_under_layer(const Colour& reflectance, double ior, const Number& alpha,
                             double depth);

/// The same as Mitsuba's "roughplastic", whose interface scatters light once: what would meet it a
/// second time is lost, inside as well, so rough ones have darker bases. `alpha` is its mean.
Material rough_plastic(const Colour& reflectance, double ior, const Number& alpha, bool nonlinear);

/// The shares of diffuse light that a rough dielectric interface reflects and lets through: GGX,
/// separable Smith shadowing, single scattering, relative index `eta` (behind / in front).
struct InterfaceShares {
  double reflected, transmitted;
};
InterfaceShares rough_interface(double eta, double alpha);

/// A dielectric of this base colour, blended with a metal of that colour [Burley 2012], whose base
/// is not darkened by the interface above it. `specular`: share of the interface that is there.
Material burley(const Colour& base, double ior, const Number& roughness, double metallic,
                double specular);

/// What is lost of rough metal (GGX): microfacets shadow each other as by their heights here, but
/// independently in Mitsuba and Tungsten, so that it reflects less there. Empty: next to nothing.
std::string lost_of_rough_metal(const Number& alpha);

/// A conductor of complex index eta + i k (relative to the outside), times `tint`.
Material conductor(const Rgb& eta, const Rgb& k, const Colour& tint, const Number& alpha);
/// A metal of this reflectance at normal incidence.
Material metal(const Colour& reflectance, const Number& alpha);
/// A mirror that reflects `reflectance` at all angles.
Material mirror(const Colour& reflectance);

/// Glass: a solid body's surface, or both sides of a thin sheet.
Material glass(double ior, const Colour& tint, const Number& alpha, bool solid);

/// The complex index of a conductor of these names ("Al", "Cu", "Au", "Ag", ...; those of Mitsuba,
/// Tungsten and pbrt, which all come from the same measured tables), for red, green and blue.
std::optional<std::array<Rgb, 2>> conductor_named(const std::string& name);

/// Index of refraction of a dielectric of Mitsuba's and pbrt's names ("bk7", "water", "glass-BK7").
std::optional<double> ior_named(const std::string& name);

/// Mean reflectance of a smooth interface of relative index `eta` (behind / in front) for diffuse
/// light from the front.
double diffuse_fresnel(double eta);

/// Linear Rec.709 of CIE XYZ.
Rgb rgb_of_xyz(const Rgb& xyz);
/// Linear Rec.709 of a black body's colour of this temperature [K] with luminance 1.
Rgb rgb_of_blackbody(double kelvin);
/// Mean of a spectrum of (wavelength [nm], value) pairs, sorted by wavelength, over the responses
/// of red, green and blue, such that a constant spectrum gives that constant.
Rgb rgb_of_spectrum(const std::vector<std::array<double, 2>>& samples);

}  // namespace tdpt::foreign
