#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/mitsuba/mitsuba.h"

namespace tdpt::foreign::mitsuba {
namespace {

float single(double v) {
  return static_cast<float>(v);
}

bool is_one(const Rgb& c) {
  return is_grey(c) && c.x == 1;
}
bool is_zero(const Rgb& c) {
  return is_grey(c) && c.x == 0;
}

// A surface as its type says.
struct Read {
  Material material;
  bool turned = false, two_sided = false;
  bool opaque = true;
};
Read read(Context& in, const Element& bsdf);

void near_to(const Element& bsdf, const char* what) {
  bsdf.lose(fmt::format("surfaces of type \"{}\" become {}", shown(bsdf.type, 40), what));
}

double ior(const Element& bsdf, const char* name, const char* otherwise) {
  const Element* v = bsdf.find(name);
  double n = 0;
  if (v && v->tag != "string") {
    n = bsdf.number(name, 1);
  } else {
    const std::string material = lower_case(bsdf.text(name, otherwise));
    const auto known = ior_named(material);
    if (!known)
      v->fail(
          fmt::format("no material \"{}\" has a known index of refraction", shown(material, 40)));
    n = *known;
  }
  if (!(n > 0.1 && n < 100)) v->fail(fmt::format("an index of refraction of {}", n));
  return n;
}

double relative_ior(const Element& bsdf, const char* inside) {
  if (bsdf.find("eta") && !bsdf.find("int_ior")) return bsdf.number("eta", 1);
  return ior(bsdf, "int_ior", inside) / ior(bsdf, "ext_ior", "air");
}

Number alpha(Context& in, const Element& bsdf) {
  const std::string distribution = bsdf.text("distribution", "beckmann");
  if (distribution != "ggx")
    bsdf.lose(fmt::format("microfacets of type \"{}\" become GGX", shown(distribution, 40)));
  bsdf.ignore("sample_visible");  // how it is sampled
  if (!bsdf.find("alpha_u") && !bsdf.find("alpha_v")) return number(in, bsdf, "alpha", 0.1);
  const double u = plain_number(in, bsdf, "alpha_u", 0.1),
               v = plain_number(in, bsdf, "alpha_v", 0.1);
  if (u != v) bsdf.lose("anisotropic roughness becomes isotropic");
  return {single(std::sqrt(std::max(0.0, u * v))), {}, {}};
}

Read nested(Context& in, const Element& bsdf) {
  const auto all = bsdf.nested("bsdf");
  if (all.empty()) bsdf.fail(fmt::format("the {} has no bsdf in it", bsdf.described()));
  return read(in, *all[0]);
}

// ---- each type

Read twosided(Context& in, const Element& bsdf) {
  Read out = nested(in, bsdf);
  if (bsdf.nested("bsdf").size() > 1)
    bsdf.lose("of the two bsdfs of a twosided surface the first is taken");
  bsdf.ignore("allow_transmission");  // lets a nested bsdf transmit
  out.two_sided = true;
  return out;
}

Read plain(Context& in, const Element& bsdf) {
  if (bsdf.type == "roughdiffuse") {
    near_to(bsdf, "Lambertian");
    bsdf.ignore("alpha use_fast_approx");  // of Oren-Nayar
  }
  const bool other_name = !bsdf.find("reflectance") && bsdf.find("diffuse_reflectance");
  return {diffuse(colour(in, bsdf, other_name ? "diffuse_reflectance" : "reflectance", Rgb(0.5f)))};
}

// Those of which only the diffuse part is understood.
Read coloured_plain(Context& in, const Element& bsdf) {
  const bool has_colour = bsdf.find("diffuse_reflectance") || bsdf.find("reflectance");
  bsdf.lose(fmt::format("surfaces of type \"{}\" are not read: Lambertian of {} in their place",
                        shown(bsdf.type, 40), has_colour ? "their diffuse colour" : "grey 0.5"));
  bsdf.ignore_all();
  return {diffuse(colour(in, bsdf,
                         bsdf.find("diffuse_reflectance") ? "diffuse_reflectance" : "reflectance",
                         Rgb(0.5f)))};
}

Read plastic_like(Context& in, const Element& bsdf) {
  const Number rough = bsdf.type == "plastic" ? Number{0.0f, {}, {}} : alpha(in, bsdf);
  const Colour base = colour(in, bsdf, "diffuse_reflectance", Rgb(0.5f));
  const double n = relative_ior(bsdf, "polypropylene");
  const bool nonlinear = bsdf.flag("nonlinear", false);
  Read out{bsdf.type == "plastic" ? plastic(base, n, rough, nonlinear)
                                  : rough_plastic(base, n, rough, nonlinear)};
  if (bsdf.type == "roughplastic")
    bsdf.lose("rough plastics reflect up to 4 % more or less than in Mitsuba");
  const Rgb tint = plain_colour(in, bsdf, "specular_reflectance", Rgb(1));
  if (!is_one(tint)) {
    bsdf.lose(
        "where the specular_reflectance of a plastic is not 1, its base is off by what its "
        "interface keeps back");
    const float most = std::clamp(max_component(tint), 0.0f, 1.0f);
    out.material.specular *= most;
    if (most > 0) out.material.specular_colour = tint / most;
  }
  bsdf.ignore("specular_sampling_weight");  // how it is sampled
  return out;
}

Read conductor_like(Context& in, const Element& bsdf) {
  const Number rough = bsdf.type == "conductor" ? Number{0.0f, {}, {}} : alpha(in, bsdf);
  if (const std::string lost = lost_of_rough_metal(rough); !lost.empty()) bsdf.lose(lost);
  const Colour tint = colour(in, bsdf, "specular_reflectance", Rgb(1));
  const bool has_eta = bsdf.find("eta") || (bsdf.old && bsdf.find("k"));
  const std::string name = bsdf.text("material", bsdf.old ? "Cu" : "none");
  // A whole mirror: also what Mitsuba 3 takes without a material.
  const bool is_none = name == "none" && !has_eta;
  if (is_none && !(bsdf.find("k") && !bsdf.old)) {
    if (bsdf.old) bsdf.ignore("ext_eta");  // a mirror in any medium
    return {metal(tint, rough)};
  }
  std::array<Rgb, 2> eta_k{Rgb(0), Rgb(1)};
  if (name != "none") {
    const auto known = conductor_named(name);
    if (!known && !has_eta)
      bsdf.lose(
          fmt::format("the metal \"{}\" is not known: aluminium in its place", shown(name, 40)));
    if (known || !has_eta) eta_k = known ? *known : *conductor_named("Al");
  }
  if (has_eta || name == "none") {
    if (!bsdf.old) eta_k = {Rgb(0), Rgb(1)};
    eta_k = {plain_colour(in, bsdf, "eta", eta_k[0]), plain_colour(in, bsdf, "k", eta_k[1])};
  }
  if (bsdf.old) {  // Mitsuba 3 has no ext_eta
    const float outside = single(ior(bsdf, "ext_eta", "air"));
    for (Rgb& c : eta_k) c = c / outside;
  }
  eta_k = {max(eta_k[0], Rgb(0)), max(eta_k[1], Rgb(0))};
  return {conductor(eta_k[0], eta_k[1], tint, rough)};
}

Read glass_like(Context& in, const Element& bsdf) {
  const bool solid = bsdf.type != "thindielectric";
  const Number rough = bsdf.type == "roughdielectric" ? alpha(in, bsdf) : Number{0.0f, {}, {}};
  double n = relative_ior(bsdf, "bk7");
  Read out;
  // A body that is thinner than what is around it is what is around it, seen from the back.
  out.turned = solid && n < 1;
  if (n < 1) n = 1 / n;
  out.material = glass(n, colour(in, bsdf, "specular_transmittance", Rgb(1)), rough, solid);
  out.opaque = false;
  const Rgb mirrored = plain_colour(in, bsdf, "specular_reflectance", Rgb(1));
  if (!is_one(mirrored)) bsdf.lose("the specular_reflectance of glass is left out");
  return out;
}

Read mask(Context& in, const Element& bsdf) {
  Read out = nested(in, bsdf);
  Number opacity = number(in, bsdf, "opacity", 0.5);
  opacity.factor *= out.material.opacity.factor;
  if (out.material.opacity.texture) {
    bsdf.lose("of a mask in a mask the outer texture is taken");
    if (!opacity.texture) opacity.texture = out.material.opacity.texture;
  }
  out.material.opacity = opacity;
  if (const Element* v = bsdf.find("opacity"); v && is_colour(*v))
    if (!is_grey(colour_of(*v, Role::surface))) bsdf.lose("the colour of an opacity becomes grey");
  return out;
}

Read bump(Context& in, const Element& bsdf) {
  Read out = nested(in, bsdf);
  const auto maps = bsdf.nested("texture");
  if (maps.empty()) bsdf.fail(fmt::format("the {} has no texture in it", bsdf.described()));
  bsdf.ignore("flip_invalid_normals use_shadowing_function");  // of normals seen from behind
  // 0.x reads bitmaps of these as numbers.
  const Colour c = texture(in, *maps[0], Role::surface, bsdf.old);
  if (!c.texture) return out;
  if (bsdf.type == "normalmap") {
    const Image& image = in.scene.images[c.texture->image];
    if (image.bytes.empty() || bsdf.source->has(image.name, bsdf.place))  // a stand-in is no normal
      out.material.normal = c.texture;
  } else {
    out.material.bump = c.texture;
    out.material.bump_scale = mean(c.factor) * bsdf.number("scale", 1);
  }
  return out;
}

Read blend(Context& in, const Element& bsdf) {
  const auto all = bsdf.nested("bsdf");
  if (all.size() != 2)
    bsdf.fail(fmt::format("the blendbsdf has {} bsdfs in it, expected 2", all.size()));
  near_to(bsdf, "the heavier of the two");
  const Number weight = number(in, bsdf, "weight", 0.5);
  return read(in, *all[!weight.texture && weight.factor > 0.5f ? 1 : 0]);
}

Read mixture(Context& in, const Element& bsdf) {
  const auto all = bsdf.nested("bsdf");
  std::vector<double> weights;
  for (const std::string& word : split(bsdf.needed_text("weights"), " ,;\t\r\n")) {
    weights.push_back(bsdf.find("weights")->finite(word));
  }
  if (weights.size() != all.size() || all.empty())
    bsdf.fail(
        fmt::format("the mixturebsdf has {} bsdfs and {} weights", all.size(), weights.size()));
  near_to(bsdf, "the heaviest of those mixed");
  return read(in, *all[static_cast<size_t>(std::max_element(weights.begin(), weights.end()) -
                                           weights.begin())]);
}

// A coat sends what its inside throws back nowhere, so it darkens what scatters widely
// [coating.cpp]. Over a Lambertian surface it is plastic without that light; otherwise glTF's coat.
Read coated(Context& in, const Element& bsdf) {
  Read out = nested(in, bsdf);
  Material& m = out.material;
  const double n = relative_ior(bsdf, "bk7"), inside = n < 1 ? n : 1 / n;
  const bool smooth = bsdf.type == "coating";
  Number rough = smooth ? Number{0.0f, {}, {}} : alpha(in, bsdf);
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
    if (m.metallic < 1 || m.roughness.factor > 0 || m.roughness.texture)
      bsdf.lose(
          "coats darken what scatters below them less than in Mitsuba, which drops the light that "
          "they throw back");
    if (std::abs(n - 1.5) > 0.02)
      bsdf.lose(fmt::format("coats of index {:.4g} become ones of index 1.5", n));
    if (rough.texture) bsdf.lose("the texture of a coat's roughness is left out");
    m.coat = 1;
    m.coat_roughness = std::sqrt(std::clamp(rough.texture ? 0.1f : rough.factor, 0.0f, 1.0f));
  }
  const double thickness = bsdf.number("thickness", 1);
  if (thickness != 0 && !is_zero(plain_colour(in, bsdf, "sigma_a", Rgb(0))))
    bsdf.lose("the absorption in coats is left out");
  if (!is_one(plain_colour(in, bsdf, "specular_reflectance", Rgb(1))))
    bsdf.lose("the specular_reflectance of coats is left out");
  return out;
}

Read invisible(Context&, const Element&) {
  Read out{diffuse({Rgb(0), {}, {}})};
  out.material.invisible = true;
  out.opaque = false;
  return out;
}

// [Burley 2012, 2015]: what glTF has of it.
Read principled(Context& in, const Element& bsdf) {
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
  Read out;
  Material& m = out.material;
  // Thin sheets have an interface only where they transmit.
  m = burley(base, n, roughness, metallic, thin ? transmission : 1);
  const Number square{roughness.factor * roughness.factor, roughness.texture, {}};
  if (transmission == 1 && metallic == 0) {
    m.base = base;
    if (thin)
      bsdf.lose("thin surfaces that transmit scatter as glTF has it");
    else  // a body colours by the root at each side
      m.base = through(
          base, [](const Rgb& c) { return Rgb(std::sqrt(c.x), std::sqrt(c.y), std::sqrt(c.z)); });
  } else if (transmission > 0) {
    bsdf.lose("surfaces between opaque and transparent are mixed as glTF has it");
  } else if (metallic < 1 || !lost_of_rough_metal(square).empty()) {
    bsdf.lose(
        "principled surfaces reflect as much as in Mitsuba on the whole, but up to a tenth more or "
        "less by direction");
  }
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
  bsdf.ignore(
      "sheen_tint main_specular_sampling_rate clearcoat_sampling_rate "
      "diffuse_reflectance_sampling_rate specular_reflectance_sampling_rate "
      "specular_transmittance_sampling_rate diffuse_transmittance_sampling_rate");  // of sheen; how
                                                                                    // it is sampled
  out.opaque = m.transmission == 0;
  return out;
}

Read read(Context& in, const Element& bsdf) {
  static constexpr std::pair<const char*, Read (*)(Context&, const Element&)> kReaders[] = {
      {"twosided", twosided},
      {"diffuse lambertian roughdiffuse", plain},
      {"plastic roughplastic", plastic_like},
      {"conductor roughconductor", conductor_like},
      {"dielectric roughdielectric thindielectric", glass_like},
      {"mask", mask},
      {"bumpmap bump normalmap", bump},
      {"blendbsdf", blend},
      {"mixturebsdf", mixture},
      {"coating roughcoating", coated},
      {"null", invisible},
      {"principled principledthin", principled},
  };
  bsdf.contents.take();
  for (const auto& [types, reader] : kReaders)
    if (is_one_of(bsdf.type, types)) return reader(in, bsdf);
  return coloured_plain(in, bsdf);
}

// ---- media

// What is in a body: glTF has absorption alone.
void absorb(Context& in, const Element& medium, Read& surface) {
  if (medium.type != "homogeneous" || surface.opaque || !surface.material.solid || surface.turned)
    return medium.lose(kMedia);
  for (const Element* v : medium.children)  // volumes and named materials
    if ((v->object && v->tag != "phase") || v->name == "material") return medium.lose(kMedia);
  medium.nested("phase");
  medium.ignore("has_spectral_extinction sample_emitters");  // how it is sampled
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
  if (!is_zero(scattered)) {
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
  Read r = read(in, bsdf);
  if (interior) absorb(in, *interior, r);
  r.material.name = bsdf.id.empty() ? bsdf.type : bsdf.id;
  const bool black =
      !r.material.base.texture && is_zero(r.material.base.factor) && r.material.specular == 0;
  in.scene.materials.push_back(std::move(r.material));
  return in.surfaces[key] = {in.scene.materials.size() - 1, r.turned,
                             r.opaque && !r.two_sided && !black};
}

}  // namespace tdpt::foreign::mitsuba
