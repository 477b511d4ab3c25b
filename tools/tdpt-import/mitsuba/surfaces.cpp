#include "tools/tdpt-import/mitsuba/surfaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"

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

}  // namespace

void Surfaces::near_to(const Object& bsdf, const char* what) {
  lose(bsdf, fmt::format("surfaces of type \"{}\" become {}", shown(bsdf.type, 40), what));
}

double Surfaces::ior(const Object& bsdf, const char* name, const char* otherwise) {
  const Value* v = bsdf.find(name);
  double n = 0;
  if (v && v->tag != "string") {
    n = bsdf.number(name, 1);
  } else {
    std::string material = bsdf.text(name, otherwise);
    std::transform(material.begin(), material.end(), material.begin(), [](char c) {
      return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    const auto known = ior_named(material);
    if (!known)
      v->fail(
          fmt::format("no material \"{}\" has a known index of refraction", shown(material, 40)));
    n = *known;
  }
  if (!(n > 0.1 && n < 100)) v->fail(fmt::format("an index of refraction of {}", n));
  return n;
}

double Surfaces::relative_ior(const Object& bsdf, const char* inside) {
  if (bsdf.find("eta") && !bsdf.find("int_ior")) return bsdf.number("eta", 1);
  return ior(bsdf, "int_ior", inside) / ior(bsdf, "ext_ior", "air");
}

Number Surfaces::alpha(const Object& bsdf) {
  const std::string distribution = bsdf.text("distribution", "beckmann");
  if (distribution != "ggx")
    lose(bsdf, fmt::format("microfacets of type \"{}\" become GGX", shown(distribution, 40)));
  bsdf.ignore({"sample_visible"});  // how it is sampled
  if (!bsdf.find("alpha_u") && !bsdf.find("alpha_v")) return textures_.number(bsdf, "alpha", 0.1);
  const double u = textures_.plain_number(bsdf, "alpha_u", 0.1),
               v = textures_.plain_number(bsdf, "alpha_v", 0.1);
  if (u != v) lose(bsdf, "anisotropic roughness becomes isotropic");
  return {single(std::sqrt(std::max(0.0, u * v))), {}, {}};
}

Surfaces::Read Surfaces::nested(const Object& bsdf) {
  const auto all = bsdf.nested("bsdf");
  if (all.empty()) bsdf.fail(fmt::format("the {} has no bsdf in it", described(bsdf)));
  return read(*all[0]);
}

// ---- each type

Surfaces::Read Surfaces::twosided(const Object& bsdf) {
  Read out = nested(bsdf);
  if (bsdf.nested("bsdf").size() > 1)
    lose(bsdf, "of the two bsdfs of a twosided surface the first is taken");
  bsdf.ignore({"allow_transmission"});  // lets a nested bsdf transmit
  out.two_sided = true;
  return out;
}

Surfaces::Read Surfaces::plain(const Object& bsdf) {
  if (bsdf.type == "roughdiffuse") {
    near_to(bsdf, "Lambertian");
    bsdf.ignore({"alpha", "use_fast_approx"});  // of Oren-Nayar
  }
  const bool other_name = !bsdf.find("reflectance") && bsdf.find("diffuse_reflectance");
  return {diffuse(
      textures_.colour(bsdf, other_name ? "diffuse_reflectance" : "reflectance", Rgb(0.5f)))};
}

// Those of which only the diffuse part is understood.
Surfaces::Read Surfaces::coloured_plain(const Object& bsdf) {
  const bool has_colour = bsdf.find("diffuse_reflectance") || bsdf.find("reflectance");
  lose(bsdf, fmt::format("surfaces of type \"{}\" are not read: Lambertian of {} in their place",
                         shown(bsdf.type, 40), has_colour ? "their diffuse colour" : "grey 0.5"));
  bsdf.ignore_all();
  return {diffuse(textures_.colour(
      bsdf, bsdf.find("diffuse_reflectance") ? "diffuse_reflectance" : "reflectance", Rgb(0.5f)))};
}

Surfaces::Read Surfaces::plastic_like(const Object& bsdf) {
  const Number rough = bsdf.type == "plastic" ? Number{0.0f, {}, {}} : alpha(bsdf);
  const Colour base = textures_.colour(bsdf, "diffuse_reflectance", Rgb(0.5f));
  const double n = relative_ior(bsdf, "polypropylene");
  const bool nonlinear = bsdf.flag("nonlinear", false);
  Read out{bsdf.type == "plastic" ? plastic(base, n, rough, nonlinear)
                                  : rough_plastic(base, n, rough, nonlinear)};
  if (bsdf.type == "roughplastic")
    lose(bsdf, "rough plastics reflect up to 4 % more or less than in Mitsuba");
  const Rgb tint = textures_.plain_colour(bsdf, "specular_reflectance", Rgb(1));
  if (!is_one(tint)) {
    lose(bsdf,
         "where the specular_reflectance of a plastic is not 1, its base is off by what its "
         "interface keeps back");
    const float most = std::clamp(max_component(tint), 0.0f, 1.0f);
    out.material.specular *= most;
    if (most > 0) out.material.specular_colour = tint / most;
  }
  bsdf.ignore({"specular_sampling_weight"});  // how it is sampled
  return out;
}

Surfaces::Read Surfaces::conductor_like(const Object& bsdf) {
  const Number rough = bsdf.type == "conductor" ? Number{0.0f, {}, {}} : alpha(bsdf);
  if (const std::string lost = lost_of_rough_metal(rough); !lost.empty()) lose(bsdf, lost);
  const Colour tint = textures_.colour(bsdf, "specular_reflectance", Rgb(1));
  const bool has_eta = bsdf.find("eta") || (bsdf.old && bsdf.find("k"));
  const std::string name = bsdf.text("material", bsdf.old ? "Cu" : "none");
  // A whole mirror: also what Mitsuba 3 takes without a material.
  const bool is_none = name == "none" && !has_eta;
  if (is_none && !(bsdf.find("k") && !bsdf.old)) {
    if (bsdf.old) bsdf.ignore({"ext_eta"});  // a mirror in any medium
    return {metal(tint, rough)};
  }
  std::array<Rgb, 2> eta_k{Rgb(0), Rgb(1)};
  if (name != "none") {
    const auto known = conductor_named(name);
    if (!known && !has_eta)
      lose(bsdf,
           fmt::format("the metal \"{}\" is not known: aluminium in its place", shown(name, 40)));
    if (known || !has_eta) eta_k = known ? *known : *conductor_named("Al");
  }
  if (has_eta || name == "none") {
    if (!bsdf.old) eta_k = {Rgb(0), Rgb(1)};
    eta_k = {textures_.plain_colour(bsdf, "eta", eta_k[0]),
             textures_.plain_colour(bsdf, "k", eta_k[1])};
  }
  if (bsdf.old) {  // Mitsuba 3 has no ext_eta
    const float outside = single(ior(bsdf, "ext_eta", "air"));
    for (Rgb& c : eta_k) c = c / outside;
  }
  eta_k = {max(eta_k[0], Rgb(0)), max(eta_k[1], Rgb(0))};
  return {conductor(eta_k[0], eta_k[1], tint, rough)};
}

Surfaces::Read Surfaces::glass_like(const Object& bsdf) {
  const bool solid = bsdf.type != "thindielectric";
  const Number rough = bsdf.type == "roughdielectric" ? alpha(bsdf) : Number{0.0f, {}, {}};
  double n = relative_ior(bsdf, "bk7");
  Read out;
  // A body that is thinner than what is around it is what is around it, seen from the back.
  out.turned = solid && n < 1;
  if (n < 1) n = 1 / n;
  out.material = glass(n, textures_.colour(bsdf, "specular_transmittance", Rgb(1)), rough, solid);
  out.opaque = false;
  const Rgb mirrored = textures_.plain_colour(bsdf, "specular_reflectance", Rgb(1));
  if (!is_one(mirrored)) lose(bsdf, "the specular_reflectance of glass is left out");
  return out;
}

Surfaces::Read Surfaces::mask(const Object& bsdf) {
  Read out = nested(bsdf);
  Number opacity = textures_.number(bsdf, "opacity", 0.5);
  opacity.factor *= out.material.opacity.factor;
  if (out.material.opacity.texture) {
    lose(bsdf, "of a mask in a mask the outer texture is taken");
    if (!opacity.texture) opacity.texture = out.material.opacity.texture;
  }
  out.material.opacity = opacity;
  if (const Value* v = bsdf.find("opacity"); v && is_colour(*v))
    if (!is_grey(colour_of(*v, bsdf.old, Of::surface, source_)))
      lose(bsdf, "the colour of an opacity becomes grey");
  return out;
}

Surfaces::Read Surfaces::bump(const Object& bsdf) {
  Read out = nested(bsdf);
  const auto maps = bsdf.nested("texture");
  if (maps.empty()) bsdf.fail(fmt::format("the {} has no texture in it", described(bsdf)));
  bsdf.ignore({"flip_invalid_normals", "use_shadowing_function"});  // of normals seen from behind
  // 0.x reads bitmaps of these as numbers.
  const Colour c = textures_.of(*maps[0], Of::surface, bsdf.old);
  if (!c.texture) return out;
  if (bsdf.type == "normalmap") {
    const Image& image = scene_.images[c.texture->image];
    if (image.bytes.empty() || source_.has(image.name, bsdf.place))  // a stand-in is no normal
      out.material.normal = c.texture;
  } else {
    out.material.bump = c.texture;
    out.material.bump_scale = mean(c.factor) * bsdf.number("scale", 1);
  }
  return out;
}

Surfaces::Read Surfaces::blend(const Object& bsdf) {
  const auto all = bsdf.nested("bsdf");
  if (all.size() != 2)
    bsdf.fail(fmt::format("the blendbsdf has {} bsdfs in it, expected 2", all.size()));
  near_to(bsdf, "the heavier of the two");
  const Number weight = textures_.number(bsdf, "weight", 0.5);
  return read(*all[!weight.texture && weight.factor > 0.5f ? 1 : 0]);
}

Surfaces::Read Surfaces::mixture(const Object& bsdf) {
  const auto all = bsdf.nested("bsdf");
  std::vector<double> weights;
  for (const std::string& word : split(bsdf.needed_text("weights"), " ,;\t\r\n")) {
    const auto w = number_of(word);
    if (!w)
      bsdf.find("weights")->fail(fmt::format("\"{}\" is not a finite number", shown(word, 40)));
    weights.push_back(*w);
  }
  if (weights.size() != all.size() || all.empty())
    bsdf.fail(
        fmt::format("the mixturebsdf has {} bsdfs and {} weights", all.size(), weights.size()));
  near_to(bsdf, "the heaviest of those mixed");
  return read(*all[static_cast<size_t>(std::max_element(weights.begin(), weights.end()) -
                                       weights.begin())]);
}

// A coat sends what its inside throws back nowhere, so it darkens what scatters widely
// [coating.cpp]. Over a Lambertian surface it is plastic without that light; otherwise glTF's coat.
Surfaces::Read Surfaces::coated(const Object& bsdf) {
  Read out = nested(bsdf);
  Material& m = out.material;
  const double n = relative_ior(bsdf, "bk7"), inside = n < 1 ? n : 1 / n;
  const bool smooth = bsdf.type == "coating";
  Number rough = smooth ? Number{0.0f, {}, {}} : alpha(bsdf);
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
      lose(bsdf,
           "coats darken what scatters below them less than in Mitsuba, which drops the light that "
           "they throw back");
    if (std::abs(n - 1.5) > 0.02)
      lose(bsdf, fmt::format("coats of index {:.4g} become ones of index 1.5", n));
    if (rough.texture) lose(bsdf, "the texture of a coat's roughness is left out");
    m.coat = 1;
    m.coat_roughness = std::sqrt(std::clamp(rough.texture ? 0.1f : rough.factor, 0.0f, 1.0f));
  }
  const double thickness = bsdf.number("thickness", 1);
  if (thickness != 0 && !is_zero(textures_.plain_colour(bsdf, "sigma_a", Rgb(0))))
    lose(bsdf, "the absorption in coats is left out");
  if (!is_one(textures_.plain_colour(bsdf, "specular_reflectance", Rgb(1))))
    lose(bsdf, "the specular_reflectance of coats is left out");
  return out;
}

Surfaces::Read Surfaces::invisible(const Object&) {
  Read out{diffuse({Rgb(0), {}, {}})};
  out.material.invisible = true;
  out.opaque = false;
  return out;
}

// [Burley 2012, 2015]: what glTF has of it.
Surfaces::Read Surfaces::principled(const Object& bsdf) {
  const bool thin = bsdf.type == "principledthin";
  const Colour base = textures_.colour(bsdf, "base_color", Rgb(0.5f));
  const Number roughness = textures_.number(bsdf, "roughness", 0.5);
  const auto share = [&](const char* name) {
    return std::clamp(textures_.plain_number(bsdf, name, 0), 0.0, 1.0);
  };
  const double metallic = share("metallic"), transmission = share("spec_trans");
  const double specular = std::clamp(bsdf.number("specular", 0.5), 0.0, 12.0);
  double n = 2 / (1 - std::sqrt(0.08 * specular)) - 1;
  if (bsdf.find("eta")) n = textures_.plain_number(bsdf, "eta", 1.5);
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
      lose(bsdf, "thin surfaces that transmit scatter as glTF has it");
    else  // a body colours by the root at each side
      m.base = through(
          base, [](const Rgb& c) { return Rgb(std::sqrt(c.x), std::sqrt(c.y), std::sqrt(c.z)); });
  } else if (transmission > 0) {
    lose(bsdf, "surfaces between opaque and transparent are mixed as glTF has it");
  } else if (metallic < 1 || !lost_of_rough_metal(square).empty()) {
    lose(
        bsdf,
        "principled surfaces reflect as much as in Mitsuba on the whole, but up to a tenth more or "
        "less by direction");
  }
  m.transmission = single(transmission);
  m.solid = !thin;
  m.coat = single(0.25 * textures_.plain_number(bsdf, "clearcoat", 0));
  const double gloss = textures_.plain_number(bsdf, "clearcoat_gloss", 0);
  if (m.coat > 0) {
    lose(bsdf, "the highlights of clear coats become GGX");
    m.coat_roughness = single(std::sqrt(0.1 + std::clamp(gloss, 0.0, 1.0) * (0.001 - 0.1)));
  }
  for (const char* name : {"anisotropic", "sheen", "flatness", "spec_tint", "diff_trans"}) {
    const Number v = textures_.number(bsdf, name, 0);
    if (v.texture || v.factor != 0)
      lose(bsdf, fmt::format("the \"{}\" of principled surfaces is left out", name));
  }
  bsdf.ignore({"sheen_tint", "main_specular_sampling_rate", "clearcoat_sampling_rate",
               "diffuse_reflectance_sampling_rate", "specular_reflectance_sampling_rate",
               "specular_transmittance_sampling_rate",
               "diffuse_transmittance_sampling_rate"});  // of sheen; how it is sampled
  out.opaque = m.transmission == 0;
  return out;
}

