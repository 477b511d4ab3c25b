#include "tools/tdpt-import/tungsten/surfaces.h"

#include <fmt/format.h>

#include "libcommon/base/shown.h"
#include "tools/tdpt-import/materials.h"

namespace tdpt::foreign::tungsten {
namespace {

constexpr int kDeepest = 16;  // nested surfaces

Rgb rgb(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

float mean(const Rgb& c) {
  return (c.x + c.y + c.z) / 3;
}

}  // namespace

Surfaces::Surfaces(Described& scene, const std::optional<Node>& bsdfs) : scene_(scene) {
  if (!bsdfs) return;
  if (!bsdfs->is_array()) bsdfs->fail("is no array");
  for (size_t i = 0; i < bsdfs->json().size(); ++i) {
    const Node bsdf = bsdfs->item(i);
    if (const std::string name = bsdf.text("name", ""); !name.empty())
      named_.emplace(name, bsdf);  // of two of a name, the first counts
  }
}

size_t Surfaces::image(const Node& node, const std::string& name) {
  const auto it = images_.find(name);
  if (it != images_.end()) return it->second;
  scene_.images.push_back({name, node.source().read(name, node.place())});
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
    constant = Rgb(static_cast<float>(node.number("scale", 1)));
    node.tell_unread("a bitmap");
    return t;
  }
  if (type == "checker") return checker(node);
  if (type == "constant") {
    constant = rgb(node.vector("value", Vec3d(1)));
    return {};
  }
  node.lose(fmt::format("textures of type \"{}\" are not read: grey of 0.5 in their place",
                        shown(type, 40)));
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
  if (n.texture) n.texture->srgb = n.texture->srgb && !node.is_string();
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
  const auto eta = bsdf.find("eta"), k = bsdf.find("k");
  const std::string name = bsdf.text("material", eta && k ? "" : "Cu");
  if (name.empty()) return conductor(rgb(eta->vector()), rgb(k->vector()), albedo(bsdf), alpha);
  const auto known = conductor_named(name);
  if (!known)
    bsdf.lose("the metal \"" + shown(name, 40) + "\" is not known: aluminium in its place");
  const auto& [n, kappa] = known ? *known : *conductor_named("Al");
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

Material Surfaces::read(const Node& bsdf, int depth) {
  if (!bsdf.is_object()) bsdf.fail("is no surface: neither a name nor an object");
  const std::string type = bsdf.text("type", "");
  const auto ior = [&](double otherwise) {
    const double v = bsdf.number("ior", otherwise);
    if (!(v > 0.1 && v < 100)) bsdf.fail(fmt::format("has an index of refraction of {}", v));
    if (v >= 1) return v;
    bsdf.lose("an index of refraction below 1 becomes its inverse");
    return 1 / v;
  };
  const auto nested = [&](const char* key) {
    const auto inner = bsdf.find(key);
    if (!inner) bsdf.fail(fmt::format("has no \"{}\"", key));
    return read_nested(*inner, depth + 1);
  };
  const auto near_to = [&](const char* what) {
    bsdf.lose(fmt::format("surfaces of type \"{}\" become {}", shown(type, 40), what));
  };
  const Number smooth_alpha{0.0f, {}, {}};

  Material m;
  if (type == "lambert") {
    m = diffuse(albedo(bsdf));
  } else if (type == "oren_nayar") {
    near_to("Lambertian");
    bsdf.ignore({"roughness"});
    m = diffuse(albedo(bsdf));
  } else if (type == "null") {
    bsdf.ignore({"albedo"});
    m = diffuse({Rgb(0), {}, {}});
  } else if (type == "forward") {
    bsdf.ignore({"albedo"});
    m.invisible = true;
  } else if (type == "mirror") {
    m = mirror(albedo(bsdf));
  } else if (type == "conductor") {
    m = conductor_of(bsdf, smooth_alpha);
  } else if (type == "rough_conductor") {
    m = conductor_of(bsdf, roughness(bsdf, 0.1));
  } else if (type == "plastic" || type == "rough_plastic") {
    const Number alpha = type == "plastic" ? smooth_alpha : roughness(bsdf, 0.02);
    m = plastic(albedo(bsdf), ior(1.5), alpha, true);
    const Vec3d absorbed = bsdf.vector("sigma_a", Vec3d(0)) * bsdf.number("thickness", 1);
    if (max_component(absorbed) > 0)
      bsdf.lose("the absorption in the coat of plastics is left out");
  } else if (type == "dielectric" || type == "rough_dielectric") {
    const Number alpha = type == "dielectric" ? smooth_alpha : roughness(bsdf, 0.1);
    m = glass(ior(1.5), albedo(bsdf), alpha, true);
    if (!bsdf.flag("enable_refraction", true))
      bsdf.lose("glass that only reflects (enable_refraction) refracts");
  } else if (type == "thinsheet") {
    m = glass(ior(1.5), albedo(bsdf), smooth_alpha, false);
    if (bsdf.flag("enable_interference", false))
      bsdf.lose("the interference of thin sheets is left out");
    if (max_component(bsdf.vector("sigma_a", Vec3d(0))) > 0)
      bsdf.lose("the absorption of thin sheets is left out");
    bsdf.ignore({"thickness"});
  } else if (type == "transparency") {
    m = nested("base");
    if (const auto alpha = bsdf.find("alpha")) {
      m.opacity = number(*alpha);
      if (m.opacity.texture) m.opacity.texture->alpha = true;
    }
    bsdf.ignore({"albedo"});
  } else if (type == "smooth_coat" || type == "rough_coat") {
    near_to("a clear coat of index 1.5");
    m = nested("substrate");
    m.coat = 1;
    if (type == "rough_coat")
      m.coat_roughness = std::sqrt(std::clamp(roughness(bsdf, 0.02).factor, 0.0f, 1.0f));
    bsdf.ignore({"albedo", "ior", "thickness", "sigma_a"});
  } else if (type == "mixed") {
    near_to("the heavier of the two");
    const auto share = bsdf.find("ratio");
    m = nested(!share || number(*share).factor >= 0.5f ? "bsdf0" : "bsdf1");
    bsdf.ignore({"bsdf0", "bsdf1", "albedo"});
  } else {
    bsdf.lose(
        fmt::format("surfaces of type \"{}\" are not read: Lambertian of their albedo in "
                    "their place",
                    shown(type, 40)));
    m = diffuse(albedo(bsdf));
    return m;
  }
  if (const auto bump = bsdf.find("bump"); bump && !bump->is_number()) {
    Rgb scale;
    m.bump = texture(*bump, scale);
    m.bump_scale = scale.x;
  }
  bsdf.ignore({"name"});
  bsdf.tell_unread("a surface of type \"" + shown(type, 40) + "\"");
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
