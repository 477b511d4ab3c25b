
#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/tungsten/context.h"

namespace tdpt::foreign::tungsten {
namespace {

constexpr int kDeepest = 16;  // nested surfaces

Rgb rgb(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

float mean(const Rgb& c) {
  return (c.x + c.y + c.z) / 3;
}

void lose_absorption(const Node& bsdf) {
  const Vec3d absorbed = bsdf.vector("sigma_a", Vec3d(0)) * bsdf.number("thickness", 1);
  if (max_component(absorbed) > 0)
    bsdf.lose("absorption (sigma_a) in coats and sheets is left out");
}

// Index of the image in the file that a text names, once for each name.
size_t image(Context& in, const Node& node) {
  const std::string name = node.text();
  const auto it = in.images.find(name);
  if (it != in.images.end()) return it->second;
  in.scene.images.push_back({name, node.source().read_picture(name, node.place())});
  return in.images[name] = in.scene.images.size() - 1;
}

Material read(Context& in, const Node& bsdf, int depth);

Texture checker(Context& in, const Node& node) {
  const Rgb on = rgb(node.vector("on_color", Vec3d(0.8)));
  const Rgb off = rgb(node.vector("off_color", Vec3d(0.2)));
  const double u = node.number("res_u", 20), v = node.number("res_v", 20);
  // Squares count from the lower left corner of the image, where the first is off.
  in.scene.images.push_back({"checker", {}, 2, 2, {on, off, off, on}});
  Texture t;
  t.image = in.scene.images.size() - 1;
  t.nearest = true;
  t.map = {u / 2, 0, 0, 0, v / 2, 1 - v / 2};
  return t;
}

Number number(Context& in, const Node& node) {
  const Colour c = colour(in, node);
  Number n{mean(c.factor), c.texture, {}};
  if (n.texture) n.texture->srgb = false;  // whatever gamma_correct says
  return n;
}

Colour albedo(Context& in, const Node& bsdf) {
  const auto a = bsdf.find("albedo");
  return a ? colour(in, *a) : Colour{};
}

Number roughness(Context& in, const Node& bsdf, double otherwise) {
  const std::string distribution = bsdf.text("distribution", "ggx");
  if (distribution != "ggx")
    bsdf.lose("microfacets of type \"{}\" become GGX", shown(distribution, 40));
  const auto r = bsdf.find("roughness");
  return r ? number(in, *r) : Number{static_cast<float>(otherwise), {}, {}};
}

Material conductor_of(Context& in, const Node& bsdf, const Number& alpha) {
  if (const std::string lost = lost_of_rough_metal(alpha); !lost.empty()) bsdf.lose("{}", lost);
  const auto name = bsdf.find("material"), eta = bsdf.find("eta"), k = bsdf.find("k");
  const auto known = conductor_named(name ? name->text() : "Cu");
  if (!known)
    bsdf.lose("the metal \"{}\" is not known: aluminium in its place", shown(name->text(), 40));
  auto [n, kappa] = known ? *known : *conductor_named("Al");
  if (!name && eta) {  // a material prevails; without eta, Tungsten does not read k
    n = rgb(eta->vector());
    if (k) kappa = rgb(k->vector());
  }
  return conductor(n, kappa, albedo(in, bsdf), alpha);
}

Material read_nested(Context& in, const Node& bsdf, int depth) {
  if (depth > kDeepest) bsdf.fail("is nested too deeply, or within itself");
  if (!bsdf.is_string()) return read(in, bsdf, depth);
  const std::string name = bsdf.text();
  const auto it = in.named_surfaces.find(name);
  if (it == in.named_surfaces.end() && (name == "null" || name == "NULL"))
    return diffuse({Rgb(0), {}, {}});
  if (it == in.named_surfaces.end()) bsdf.fail("\"{}\" is no surface of the scene", shown(name));
  return read(in, it->second, depth);
}

double ior(const Node& bsdf) {
  const double v = bsdf.number("ior", 1.5);
  if (!(v > 0.1 && v < 100)) bsdf.fail("has an index of refraction of {}", v);
  if (v >= 1) return v;
  bsdf.lose("an index of refraction below 1 becomes its inverse");
  return 1 / v;
}

Material of_type(Context& in, const std::string& type, const Node& bsdf, int depth) {
  const auto lose_as = [&](const char* what) {
    bsdf.lose("surfaces of type \"{}\" become {}", shown(type, 40), what);
  };
  const auto inner = [&](const char* key) { return read_nested(in, bsdf.needed(key), depth + 1); };
  const bool is_rough = type.starts_with("rough_");
  const std::string kind = is_rough ? type.substr(6) : type;
  const Number alpha = is_rough
                           ? roughness(in, bsdf, kind == "plastic" || kind == "coat" ? 0.02 : 0.1)
                           : Number{0.0f, {}, {}};
  if (kind == "lambert") return diffuse(albedo(in, bsdf));
  if (kind == "mirror") return mirror(albedo(in, bsdf));
  if (kind == "conductor") return conductor_of(in, bsdf, alpha);
  if (kind == "plastic" || kind == "thinsheet") {
    lose_absorption(bsdf);
    return kind == "plastic" ? plastic(albedo(in, bsdf), ior(bsdf), alpha, true)
                             : glass(ior(bsdf), albedo(in, bsdf), alpha, false);
  }
  if (kind == "dielectric") {
    if (!bsdf.flag("enable_refraction", true))
      bsdf.lose("glass that only reflects (enable_refraction) refracts");
    return glass(ior(bsdf), albedo(in, bsdf), alpha, true);
  }
  if (kind == "transparency") {
    Material m = inner("base");
    bsdf.ignore({"albedo"});  // the base's counts
    if (const auto opacity = bsdf.find("alpha")) m.opacity = number(in, *opacity);
    if (m.opacity.texture) m.opacity.texture->alpha = true;
    return m;
  }
  if (kind == "smooth_coat" || kind == "coat") {
    lose_as("a clear coat of index 1.5");
    lose_absorption(bsdf);
    if (alpha.texture) bsdf.lose("the texture of a coat's roughness is left out");
    bsdf.ignore({"albedo", "ior"});  // the substrate's counts; named
    Material m = inner("substrate");
    m.coat = 1;
    m.coat_roughness = std::sqrt(alpha.texture ? 0.1f : std::clamp(alpha.factor, 0.0f, 1.0f));
    return m;
  }
  if (kind == "mixed") {
    lose_as("the heavier of the two");
    bsdf.ignore({"bsdf0", "bsdf1"});
    if (const Colour all = albedo(in, bsdf); all.texture || mean(all.factor) != 1)
      bsdf.lose("the albedo of mixed surfaces, which multiplies both, is left out");
    const auto share = bsdf.find("ratio");
    return inner(!share || number(in, *share).factor >= 0.5f ? "bsdf0" : "bsdf1");
  }
  if (kind == "null" || kind == "forward") {  // absorbs all light; lets all pass
    bsdf.ignore({"albedo"});                  // of no surface
    Material m = diffuse({Rgb(0), {}, {}});
    m.invisible = kind == "forward";
    return m;
  }
  lose_as("Lambertian");
  bsdf.ignore();
  return diffuse(albedo(in, bsdf));
}

Material read(Context& in, const Node& bsdf, int depth) {
  if (!bsdf.is_object()) bsdf.fail("is no surface: neither a name nor an object");
  const std::string type = bsdf.text("type", "");
  Material m = of_type(in, type, bsdf, depth);
  if (const auto bump = bsdf.find("bump"); bump && !bump->is_number()) {
    const Number heights = number(in, *bump);
    m.bump = heights.texture;
    m.bump_scale = heights.factor;
  }
  bsdf.ignore({"name"});
  return m;
}

}  // namespace

void name_surfaces(Context& in, const Node& bsdfs) {
  if (!bsdfs.is_array()) bsdfs.fail("is no array");
  for (size_t i = 0; i < bsdfs.json().size(); ++i) {
    const Node bsdf = bsdfs.item(i);
    if (!bsdf.is_object()) bsdf.fail("is no object");
    // Not asked for: a surface that nobody uses stays unread.
    const Json name = bsdf.json().value("name", Json());
    if (name.is_string()) in.named_surfaces.emplace(name, bsdf);  // of two, the first counts
  }
}

Colour colour(Context& in, const Node& node) {
  if (node.is_number() || node.is_array()) return {rgb(node.vector()), {}, {}};
  if (!node.is_string() && !node.is_object())
    node.fail("is no texture: neither number, colour, file nor object");
  const std::string type = node.is_string() ? "" : node.text("type", "");
  if (type == "checker") return {Rgb(1), checker(in, node), {}};
  if (type == "constant") return {rgb(node.vector("value", Vec3d(1))), {}, {}};
  if (!node.is_string() && type != "bitmap") {
    node.lose("textures of type \"{}\" are not read: grey of 0.5 in their place", shown(type, 40));
    node.ignore();
    return {Rgb(0.5f), {}, {}};
  }
  Colour c{Rgb(1), Texture{}, {}};
  Texture& t = *c.texture;
  t.image = image(in, node.is_string() ? node : node.needed("file"));
  if (node.is_string()) return c;
  t.srgb = node.flag("gamma_correct", true);
  t.nearest = !node.flag("interpolate", true);
  if (node.flag("clamp", false)) t.wrap_u = t.wrap_v = Texture::Wrap::clamp;
  const double scale = node.number("scale", 1);
  if (!t.nearest) c.factor = Rgb(static_cast<float>(scale));  // as in Tungsten
  return c;
}

size_t material(Context& in, const std::optional<Node>& bsdf) {
  if (bsdf && bsdf->is_array()) {
    if (bsdf->json().empty()) bsdf->fail("is an empty array");
    if (bsdf->json().size() > 1) bsdf->lose("of several surfaces of a mesh the first is taken");
    return material(in, bsdf->item(0));
  }
  const bool is_shared = !bsdf || bsdf->is_string();
  const std::string key = !bsdf ? "" : is_shared ? "=" + bsdf->text() : "";
  if (is_shared)
    if (const auto it = in.materials.find(key); it != in.materials.end()) return it->second;
  Material m = bsdf ? read_nested(in, *bsdf, 0) : diffuse({Rgb(0.8f), {}, {}});
  m.name = !bsdf       ? "default"
           : is_shared ? bsdf->text()
                       : bsdf->text("name", bsdf->text("type", ""));
  in.scene.materials.push_back(std::move(m));
  const size_t index = in.scene.materials.size() - 1;
  if (is_shared) in.materials[key] = index;
  return index;
}

}  // namespace tdpt::foreign::tungsten