Surfaces::Read Surfaces::read(const Object& bsdf) {
  static const std::map<std::string, Reader> kReaders = {
      {"twosided", &Surfaces::twosided},
      {"diffuse", &Surfaces::plain},
      {"lambertian", &Surfaces::plain},
      {"roughdiffuse", &Surfaces::plain},
      {"plastic", &Surfaces::plastic_like},
      {"roughplastic", &Surfaces::plastic_like},
      {"conductor", &Surfaces::conductor_like},
      {"roughconductor", &Surfaces::conductor_like},
      {"dielectric", &Surfaces::glass_like},
      {"roughdielectric", &Surfaces::glass_like},
      {"thindielectric", &Surfaces::glass_like},
      {"mask", &Surfaces::mask},
      {"bumpmap", &Surfaces::bump},
      {"bump", &Surfaces::bump},
      {"normalmap", &Surfaces::bump},
      {"blendbsdf", &Surfaces::blend},
      {"mixturebsdf", &Surfaces::mixture},
      {"coating", &Surfaces::coated},
      {"roughcoating", &Surfaces::coated},
      {"null", &Surfaces::invisible},
      {"principled", &Surfaces::principled},
      {"principledthin", &Surfaces::principled},
  };
  bsdf.key.take();
  const auto it = kReaders.find(bsdf.type);
  return (this->*(it == kReaders.end() ? &Surfaces::coloured_plain : it->second))(bsdf);
}

