#include "tools/tdpt-import/tungsten/surfaces.h"

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"

namespace tdpt::foreign::tungsten {
namespace {

constexpr int kDeepest = 16;  // nested surfaces
const Number kSmooth{0.0f, {}, {}};

Rgb rgb(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

float mean(const Rgb& c) {
  return (c.x + c.y + c.z) / 3;
}

void lose_absorption(const Node& bsdf) {
  const Vec3d absorbed = bsdf.vector("sigma_a", Vec3d(0)) * bsdf.number("thickness", 1);
  if (max_component(absorbed) > 0) bsdf.lose("the absorption (sigma_a) in coats is left out");
}

}  // namespace

Surfaces::Surfaces(Described& scene, const std::optional<Node>& bsdfs) : scene_(scene) {
  if (!bsdfs) return;
  if (!bsdfs->is_array()) bsdfs->fail("is no array");
  for (size_t i = 0; i < bsdfs->json().size(); ++i) {
    const Node bsdf = bsdfs->item(i);
    if (!bsdf.is_object()) bsdf.fail("is no object");
    // Not asked for: a surface that nobody uses stays unread.
    const Json name = bsdf.json().value("name", Json());
    if (name.is_string()) named_.emplace(name, bsdf);  // of two of a name, the first counts
  }
}

size_t Surfaces::image(const Node& node, const std::string& name) {
  const auto it = images_.find(name);
  if (it != images_.end()) return it->second;
  scene_.images.push_back({name, node.source().read_picture(name, node.place())});
  return images_[name] = scene_.images.size() - 1;
}

Texture Surfaces::checker(const Node& node) {
  const Rgb on = rgb(node.vector("on_color", Vec3d(0.8)));
  const Rgb off = rgb(node.vector("off_color", Vec3d(0.2)));
  const double u = node.number("res_u", 20), v = node.number("res_v", 20);
  // Squares count from the lower left corner of the image, where the first is off.
  scene_.images.push_back({"checker", {}, 2, 2, {on, off, off, on}});
  Texture t;
  t.image = scene_.images.size() - 1;
  t.nearest = true;
  t.map = {u / 2, 0, 0, 0, v / 2, 1 - v / 2};
  return t;
}

std::optional<Texture> Surfaces::texture(const Node& node, Rgb& constant) {
  if (node.is_number() || node.is_array()) {
    constant = rgb(node.vector());
    return {};
  }
  constant = Rgb(1);
  if (node.is_string()) {
    Texture t;
    t.image = image(node, node.text());
    return t;
  }
  if (!node.is_object()) node.fail("is no texture: neither number, colour, file nor object");
  const std::string type = node.text("type", "");
  if (type == "bitmap") {
    Texture t;
    const auto file = node.find("file");
    if (!file) node.fail("has no \"file\"");
    t.image = image(*file, file->text());
    t.srgb = node.flag("gamma_correct", true);
    t.nearest = !node.flag("interpolate", true);
    if (node.flag("clamp", false)) t.wrap_u = t.wrap_v = Texture::Wrap::clamp;
    const double scale = node.number("scale", 1);
    if (!t.nearest) constant = Rgb(static_cast<float>(scale));  // as in Tungsten
    return t;
  }
  if (type == "checker") return checker(node);
  if (type == "constant") {
    constant = rgb(node.vector("value", Vec3d(1)));
    return {};
  }
  node.lose(fmt::format("textures of type \"{}\" are not read: grey of 0.5 in their place",
                        shown(type, 40)));
  node.ignore_all();
  constant = Rgb(0.5f);
  return {};
}

Colour Surfaces::colour(const Node& node) {
  Colour c;
  c.texture = texture(node, c.factor);
  return c;
}

Number Surfaces::number(const Node& node) {
  Rgb constant;
  Number n;
  n.texture = texture(node, constant);
  n.factor = mean(constant);
  if (n.texture) n.texture->srgb = false;  // whatever gamma_correct says
  return n;
}

Colour Surfaces::albedo(const Node& bsdf) {
  const auto a = bsdf.find("albedo");
  return a ? colour(*a) : Colour{};
}

Number Surfaces::roughness(const Node& bsdf, double otherwise) {
  const std::string distribution = bsdf.text("distribution", "ggx");
  if (distribution != "ggx")
    bsdf.lose(fmt::format("microfacets of type \"{}\" become GGX", shown(distribution, 40)));
  const auto r = bsdf.find("roughness");
  return r ? number(*r) : Number{static_cast<float>(otherwise), {}, {}};
}

Material Surfaces::conductor_of(const Node& bsdf, const Number& alpha) {
  if (const std::string lost = lost_of_rough_metal(alpha); !lost.empty()) bsdf.lose(lost);
  const auto name = bsdf.find("material"), eta = bsdf.find("eta"), k = bsdf.find("k");
  const auto known = conductor_named(name ? name->text() : "Cu");
  if (!known)
    bsdf.lose("the metal \"" + shown(name->text(), 40) + "\" is not known: aluminium in its place");
  auto [n, kappa] = known ? *known : *conductor_named("Al");
  if (!name && eta) {  // a material prevails; without eta, Tungsten does not read k
    n = rgb(eta->vector());
    if (k) kappa = rgb(k->vector());
  }
  return conductor(n, kappa, albedo(bsdf), alpha);
}

Material Surfaces::read_nested(const Node& bsdf, int depth) {
  if (depth > kDeepest) bsdf.fail("is nested too deeply, or within itself");
  if (!bsdf.is_string()) return read(bsdf, depth);
  const std::string name = bsdf.text();
  const auto it = named_.find(name);
  if (it == named_.end() && (name == "null" || name == "NULL")) return diffuse({Rgb(0), {}, {}});
  if (it == named_.end()) bsdf.fail("\"" + shown(name) + "\" is no surface of the scene");
  return read(it->second, depth);
}

double Surfaces::ior(const Node& bsdf) {
  const double v = bsdf.number("ior", 1.5);
  if (!(v > 0.1 && v < 100)) bsdf.fail(fmt::format("has an index of refraction of {}", v));
  if (v >= 1) return v;
  bsdf.lose("an index of refraction below 1 becomes its inverse");
  return 1 / v;
}

Material Surfaces::inner(const Node& bsdf, const char* key, int depth) {
  const auto node = bsdf.find(key);
  if (!node) bsdf.fail(fmt::format("has no \"{}\"", key));
  return read_nested(*node, depth + 1);
}

Material Surfaces::plastic_of(const Node& bsdf, const Number& alpha) {
  lose_absorption(bsdf);
  return plastic(albedo(bsdf), ior(bsdf), alpha, true);
}

Material Surfaces::glass_of(const Node& bsdf, const Number& alpha) {
  if (!bsdf.flag("enable_refraction", true))
    bsdf.lose("glass that only reflects (enable_refraction) refracts");
  return glass(ior(bsdf), albedo(bsdf), alpha, true);
}

Material Surfaces::sheet_of(const Node& bsdf) {
  if (bsdf.flag("enable_interference", false))
    bsdf.lose("the interference of thin sheets is left out");
  if (max_component(bsdf.vector("sigma_a", Vec3d(0))) > 0)
    bsdf.lose("the absorption of thin sheets is left out");
  bsdf.ignore({"thickness"});  // of interference and absorption
  return glass(ior(bsdf), albedo(bsdf), kSmooth, false);
}

Material Surfaces::transparent(const Node& bsdf, int depth) {
  Material m = inner(bsdf, "base", depth);
  bsdf.ignore({"albedo"});  // the base's counts
  const auto alpha = bsdf.find("alpha");
  if (alpha) m.opacity = number(*alpha);
  if (m.opacity.texture) m.opacity.texture->alpha = true;
  return m;
}

Material Surfaces::coated(const Node& bsdf, const Number& alpha, int depth) {
  Material m = inner(bsdf, "substrate", depth);
  m.coat = 1;
  if (alpha.texture) bsdf.lose("the texture of a coat's roughness is left out");
  m.coat_roughness = std::sqrt(alpha.texture ? 0.1f : std::clamp(alpha.factor, 0.0f, 1.0f));
  lose_absorption(bsdf);
  bsdf.ignore({"albedo", "ior"});  // the substrate's counts; named
  return m;
}

Material Surfaces::heavier(const Node& bsdf, int depth) {
  const auto share = bsdf.find("ratio");
  bsdf.ignore({"bsdf0", "bsdf1"});
  if (const Colour all = albedo(bsdf); all.texture || mean(all.factor) != 1)
    bsdf.lose("the albedo of mixed surfaces, which multiplies both, is left out");
  return inner(bsdf, !share || number(*share).factor >= 0.5f ? "bsdf0" : "bsdf1", depth);
}

Material Surfaces::of_type(const std::string& type, const Node& bsdf, int depth) {
  const auto near_to = [&](const char* what) {
    bsdf.lose(fmt::format("surfaces of type \"{}\" become {}", shown(type, 40), what));
  };
  if (type == "lambert") return diffuse(albedo(bsdf));
  if (type == "mirror") return mirror(albedo(bsdf));
  if (type == "conductor") return conductor_of(bsdf, kSmooth);
  if (type == "rough_conductor") return conductor_of(bsdf, roughness(bsdf, 0.1));
  if (type == "plastic") return plastic_of(bsdf, kSmooth);
  if (type == "rough_plastic") return plastic_of(bsdf, roughness(bsdf, 0.02));
  if (type == "dielectric") return glass_of(bsdf, kSmooth);
  if (type == "rough_dielectric") return glass_of(bsdf, roughness(bsdf, 0.1));
  if (type == "thinsheet") return sheet_of(bsdf);
  if (type == "transparency") return transparent(bsdf, depth);
  if (type == "oren_nayar") {
    near_to("Lambertian");
    bsdf.ignore({"roughness"});  // of Oren-Nayar
    return diffuse(albedo(bsdf));
  }
  if (type == "smooth_coat" || type == "rough_coat") {
    near_to("a clear coat of index 1.5");
    return coated(bsdf, type == "smooth_coat" ? kSmooth : roughness(bsdf, 0.02), depth);
  }
  if (type == "mixed") {
    near_to("the heavier of the two");
    return heavier(bsdf, depth);
  }
  if (type == "null" || type == "forward") {  // absorbs all light; lets all pass
    bsdf.ignore({"albedo"});                  // of no surface
    Material m = diffuse({Rgb(0), {}, {}});
    m.invisible = type == "forward";
    return m;
  }
  bsdf.ignore_all();
  bsdf.lose(
      fmt::format("surfaces of type \"{}\" are not read: Lambertian of their albedo in their place",
                  shown(type, 40)));
  return diffuse(albedo(bsdf));
}

Material Surfaces::read(const Node& bsdf, int depth) {
  if (!bsdf.is_object()) bsdf.fail("is no surface: neither a name nor an object");
  const std::string type = bsdf.text("type", "");
  Material m = of_type(type, bsdf, depth);
  if (const auto bump = bsdf.find("bump"); bump && !bump->is_number()) {
    const Number heights = number(*bump);
    m.bump = heights.texture;
    m.bump_scale = heights.factor;
  }
  bsdf.ignore({"name"});
  return m;
}

size_t Surfaces::material(const std::optional<Node>& bsdf) {
  if (!bsdf) {
    if (!plain_) {
      scene_.materials.push_back(diffuse({Rgb(0.8f), {}, {}}));
      scene_.materials.back().name = "default";
      plain_ = scene_.materials.size() - 1;
    }
    return *plain_;
  }
  if (bsdf->is_array()) {
    if (bsdf->json().empty()) bsdf->fail("is an empty array");
    if (bsdf->json().size() > 1) bsdf->lose("of several surfaces of a mesh the first is taken");
    return material(bsdf->item(0));
  }
  if (!bsdf->is_string()) {
    scene_.materials.push_back(read(*bsdf, 0));
    scene_.materials.back().name = bsdf->text("name", bsdf->text("type", ""));
    return scene_.materials.size() - 1;
  }
  const std::string name = bsdf->text();
  const auto it = made_.find(name);
  if (it != made_.end()) return it->second;
  scene_.materials.push_back(read_nested(*bsdf, 0));
  scene_.materials.back().name = name;
  return made_[name] = scene_.materials.size() - 1;
}

}  // namespace tdpt::foreign::tungsten
