#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/mitsuba/mitsuba.h"

namespace tdpt::foreign::mitsuba {
namespace {

bool all_are(const Rgb& c, float value) {
  return is_grey(c) && c.x == value;
}

// A bsdf as a material; `turned` says that the material is that of the back.
struct Bsdf {
  Material material;
  bool turned = false, two_sided = false, opaque = true;
};
Bsdf read_bsdf(Context& in, const Element& bsdf);

void lose_kind(const Element& bsdf, const char* what) {
  bsdf.lose(fmt::format("surfaces of type \"{}\" become {}", shown(bsdf.type, 40), what));
}

// An index of refraction: a number or the name of a medium.
double ior(const Element& bsdf, const char* name, const char* otherwise) {
  const Element* v = bsdf.find(name);
  const bool is_number = v && v->tag != "string";
  const std::string material = is_number ? "" : lower_case(bsdf.text(name, otherwise));
  const auto n = is_number ? bsdf.number(name, 1) : ior_named(material);
  if (!n)
    v->fail(fmt::format("no material \"{}\" has a known index of refraction", shown(material, 40)));
  if (!(*n > 0.1 && *n < 100)) v->fail(fmt::format("an index of refraction of {}", *n));
  return *n;
}

double relative_ior(const Element& bsdf, const char* inside) {
  if (bsdf.find("eta") && !bsdf.find("int_ior")) return ior(bsdf, "eta", "air");
  return ior(bsdf, "int_ior", inside) / ior(bsdf, "ext_ior", "air");
}

void lose_reflectance(Context& in, const Element& bsdf) {
  if (!all_are(plain_colour(in, bsdf, "specular_reflectance", Rgb(1)), 1))
    bsdf.lose("the specular_reflectance of glass and coats is left out");
}

// The roughness alpha; 0 for the types of smooth surfaces.
Number alpha(Context& in, const Element& bsdf) {
  if (!bsdf.type.starts_with("rough")) return {0.0f};
  const std::string distribution = bsdf.text("distribution", "beckmann");
  if (distribution != "ggx")
    bsdf.lose(fmt::format("microfacets of type \"{}\" become GGX", shown(distribution, 40)));
  if (!bsdf.find("alpha_u") && !bsdf.find("alpha_v")) return number(in, bsdf, "alpha", 0.1);
  const double u = plain_number(in, bsdf, "alpha_u", 0.1),
               v = plain_number(in, bsdf, "alpha_v", 0.1);
  if (u != v) bsdf.lose("anisotropic roughness becomes isotropic");
  return {single(std::sqrt(std::max(0.0, u * v)))};
}

Bsdf read_nested(Context& in, const Element& bsdf) {
  const auto all = bsdf.nested("bsdf");
  if (all.empty()) bsdf.fail(fmt::format("the {} has no bsdf in it", bsdf.described()));
  return read_bsdf(in, *all[0]);
}

// ---- One function per family of types

Bsdf read_twosided(Context& in, const Element& bsdf) {
  Bsdf out = read_nested(in, bsdf);
  if (bsdf.nested("bsdf").size() > 1)
    bsdf.lose("of the two bsdfs of a twosided surface the first is taken");
  bsdf.ignore("allow_transmission");  // lets a nested bsdf transmit
  out.two_sided = true;
  return out;
}

// Lambertian surfaces, which also replace types that are not read.
Bsdf read_diffuse(Context& in, const Element& bsdf) {
  if (!is_one_of(bsdf.type, "diffuse lambertian")) {
    lose_kind(bsdf, "Lambertian");
    bsdf.ignore_all();
  }
  const char* name = bsdf.find("reflectance") ? "reflectance" : "diffuse_reflectance";
  return {diffuse(colour(in, bsdf, name, Rgb(0.5f)))};
}

Bsdf read_plastic(Context& in, const Element& bsdf) {
  const Number rough = alpha(in, bsdf);
  const Colour base = colour(in, bsdf, "diffuse_reflectance", Rgb(0.5f));
  const double n = relative_ior(bsdf, "polypropylene");
  const bool nonlinear = bsdf.flag("nonlinear", false);
  Bsdf out{bsdf.type == "plastic" ? plastic(base, n, rough, nonlinear)
                                  : rough_plastic(base, n, rough, nonlinear)};
  if (bsdf.type == "roughplastic")
    bsdf.lose("rough plastics reflect up to 4 % more or less than in Mitsuba");
  const Rgb tint = plain_colour(in, bsdf, "specular_reflectance", Rgb(1));
  if (!all_are(tint, 1)) {
    bsdf.lose(
        "where the specular_reflectance of a plastic is not 1, its base is off by what its "
        "interface keeps back");
    const float most = std::clamp(max_component(tint), 0.0f, 1.0f);
    out.material.specular *= most;
    if (most > 0) out.material.specular_colour = tint / most;
  }
  return out;
}

Bsdf read_conductor(Context& in, const Element& bsdf) {
  const Number rough = alpha(in, bsdf);
  if (const std::string lost = lost_of_rough_metal(rough); !lost.empty()) bsdf.lose(lost);
  const Colour tint = colour(in, bsdf, "specular_reflectance", Rgb(1));
  const std::string name = bsdf.text("material", bsdf.old ? "Cu" : "none");
  const bool is_given = bsdf.find("eta") || bsdf.find("k");
  const double outside = bsdf.old ? ior(bsdf, "ext_eta", "air") : 1;  // Mitsuba 3 has no ext_eta
  if (name == "none" && !is_given) return {metal(tint, rough)};
  std::array<Rgb, 2> eta_k{Rgb(0), Rgb(1)};
  if (name != "none" && (bsdf.old || !is_given)) {
    const auto known = conductor_named(name);
    if (!known && !is_given)
      bsdf.lose(
          fmt::format("the metal \"{}\" is not known: aluminium in its place", shown(name, 40)));
    if (known || !is_given) eta_k = known ? *known : *conductor_named("Al");
  }
  if (is_given)
    eta_k = {plain_colour(in, bsdf, "eta", eta_k[0]), plain_colour(in, bsdf, "k", eta_k[1])};
  for (Rgb& c : eta_k) c = max(c / single(outside), Rgb(0));
  return {conductor(eta_k[0], eta_k[1], tint, rough)};
}

Bsdf read_dielectric(Context& in, const Element& bsdf) {
  const bool solid = bsdf.type != "thindielectric";
  const Number rough = alpha(in, bsdf);
  double n = relative_ior(bsdf, "bk7");
  Bsdf out;
  // A body of the lower index is a body of the medium around it, seen from the back.
  out.turned = solid && n < 1;
  if (n < 1) n = 1 / n;
  out.material = glass(n, colour(in, bsdf, "specular_transmittance", Rgb(1)), rough, solid);
  out.opaque = false;
  lose_reflectance(in, bsdf);
  return out;
}

Bsdf read_mask(Context& in, const Element& bsdf) {
  Bsdf out = read_nested(in, bsdf);
  Number opacity = number(in, bsdf, "opacity", 0.5);
  opacity.factor *= out.material.opacity.factor;
  if (out.material.opacity.texture) {
    bsdf.lose("of a mask in a mask the outer texture is taken");
    if (!opacity.texture) opacity.texture = out.material.opacity.texture;
  }
  out.material.opacity = opacity;
  return out;
}

Bsdf read_normal_map(Context& in, const Element& bsdf) {
  Bsdf out = read_nested(in, bsdf);
  const auto maps = bsdf.nested("texture");
  if (maps.empty()) bsdf.fail(fmt::format("the {} has no texture in it", bsdf.described()));
  bsdf.ignore("flip_invalid_normals use_shadowing_function");  // of normals seen from behind
  const Colour c = texture(in, *maps[0], Role::surface);
  if (!c.texture) return out;
  const Image& image = in.scene.images[c.texture->image];
  if (image.bytes.empty() || bsdf.source->has(image.name, bsdf.place))  // a stand-in is no normal
    out.material.normal = c.texture;
  return out;
}

Bsdf read_bump(Context& in, const Element& bsdf) {
  bsdf.lose("bump maps are left out");
  bsdf.ignore_all();
  return read_nested(in, bsdf);
}

// A mixture becomes its heaviest part.
Bsdf read_mixture(Context& in, const Element& bsdf) {
  const auto all = bsdf.nested("bsdf");
  std::vector<double> weights;
  if (bsdf.type == "blendbsdf") {
    const Number second = number(in, bsdf, "weight", 0.5);
    const double w = second.texture ? 0.5 : second.factor;
    weights = {1 - w, w};
  } else {
    for (const std::string& word : split(bsdf.needed_text("weights"), " ,;\t\r\n"))
      weights.push_back(bsdf.find("weights")->finite(word));
  }
  if (weights.size() != all.size() || all.empty())
    bsdf.fail(
        fmt::format("the {} has {} bsdfs and {} weights", bsdf.type, all.size(), weights.size()));
  lose_kind(bsdf, "the heaviest of those mixed");
  return read_bsdf(in, *all[static_cast<size_t>(std::max_element(weights.begin(), weights.end()) -
                                                weights.begin())]);
}

// Mitsuba's coats drop the light that they reflect back inside, so they darken diffuse surfaces
// [coating.cpp]. A coat over a Lambertian surface becomes plastic without that light, others become
// glTF's clear coat.
Bsdf read_coating(Context& in, const Element& bsdf) {
  Bsdf out = read_nested(in, bsdf);
  Material& m = out.material;
  const double n = relative_ior(bsdf, "bk7"), inside = n < 1 ? n : 1 / n;
  const bool smooth = bsdf.type == "coating";
  const Number rough = alpha(in, bsdf);
  const bool lambertian = m.specular == 0 && m.transmission == 0 && m.coat == 0 && !m.invisible;
  if (lambertian) {
    const double a = std::clamp(static_cast<double>(rough.factor), 1e-3, 1.0);
    const double kept = smooth ? diffuse_fresnel(inside) : rough_interface(inside, a).reflected;
    Colour base = m.base;
    base.factor = base.factor * single(1 - kept);
    const Material plain =
        smooth ? plastic(base, n, rough, false) : rough_plastic(base, n, rough, false);
    m.base = plain.base, m.roughness = plain.roughness;
    m.specular = plain.specular, m.ior = plain.ior;
  } else {
    if (m.metallic < 1 || m.roughness.factor > 0 || m.roughness.texture || rough.texture ||
        std::abs(n - 1.5) > 0.02)
      bsdf.lose(
          "coats become glTF's, which have the index 1.5, darken less and are as rough everywhere");
    m.coat = 1;
    m.coat_roughness = std::sqrt(std::clamp(rough.texture ? 0.1f : rough.factor, 0.0f, 1.0f));
  }
  if (bsdf.number("thickness", 1) != 0 && !all_are(plain_colour(in, bsdf, "sigma_a", Rgb(0)), 0))
    bsdf.lose("the absorption in coats is left out");
  lose_reflectance(in, bsdf);
  return out;
}

Bsdf read_null(Context&, const Element&) {
  Bsdf out{diffuse({Rgb(0)})};
  out.material.invisible = true;
  out.opaque = false;
  return out;
}

// The parts of [Burley 2012, 2015] that glTF has.
Bsdf read_principled(Context& in, const Element& bsdf) {
  const bool thin = bsdf.type == "principledthin";
  const Colour base = colour(in, bsdf, "base_color", Rgb(0.5f));
  const Number roughness = number(in, bsdf, "roughness", 0.5);
  const auto share = [&](const char* name) {
    return std::clamp(plain_number(in, bsdf, name, 0), 0.0, 1.0);
  };
  const double metallic = share("metallic"), transmission = share("spec_trans");
  const double specular = std::clamp(bsdf.number("specular", 0.5), 0.0, 12.0);
  double n = 2 / (1 - std::sqrt(0.08 * specular)) - 1;
  if (bsdf.find("eta")) n = plain_number(in, bsdf, "eta", 1.5);
  if (!(n > 0.1 && n < 100)) bsdf.fail(fmt::format("an index of refraction of {}", n));
  if (n < 1) n = 1 / n;
  Bsdf out;
  Material& m = out.material;
  // Thin sheets have an interface only where they transmit.
  m = burley(base, n, roughness, metallic, thin ? transmission : 1);
  const Number square{roughness.factor * roughness.factor, roughness.texture};
  const bool is_glass = transmission == 1 && metallic == 0;
  if (is_glass)  // a body colours by the root at each side
    m.base = thin ? base : through(base, [](float c) { return std::sqrt(c); });
  if (!(is_glass && !thin) &&
      (transmission > 0 || metallic < 1 || !lost_of_rough_metal(square).empty()))
    bsdf.lose(
        "principled surfaces become glTF's, which reflect as much on the whole, but up to a tenth "
        "more or less by direction");
  m.transmission = single(transmission);
  m.solid = !thin;
  m.coat = single(0.25 * plain_number(in, bsdf, "clearcoat", 0));
  const double gloss = plain_number(in, bsdf, "clearcoat_gloss", 0);
  if (m.coat > 0) {
    bsdf.lose("the highlights of clear coats become GGX");
    m.coat_roughness = single(std::sqrt(0.1 + std::clamp(gloss, 0.0, 1.0) * (0.001 - 0.1)));
  }
  for (const char* name : {"anisotropic", "sheen", "flatness", "spec_tint", "diff_trans"}) {
    const Number v = number(in, bsdf, name, 0);
    if (v.texture || v.factor != 0)
      bsdf.lose(fmt::format("the \"{}\" of principled surfaces is left out", name));
  }
  bsdf.ignore("sheen_tint");
  out.opaque = m.transmission == 0;
  return out;
}

Bsdf read_bsdf(Context& in, const Element& bsdf) {
  static constexpr std::pair<const char*, Bsdf (*)(Context&, const Element&)> kReaders[] = {
      {"twosided", read_twosided},
      {"plastic roughplastic", read_plastic},
      {"conductor roughconductor", read_conductor},
      {"dielectric roughdielectric thindielectric", read_dielectric},
      {"mask", read_mask},
      {"bumpmap bump", read_bump},
      {"normalmap", read_normal_map},
      {"blendbsdf mixturebsdf", read_mixture},
      {"coating roughcoating", read_coating},
      {"null", read_null},
      {"principled principledthin", read_principled},
  };
  bsdf.contents.take();
  for (const auto& [types, reader] : kReaders)
    if (is_one_of(bsdf.type, types)) return reader(in, bsdf);
  return read_diffuse(in, bsdf);
}

// ---- Media

// Adds the medium inside a body; glTF has absorption only.
void absorb(Context& in, const Element& medium, Bsdf& surface) {
  if (medium.type != "homogeneous" || surface.opaque || !surface.material.solid || surface.turned)
    return medium.lose(kMedia);
  for (const Element* v : medium.children)  // volumes and named materials
    if ((v->object && v->tag != "phase") || v->name == "material") return medium.lose(kMedia);
  medium.nested("phase");
  medium.ignore("has_spectral_extinction");
  const Rgb scale = Rgb(single(medium.number("scale", 1)));
  Rgb absorbed(0), scattered(0);
  if (medium.find("sigma_t") || medium.find("albedo")) {
    const Rgb all = plain_colour(in, medium, "sigma_t", Rgb(1));
    const Rgb albedo = plain_colour(in, medium, "albedo", Rgb(0.75f));
    absorbed = all * (Rgb(1) - albedo), scattered = all * albedo;
  } else {
    absorbed = plain_colour(in, medium, "sigma_a", Rgb(0));
    scattered = plain_colour(in, medium, "sigma_s", Rgb(0));
  }
  if (!all_are(scattered, 0)) {
    medium.ignore_all();
    return medium.lose(kMedia);
  }
  const Rgb a = max(absorbed * scale, Rgb(0));
  surface.material.attenuation = {std::exp(-a.x), std::exp(-a.y), std::exp(-a.z)};
}

}  // namespace

Surface surface(Context& in, const Element& bsdf, const Element* interior) {
  const auto key = std::pair{&bsdf, interior};
  if (const auto it = in.surfaces.find(key); it != in.surfaces.end()) return it->second;
  Bsdf r = read_bsdf(in, bsdf);
  if (interior) absorb(in, *interior, r);
  r.material.name = bsdf.id.empty() ? bsdf.type : bsdf.id;
  const bool black =
      !r.material.base.texture && all_are(r.material.base.factor, 0) && r.material.specular == 0;
  in.scene.materials.push_back(std::move(r.material));
  return in.surfaces[key] = {in.scene.materials.size() - 1, r.turned,
                             r.opaque && !r.two_sided && !black};
}

}  // namespace tdpt::foreign::mitsuba