// ---- media

// What is in a body: glTF has absorption alone.
void Surfaces::absorb(const Object& medium, Read& surface) {
  const std::string sentence = "media (fog, absorption, scattering) are left out";
  if (medium.type != "homogeneous" || surface.opaque || !surface.material.solid || surface.turned)
    return lose(medium, sentence);
  for (const Value& v : medium.values)  // volumes and named materials
    if ((v.object && v.object->tag != "phase") || v.name == "material")
      return lose(medium, sentence);
  medium.nested("phase");
  medium.ignore({"has_spectral_extinction", "sample_emitters"});  // how it is sampled
  const Rgb scale = Rgb(single(medium.number("scale", 1)));
  Rgb absorbed(0), scattered(0);
  if (medium.find("sigma_t") || medium.find("albedo")) {
    const Rgb all = textures_.plain_colour(medium, "sigma_t", Rgb(1));
    const Rgb albedo = textures_.plain_colour(medium, "albedo", Rgb(0.75f));
    absorbed = all * (Rgb(1) - albedo), scattered = all * albedo;
  } else {
    absorbed = textures_.plain_colour(medium, "sigma_a", Rgb(0));
    scattered = textures_.plain_colour(medium, "sigma_s", Rgb(0));
  }
  if (!is_zero(scattered)) {
    medium.ignore_all();
    return lose(medium, sentence);
  }
  const Rgb a = max(absorbed * scale, Rgb(0));
  surface.material.attenuation = {std::exp(-a.x), std::exp(-a.y), std::exp(-a.z)};
}

Surfaces::Made Surfaces::material(const Object& bsdf, const Object* interior) {
  const auto key = std::pair{&bsdf, interior};
  if (const auto it = made_.find(key); it != made_.end()) return it->second;
  Read r = read(bsdf);
  if (interior) absorb(*interior, r);
  r.material.name = bsdf.id.empty() ? bsdf.type : bsdf.id;
  const bool black =
      !r.material.base.texture && is_zero(r.material.base.factor) && r.material.specular == 0;
  scene_.materials.push_back(std::move(r.material));
  return made_[key] = {scene_.materials.size() - 1, r.turned, r.opaque && !r.two_sided && !black};
}

Surfaces::Made Surfaces::material(Default without) {
  if (const auto it = defaults_.find(without); it != defaults_.end()) return it->second;
  Material m = diffuse({Rgb(without == Default::grey ? 0.5f : 0.0f), {}, {}});
  m.invisible = without == Default::invisible;
  m.name = without == Default::grey ? "default" : without == Default::black ? "black" : "null";
  scene_.materials.push_back(std::move(m));
  return defaults_[without] = {scene_.materials.size() - 1, false, without == Default::grey};
}

}  // namespace tdpt::foreign::mitsuba
