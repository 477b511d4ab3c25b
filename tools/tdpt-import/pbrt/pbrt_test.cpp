#include "tools/tdpt-import/described.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "libcommon/testing/files/temp_folder.h"
#include "tools/tdpt-import/materials.h"

namespace tdpt::foreign::pbrt_test {

constexpr double kPi = std::numbers::pi;

const std::string kFilm3 =
    "Film \"image\" \"integer xresolution\" [200] \"integer yresolution\" [100]\n";
const std::string kFilm4 =
    "Film \"rgb\" \"integer xresolution\" [200] \"integer yresolution\" [100]\n";
const std::string kTriangle =
    "Shape \"trianglemesh\" \"integer indices\" [0 1 2] \"point3 P\" [0 0 0 1 0 0 0 1 0]\n";

class scene : public ::testing::Test {
 protected:
  Described read(const std::string& text) {
    const std::string path = folder_.write("a.pbrt", text);
    Source source(path);
    Described d = read_pbrt(source);
    source.lose_unread();
    losses_.clear();
    for (const Source::Loss& loss : source.losses())
      losses_ += loss.first.where + ": " + loss.sentence + "\n";
    return d;
  }
  Described v3(const std::string& world) { return read(kFilm3 + "WorldBegin\n" + world); }
  Described v4(const std::string& world) { return read(kFilm4 + "WorldBegin\n" + world); }
  std::string refusal(const std::string& text) {
    try {
      read(text);
      return "";
    } catch (const InputError& e) {
      return e.what();
    }
  }
  void expect_lost(const std::string& words) const {
    EXPECT_NE(losses_.find(words), std::string::npos) << words << " in\n" << losses_;
  }
  void expect_nothing_lost() const { EXPECT_EQ(losses_, ""); }

  testing::TempFolder folder_;
  std::string losses_;
};

void expect_near(const Vec3d& a, const Vec3d& b, double eps = 1e-6) {
  EXPECT_NEAR(a.x, b.x, eps);
  EXPECT_NEAR(a.y, b.y, eps);
  EXPECT_NEAR(a.z, b.z, eps);
}
void expect_colour(const Rgb& a, const Rgb& b, double eps = 1e-5) {
  expect_near({a.x, a.y, a.z}, {b.x, b.y, b.z}, eps);
}

// Unit normal of the front of a shape's first triangle in the world.
Vec3d front(const Described& d, const Shape& s) {
  const Mesh& m = d.meshes[s.mesh];
  const auto at = [&](size_t k) {
    const Vec3f& p = m.positions[m.triangles[0][k]];
    return s.to_world.point({p.x, p.y, p.z});
  };
  const Vec3d n = normalize(cross(at(1) - at(0), at(2) - at(0)));
  return s.to_world.mirrors() != s.turned ? n * -1.0 : n;
}
Vec3d first_front(const Described& d) {
  return front(d, d.shapes.at(0));
}

// The texel coordinates of glTF at (u, v) of pbrt.
std::array<double, 2> looked_up(const Texture& t, double u, double v) {
  const double x = u, y = 1 - v;
  return {t.map[0] * x + t.map[1] * y + t.map[2], t.map[3] * x + t.map[4] * y + t.map[5]};
}

TEST_F(scene, of_an_empty_world_has_the_default_camera) {
  const Described d = v4("");
  ASSERT_EQ(d.cameras.size(), 1u);
  EXPECT_EQ(d.cameras[0].width, 200);
  EXPECT_EQ(d.cameras[0].height, 100);
  EXPECT_NEAR(d.cameras[0].yfov, kPi / 2, 1e-9);
  expect_near(d.cameras[0].to_world.z, {0, 0, -1});  // looks along +z
  EXPECT_TRUE(d.shapes.empty());
  expect_nothing_lost();
}

TEST_F(scene, has_a_camera_that_looks_where_LookAt_says) {
  const Described d = read("LookAt 1 2 3  1 2 8  0 1 0 Camera \"perspective\" \"float fov\" 60\n" +
                           kFilm4 + "WorldBegin");
  const Camera& c = d.cameras.at(0);
  expect_near(c.to_world.t, {1, 2, 3});
  expect_near(c.to_world.z, {0, 0, -1});
  expect_near(c.to_world.y, {0, 1, 0});
  expect_near(c.to_world.x, {1, 0, 0});  // pbrt is left-handed
  EXPECT_TRUE(c.to_world.mirrors());
  EXPECT_NEAR(c.yfov, kPi / 3, 1e-9);
}

TEST_F(scene, has_a_field_of_view_of_its_shorter_side) {
  const Described d = read(
      "Camera \"perspective\" \"float fov\" [60]\n"
      "Film \"rgb\" \"integer xresolution\" [100] \"integer yresolution\" [200] WorldBegin");
  EXPECT_NEAR(d.cameras.at(0).yfov, 2 * std::atan(2 * std::tan(kPi / 6)), 1e-9);
}

TEST_F(scene, has_a_screen_window_and_crop) {
  const Described d = read(
      "Scale 2 2 2 Camera \"perspective\" \"float fov\" [90] \"float screenwindow\" [-1 3 -1 1]\n"
      "\"float lensradius\" [0.5] \"float focaldistance\" [8]" +
      kFilm4 + "WorldBegin");
  const Camera& c = d.cameras.at(0);
  EXPECT_NEAR(c.yfov, kPi / 2, 1e-9);
  EXPECT_NEAR(c.shift_x, 0.5, 1e-9);
  EXPECT_EQ(c.shift_y, 0);
  EXPECT_NEAR(c.lens_radius, 0.25, 1e-9);
  EXPECT_NEAR(c.focus_distance, 4, 1e-9);
  const Described e = read(
      "Camera \"perspective\" \"float fov\" [90] Film \"image\" \"integer xresolution\" [100]"
      " \"integer yresolution\" [100] \"float cropwindow\" [0 0.5 0 0.5] WorldBegin");
  const Camera& f = e.cameras.at(0);
  EXPECT_EQ(f.width, 50);
  EXPECT_NEAR(std::tan(f.yfov / 2), 0.5, 1e-9);
  EXPECT_NEAR(f.shift_x, -1, 1e-9);
  EXPECT_NEAR(f.shift_y, 1, 1e-9);
}

TEST_F(scene, names_cameras_and_exposures_that_are_lost) {
  const Described d = read("Camera \"orthographic\"\n" + kFilm4 + "WorldBegin");
  EXPECT_TRUE(d.cameras.empty());
  expect_lost("line 1: the camera \"orthographic\"");
  read("Film \"rgb\" \"float iso\" [200] WorldBegin");
  expect_lost("which multiplies the picture by 2");
  read("Film \"image\" \"float scale\" [3] WorldBegin");
  expect_lost("which multiplies the picture by 3");
}

TEST_F(scene, has_triangles_with_the_front_of_their_corners) {
  expect_near(first_front(v4(kTriangle)), {0, 0, 1});
  expect_near(first_front(v4("ReverseOrientation " + kTriangle)), {0, 0, -1});
  // The transformation mirrors; pbrt turns the normal back.
  expect_near(first_front(v4("Scale 1 1 -1 " + kTriangle)), {0, 0, -1});
  expect_near(first_front(v4("Scale -1 1 1 " + kTriangle)), {0, 0, 1});
  expect_near(first_front(v4("Scale -1 1 1 ReverseOrientation " + kTriangle)), {0, 0, -1});
}

TEST_F(scene, has_triangles_with_the_front_of_their_normals) {
  const std::string n = "\"normal N\" [0 0 -1 0 0 -1 0 0 -1]\n";
  const Described d = v4(kTriangle + n);
  expect_near(first_front(d), {0, 0, -1});
  EXPECT_EQ(d.meshes[0].normals.size(), 3u);
  expect_near(first_front(v4("ReverseOrientation " + kTriangle + n)), {0, 0, 1});
  expect_near(first_front(v4("Scale -1 1 1 " + kTriangle + n)), {0, 0, -1});
}

TEST_F(scene, has_quadrics_with_pbrts_fronts) {
  const Described d = v4("Shape \"disk\" \"float radius\" [2] \"float height\" [3]");
  expect_near(first_front(d), {0, 0, 1});
  expect_near(d.shapes[0].to_world.t, {0, 0, 3});
  expect_near(d.shapes[0].to_world.x, {2, 0, 0});
  const Described c = v4("Shape \"cylinder\" \"float zmin\" [-2] \"float zmax\" [4]");
  expect_near(c.shapes[0].to_world.t, {0, 0, -2});
  expect_near(c.shapes[0].to_world.z, {0, 0, 6});
  const Described s = v4("Shape \"sphere\" Shape \"sphere\" \"float zmax\" [0.5]");
  EXPECT_EQ(s.meshes.size(), 1u);
  expect_lost("a \"sphere\" of which parts are cut away becomes whole");
}

TEST_F(scene, has_bilinear_patches_of_two_triangles) {
  const Described d = v4("Shape \"bilinearmesh\" \"point3 P\" [0 0 0  1 0 0  0 1 0  1 1 0]");
  expect_near(first_front(d), {0, 0, 1});
  ASSERT_EQ(d.meshes[0].triangles.size(), 2u);
  EXPECT_EQ(d.meshes[0].uv[2][1], 0);  // p01 is at v = 1, the top of an image
}

TEST_F(scene, has_texture_coordinates_that_grow_downwards) {
  const Described d = v4(kTriangle + "\"point2 uv\" [0 0 1 0 0 0.75]");
  EXPECT_EQ(d.meshes[0].uv[0][1], 1);
  EXPECT_EQ(d.meshes[0].uv[2][1], 0.25);
  EXPECT_EQ(v3(kTriangle + "\"float st\" [0 0 1 0 0 0.75]").meshes[0].uv[2][1], 0.25);
}

TEST_F(scene, reads_meshes_of_files_once_also_compressed) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty float u\nproperty float v\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 0.75\n"
      "3 0 1 2\n";
  folder_.write("b.ply", ply);
  const Described d =
      v4("Shape \"plymesh\" \"string filename\" \"b.ply\"\nTranslate 1 0 0 "
         "Shape \"plymesh\" \"string filename\" \"b.ply\"");
  EXPECT_EQ(d.meshes.size(), 1u);
  EXPECT_EQ(d.shapes.at(1).name, "b");
  expect_near(first_front(d), {0, 0, 1});
  EXPECT_EQ(d.meshes[0].uv[2][1], 0.25);

  z_stream z{};
  ASSERT_EQ(deflateInit2(&z, 9, Z_DEFLATED, 31, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string packed(ply.size() + 100, 0);
  std::string bytes = ply;
  z.next_in = reinterpret_cast<Bytef*>(bytes.data());
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(packed.data());
  z.avail_out = static_cast<uInt>(packed.size());
  ASSERT_EQ(deflate(&z, Z_FINISH), Z_STREAM_END);
  packed.resize(z.total_out);
  deflateEnd(&z);
  folder_.write("c.ply.gz", packed);
  const std::string of_c = "Shape \"plymesh\" \"string filename\" \"c.ply.gz\"";
  EXPECT_EQ(v4(of_c).meshes.at(0).positions.size(), 3u);
  folder_.write("c.ply.gz", packed.substr(0, packed.size() / 2));
  EXPECT_NE(refusal(kFilm4 + "WorldBegin " + of_c).find("compressed data end early"),
            std::string::npos);
}

TEST_F(scene, places_instances_of_objects) {
  const Described d =
      v4("ObjectBegin \"o\" Translate 1 0 0 AreaLightSource \"diffuse\" " + kTriangle +
         "ObjectEnd\nScale 2 2 2 ObjectInstance \"o\" Translate 0 1 0 ObjectInstance \"o\"");
  ASSERT_EQ(d.shapes.size(), 2u);
  EXPECT_EQ(d.meshes.size(), 1u);
  expect_near(d.shapes[0].to_world.t, {2, 0, 0});
  expect_near(d.shapes[1].to_world.t, {2, 2, 0});
  EXPECT_FALSE(d.shapes[0].emission);
  expect_lost("the light of shapes of an object with instances");
}

TEST_F(scene, has_lights_of_its_version) {
  const std::string point = "Scale 2 2 2 LightSource \"point\" \"rgb I\" [1 2 3]";
  const Described a = v3(point + "\"point from\" [1 0 0] \"rgb scale\" [2 2 2]");
  expect_near(a.lamps.at(0).at, {1, 0, 0});  // pbrt-v3 moves afterwards
  expect_colour(a.lamps[0].intensity, {2, 4, 6});
  const Described b = v4(point + "\"point3 from\" [1 0 0] \"float scale\" [2]");
  expect_near(b.lamps.at(0).at, {2, 0, 0});
  expect_colour(b.lamps[0].intensity, {2, 4, 6});
  const Described c = v4("LightSource \"point\" \"float power\" [10]");
  expect_colour(c.lamps.at(0).intensity, Rgb(static_cast<float>(10 / (4 * kPi))));
}

TEST_F(scene, has_spectra_of_lights_of_its_version) {
  const auto intensity = [](const Described& d) { return d.lamps.at(0).intensity; };
  const std::string light = "LightSource \"point\" ";
  EXPECT_NEAR(luminance(intensity(v4(light + "\"blackbody I\" [3000]"))), 1, 1e-3);
  EXPECT_NEAR(luminance(intensity(v4(light + "\"spectrum I\" [400 5 700 5]"))), 1, 1e-3);
  expect_colour(intensity(v4(light + "\"spectrum I\" \"stdillum-D65\"")), Rgb(1));
  // A black body's spectrum with its maximum, at 966 nm, at 1: little of it is visible.
  const float y = luminance(intensity(v3(light + "\"blackbody I\" [3000 1]")));
  EXPECT_NEAR(y, 0.416, 0.003);
  EXPECT_NEAR(luminance(intensity(v3(light + "\"blackbody I\" [3000 2]"))), 2 * y, 1e-3);
  // Equal energy is not white in pbrt-v3.
  expect_colour(intensity(v3(light + "\"spectrum I\" [400 1 700 1]")), rgb_of_xyz(Rgb(1)), 1e-3);
  expect_colour(intensity(v3(light + "\"xyz I\" [0.9505 1 1.089]")), Rgb(1), 2e-3);
}

TEST_F(scene, has_spots_and_suns) {
  const Described d =
      v4("LightSource \"spot\" \"point3 from\" [0 0 1] \"point3 to\" [0 0 0] \"float coneangle\" "
         "[40]\n"
         "\"float conedeltaangle\" [10] LightSource \"distant\" \"rgb L\" [2 2 2] \"float "
         "illuminance\""
         " [3] \"point3 from\" [0 1 0] \"point3 to\" [0 0 0]");
  const Lamp &spot = d.lamps.at(0), &sun = d.lamps.at(1);
  expect_near(spot.towards, {0, 0, -1});
  EXPECT_NEAR(spot.outer, 40 * kPi / 180, 1e-9);
  EXPECT_NEAR(spot.inner, 30 * kPi / 180, 1e-9);
  EXPECT_EQ(sun.kind, Lamp::Kind::sun);
  expect_near(sun.towards, {0, -1, 0});
  expect_colour(sun.intensity, Rgb(6));
  expect_lost("the course of a spot's intensity");
}

TEST_F(scene, has_skies_in_the_frames_of_their_images) {
  folder_.write("sky.pfm", "PF\n2 1\n-1.0\n" + std::string(24, '\0'));
  const Described a = v3("LightSource \"infinite\" \"string mapname\" \"sky.pfm\"");
  const auto uv = [](const Vec3d& d) {
    return std::array<double, 2>{0.5 + std::atan2(d.x, -d.z) / (2 * kPi), std::acos(d.y) / kPi};
  };
  // pbrt-v3: u = phi / 2 pi from +x towards +y, v from +z.
  const auto east = uv(a.sky->to_map.vector({std::cos(1.0), std::sin(1.0), 0}));
  EXPECT_NEAR(east[0], 1 / (2 * kPi), 1e-9);
  EXPECT_NEAR(east[1], 0.5, 1e-9);
  EXPECT_NEAR(uv(a.sky->to_map.vector({0, 0, 1}))[1], 0, 1e-6);
  EXPECT_TRUE(a.sky->image);
  const Described b = v4("Rotate 90 0 0 1 LightSource \"infinite\" \"rgb L\" [1 2 3]");
  EXPECT_EQ(b.sky->layout, Sky::Layout::octahedral);
  expect_near(b.sky->to_map.vector({0, 1, 0}), {1, 0, 0});
  expect_colour(b.sky->colour, {1, 2, 3});
  expect_near(v4("Scale 3 3 3 Rotate 90 0 0 1 LightSource \"infinite\"").sky->to_map.y, {1, 0, 0});
  expect_nothing_lost();
  expect_near(v4("Scale 3 3 2 LightSource \"infinite\"").sky->to_map.z, {0, 0, 1});
  expect_lost("a sky that is stretched or sheared is not turned");
  expect_colour(v4("LightSource \"infinite\" \"float illuminance\" [3.1415927]").sky->colour,
                Rgb(1));
}

// One sky behind all windows, whatever the transformation: portals stand in the world.
TEST_F(scene, has_one_sky_behind_its_portals) {
  const auto light = [](double x, const char* radiance = "1 1 1") {
    return fmt::format(
        "AttributeBegin Translate 7 0 0 LightSource \"infinite\" \"rgb L\" [{}] \"point3 portal\" "
        "[{} 1 -1  {} 1 1  {} 2 1  {} 2 -1] AttributeEnd\n",
        radiance, x, x, x, x);
  };
  const Described one = v4(light(-3)), three = v4(light(-3) + light(3) + light(2));
  for (const Described* d : {&one, &three}) expect_colour(d->sky->colour, Rgb(1));
  expect_lost("by these alone, here by every opening");
  ASSERT_EQ(three.portals.size(), 3u);
  ASSERT_EQ(one.portals.size(), 1u);
  const Mesh& m = one.meshes[one.portals[0].mesh];
  EXPECT_EQ(m.positions[2], Vec3f(-3, 2, 1));
  const auto edge = [&](size_t i) {
    const Vec3f e = m.positions[i] - m.positions[0];
    return Vec3d(e.x, e.y, e.z);
  };
  // pbrt's z leads out: p03 x p01 = y x z.
  EXPECT_NEAR(dot(cross(edge(1), edge(2)), cross(edge(1), edge(3))), 4, 1e-6);
  EXPECT_LT(cross(edge(1), edge(3)).x, 0);
  // As pbrt scales one colour behind a portal: by 2 pi L.
  expect_colour(v4("LightSource \"infinite\" \"rgb L\" [2 2 2] \"float illuminance\" [6.2831853] "
                   "\"point3 portal\" [0 0 0 1 0 0 1 1 0 0 1 0]")
                    .sky->colour,
                Rgb(1));
  // Another light elsewhere is added, another one behind a portal is not.
  const std::string plain = "LightSource \"infinite\" \"rgb L\" [2 2 2]\n";
  expect_colour(v4(plain + light(3) + light(2)).sky->colour, Rgb(3));
  expect_colour(v4(light(3) + light(2, "5 5 5")).sky->colour, Rgb(1));
  expect_lost("all portals lead to the sky of the first one");
  EXPECT_NE(refusal(kFilm4 + "WorldBegin LightSource \"infinite\" \"rgb L\" [1 1 1] "
                             "\"point3 portal\" [0 0 0 1 0 0 0 1 0]")
                .find("a portal of 3 corners, expected 4"),
            std::string::npos);
}

TEST_F(scene, has_emitters_with_their_power) {
  const Described d =
      v4("AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] \"float scale\" [2]" + kTriangle);
  expect_colour(d.shapes.at(0).emission->radiance.factor, {2, 4, 6});
  EXPECT_FALSE(d.shapes[0].emission->both_sides);
  // The triangle has an area of 1/2.
  const Described e =
      v4("AreaLightSource \"diffuse\" \"float power\" [3] \"bool twosided\" true\n" + kTriangle);
  expect_colour(e.shapes.at(0).emission->radiance.factor, Rgb(static_cast<float>(3 / kPi)));
  EXPECT_TRUE(e.shapes[0].emission->both_sides);
  const Described f = v3("AttributeBegin AreaLightSource \"diffuse\" AttributeEnd " + kTriangle);
  EXPECT_FALSE(f.shapes.at(0).emission);
}

TEST_F(scene, has_materials_of_pbrt_v3) {
  const auto made = [&](const std::string& text) {
    return v3("Material " + text + "\n" + kTriangle).materials.at(0);
  };
  expect_colour(made("\"matte\" \"rgb Kd\" [.1 .2 .3]").base.factor, {.1f, .2f, .3f});
  expect_nothing_lost();
  made("\"matte\" \"float sigma\" [20]");
  expect_lost("\"float sigma\" of Material \"matte\" is not read");
  made("\"matte\" \"float sigma\" [0]");
  expect_nothing_lost();
  const Material p = made(
      "\"plastic\" \"rgb Kd\" [.5 .5 .5] \"rgb Ks\" [.5 .25 .5] \"float roughness\" "
      "[0.04] \"bool remaproughness\" \"false\"");
  EXPECT_NEAR(p.specular, 0.5, 1e-6);
  expect_colour(p.specular_colour, {1, .5f, 1});
  EXPECT_NEAR(p.roughness.factor, 0.2, 1e-6);
  // What the interface reflects does not dim Kd.
  EXPECT_NEAR(p.base.factor.x * (1 - 0.5 * diffuse_fresnel(1.5)), 0.5, 1e-4);
  // alpha(0.1) by pbrt's polynomial: 1.62142 + .819955 x + .1734 x^2 + .0171201 x^3 + .000640711
  // x^4
  EXPECT_NEAR(std::pow(made("\"plastic\"").roughness.factor, 2), 0.46178, 1e-4);
  const Material g = made("\"glass\" \"rgb Kt\" [.5 .6 .7] \"float index\" [1.4]");
  EXPECT_EQ(g.transmission, 1);
  EXPECT_TRUE(g.solid);
  EXPECT_NEAR(g.ior, 1.4, 1e-6);
  expect_colour(g.base.factor, {.5f, .6f, .7f});
  const Material m = made("\"metal\" \"bool remaproughness\" \"false\"");
  ASSERT_TRUE(m.eta_k);
  expect_colour((*m.eta_k)[0], (*conductor_named("Cu"))[0]);
  EXPECT_NEAR(m.roughness.factor, 0.1, 1e-6);
  EXPECT_EQ(made("\"mirror\"").metallic, 1);
  EXPECT_TRUE(made("\"\"").invisible);
  EXPECT_NEAR(made("\"uber\" \"rgb opacity\" [.5 .5 .5]").opacity.factor, 0.5, 1e-6);
}

// Brighter than under glTF's interface, and glass coloured at both sides.
TEST_F(scene, has_disneys_material) {
  const auto base = [&](const std::string& list) {
    const Described d =
        v3("Material \"disney\" \"rgb color\" [0.25 0.25 0.25] " + list + " Shape \"sphere\"");
    return d.materials.at(d.shapes.at(0).material).base.factor.x;
  };
  EXPECT_GT(base(""), 0.255f);
  EXPECT_LT(base(""), 0.29f);
  expect_lost("up to a tenth more or less by direction");
  EXPECT_NEAR(base("\"float spectrans\" [1]"), 0.5, 1e-6);
  expect_nothing_lost();
  EXPECT_NEAR(base("\"float metallic\" [1] \"float roughness\" [0.1]"), 0.25, 0.01);
  expect_nothing_lost();
}

// What comes out of a base of 0.9 below a layer of 0.1, by integration over all angles: 0.4007 of
// the light that falls on it, where the interface reflects 0.0918.
TEST_F(scene, dims_a_base_below_an_absorbing_layer) {
  const auto base = [&](const std::string& text) {
    return v4("Material \"coateddiffuse\" \"rgb reflectance\" [.9 .9 .9] " + text + kTriangle)
        .materials.at(0)
        .base.factor.x;
  };
  EXPECT_NEAR(base("\"float thickness\" [0.1]"), 0.4007 / (1 - 0.0918), 1e-3);
  EXPECT_NEAR(base("\"float thickness\" [1]"), 0.0347 / (1 - 0.0918), 1e-3);
  EXPECT_NEAR(base("\"float thickness\" [0]"), 0.7122 / (1 - 0.0918), 1e-3);
  EXPECT_NEAR(base("\"float thickness\" [0] \"float eta\" [1]"), 0.9, 1e-6);
  expect_nothing_lost();
}

// pbrt-v3 takes the luminance of texels and then decodes it; it never decodes those of skies.
// pbrt-v4 prefers alpha, in whatever format.
TEST_F(scene, takes_numbers_of_pictures_as_its_version_does) {
  const std::string header("\0\0\x02\0\0\0\0\0\0\0\0\0\x01\0\x01\0", 16);
  folder_.write("red.tga", header + std::string("\x18\x20\0\0\xff", 5));
  folder_.write("half.tga", header + std::string("\x20\x28\0\0\xff\x80", 6));
  const auto roughness = [&](bool is_v4, const std::string& file) {
    const std::string text = "Texture \"r\" \"float\" \"imagemap\" \"string filename\" \"" + file +
                             "\" Material \"" + (is_v4 ? "conductor" : "metal") +
                             "\" \"texture roughness\" \"r\" \"bool remaproughness\" \"false\"\n" +
                             kTriangle;
    return (is_v4 ? v4(text) : v3(text)).materials.at(0).roughness;
  };
  const Number of_v3 = roughness(false, "red.tga");
  EXPECT_TRUE(of_v3.texture->luminance);
  EXPECT_FALSE(of_v3.texture->srgb);
  EXPECT_NEAR(of_v3.curve(0.5f), std::sqrt(0.2159f), 2e-3);  // alpha's root, decoded
  EXPECT_TRUE(roughness(true, "half.tga").texture->alpha);
  EXPECT_FALSE(roughness(true, "red.tga").texture->alpha);
  EXPECT_FALSE(v3("LightSource \"infinite\" \"string mapname\" \"red.tga\"").sky->srgb);
  EXPECT_TRUE(v4("LightSource \"infinite\" \"string filename\" \"red.tga\"").sky->srgb);
}

TEST_F(scene, has_materials_of_pbrt_v4) {
  const auto made = [&](const std::string& text) {
    return v4("Material " + text + "\n" + kTriangle).materials.at(0);
  };
  const Material c = made("\"coateddiffuse\" \"float roughness\" [0.25] \"float thickness\" [0]");
  EXPECT_NEAR(c.roughness.factor, std::sqrt(0.5), 1e-6);  // alpha = sqrt(roughness)
  EXPECT_EQ(c.specular, 1);
  const Material m =
      made("\"conductor\" \"spectrum eta\" \"metal-Al-eta\" \"spectrum k\" \"metal-Al-k\"");
  expect_colour((*m.eta_k)[1], (*conductor_named("Al"))[1]);
  EXPECT_EQ(m.roughness.factor, 0);
  expect_colour(made("\"conductor\" \"rgb reflectance\" [.1 .2 .3]").base.factor, {.1f, .2f, .3f});
  EXPECT_NEAR(made("\"dielectric\" \"spectrum eta\" \"glass-BK7\"").ior, 1.5168, 1e-4);
  EXPECT_FALSE(made("\"thindielectric\"").solid);
  EXPECT_TRUE(made("\"interface\"").invisible);
  expect_nothing_lost();
  made("\"dielectric\" \"float uroughness\" [0.1] \"float vroughness\" [0.4]");
  expect_lost("different roughness along u and v");
  made("\"diffuse\" \"float foo\" [1]");
  expect_lost("\"float foo\" of Material \"diffuse\" is not read");
}

TEST_F(scene, turns_bodies_that_are_thinner_than_their_outside) {
  const Described d = v4("Material \"dielectric\" \"float eta\" [0.5]" + kTriangle);
  EXPECT_NEAR(d.materials.at(0).ior, 2, 1e-6);
  expect_near(first_front(d), {0, 0, -1});
}

TEST_F(scene, keeps_absorbing_media_within_glass) {
  const Described d =
      v4("MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [0 1 2] \"rgb "
         "sigma_s\" "
         "[0 0 0] \"float scale\" [2] MediumInterface \"m\" \"\" Material \"dielectric\"" +
         kTriangle);
  expect_colour(d.materials.at(0).attenuation, {1, std::exp(-2.0f), std::exp(-4.0f)});
  expect_nothing_lost();
}

TEST_F(scene, names_materials_textures_and_mixtures) {
  const Described d =
      v4("Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [.1 .2 .3]\n"
         "Texture \"s\" \"spectrum\" \"scale\" \"texture tex\" \"t\" \"float scale\" [2]\n"
         "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"texture reflectance\" \"s\"\n"
         "MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
         "MakeNamedMaterial \"c\" \"string type\" \"mix\" \"string materials\" [\"a\" \"b\"]\n"
         "\"float amount\" [0.75] NamedMaterial \"a\"" +
         kTriangle + "NamedMaterial \"c\"" + kTriangle);
  ASSERT_EQ(d.materials.size(), 2u);
  EXPECT_EQ(d.materials[0].name, "a");
  expect_colour(d.materials[0].base.factor, {.2f, .4f, .6f});
  expect_colour(d.materials[1].base.factor, {.05f, .1f, .15f});
  expect_lost("two materials become one");
}

TEST_F(scene, looks_images_up_as_pbrt_does) {
  folder_.write("i.ppm", "P6 1 1 255\nabc");
  const Described d = v4(
      "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"i.ppm\" \"float uscale\" [2]\n"
      "\"float vscale\" [3] \"float udelta\" [0.1] \"float vdelta\" [0.2] \"string wrap\" "
      "\"clamp\"\n"
      "\"float scale\" [0.5] \"string filter\" \"point\"\n"
      "Material \"diffuse\" \"texture reflectance\" \"t\"" +
      kTriangle);
  const Material& m = d.materials.at(0);
  ASSERT_TRUE(m.base.texture);
  const auto at = looked_up(*m.base.texture, 0.3, 0.1);
  EXPECT_NEAR(at[0], 2 * 0.3 + 0.1, 1e-9);
  EXPECT_NEAR(at[1], 1 - (3 * 0.1 + 0.2), 1e-9);
  EXPECT_EQ(m.base.texture->wrap_u, Texture::Wrap::clamp);
  EXPECT_TRUE(m.base.texture->nearest);
  EXPECT_TRUE(m.base.texture->srgb);
  expect_colour(m.base.factor, Rgb(0.5f));
  expect_nothing_lost();
}

TEST_F(scene, has_checkerboards_as_images) {
  const Described d =
      v4("Texture \"t\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [1 0 0] \"rgb tex2\" [0 0 1]\n"
         "\"float uscale\" [4] \"float vscale\" [4]\n"
         "Material \"diffuse\" \"texture reflectance\" \"t\"" +
         kTriangle);
  const Texture& t = *d.materials.at(0).base.texture;
  const Image& image = d.images.at(t.image);
  const auto colour = [&](double u, double v) {
    const auto at = looked_up(t, u, v);
    const auto texel = [](double x) { return static_cast<size_t>(2 * (x - std::floor(x))); };
    return image.texels[texel(at[1]) * 2 + texel(at[0])];
  };
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k)
      expect_colour(colour((i + 0.5) / 4, (k + 0.5) / 4),
                    (i + k) % 2 ? Rgb(0, 0, 1) : Rgb(1, 0, 0));
}

TEST_F(scene, mixes_and_inverts_textures_per_texel) {
  folder_.write("i.ppm", "P6 1 1 255\nabc");
  const Described d = v4(
      "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"i.ppm\" \"bool invert\" true\n"
      "Texture \"m\" \"spectrum\" \"mix\" \"texture tex1\" \"t\" \"rgb tex2\" [1 1 1]\n"
      "\"float amount\" [0.25] Material \"diffuse\" \"texture reflectance\" \"m\"" +
      kTriangle);
  const Colour& c = d.materials.at(0).base;
  expect_colour(c.curve({.2f, .4f, .6f}) * c.factor,
                {.75f * .8f + .25f, .75f * .6f + .25f, .75f * .4f + .25f});
}

TEST_F(scene, gives_shapes_their_alpha) {
  const std::string shape = kTriangle + "\"float alpha\" [0.25]\n";
  const Described d = v4(kTriangle + shape + shape);
  EXPECT_EQ(d.materials.size(), 2u);
  EXPECT_EQ(d.materials[d.shapes.at(2).material].opacity.factor, 0.25f);
  EXPECT_EQ(v3(shape).materials.at(0).opacity.factor, 1);  // pbrt-v3 tests against 0
}

TEST_F(scene, goes_on_with_included_files) {
  folder_.write("in/b.pbrt", "Translate 0 0 1\nBroken");
  EXPECT_NE(refusal(kFilm4 + "WorldBegin Include \"in/b.pbrt\"")
                .find("in/b.pbrt:line 2: \"Broken\" is not a directive"),
            std::string::npos);
  folder_.write("in/b.pbrt", "Translate 0 0 1\n");
  expect_near(v4("Include \"in/b.pbrt\"" + kTriangle).shapes.at(0).to_world.t, {0, 0, 1});
  expect_near(v4("Import \"in/b.pbrt\"" + kTriangle).shapes.at(0).to_world.t, {0, 0, 0});
  EXPECT_NE(refusal("Include \"./a.pbrt\"").find("files include each other"), std::string::npos);
}

TEST_F(scene, keeps_states_apart) {
  const Described d = v4(
      "CoordinateSystem \"here\" TransformBegin Translate 1 0 0 ReverseOrientation TransformEnd " +
      kTriangle + "AttributeBegin Translate 2 0 0 CoordSysTransform \"here\"" + kTriangle +
      "AttributeEnd Attribute \"shape\" \"float radius\" [3] Shape \"sphere\"");
  expect_near(d.shapes.at(0).to_world.t, {0, 0, 0});
  EXPECT_TRUE(d.shapes[0].turned);
  expect_near(d.shapes.at(1).to_world.t, {0, 0, 0});
  expect_near(d.shapes.at(2).to_world.x, {3, 0, 0});
}

TEST_F(scene, names_limits_of_integrators) {
  const auto integrator = [&](const std::string& words) {
    read("Integrator " + words + "\n" + kFilm4 + "WorldBegin\n" + kTriangle);
    return losses_;
  };
  EXPECT_NE(integrator("\"path\" \"integer maxdepth\" [1]").find("--max-depth 2 "),
            std::string::npos);  // of bounces
  EXPECT_NE(integrator("\"volpath\" \"bool regularize\" true"), "");
  EXPECT_EQ(integrator("\"volpath\" \"integer maxdepth\" [100] \"string lightsampler\" \"bvh\""),
            "");
}

TEST_F(scene, begins_with_a_byte_order_mark_or_without) {
  folder_.write("more.pbrt", "\xEF\xBB\xBF" + kTriangle);
  EXPECT_EQ(read("\xEF\xBB\xBF" + kFilm4 + "WorldBegin Include \"more.pbrt\"").shapes.size(), 1u);
}

// A parameter that nobody knows is named once, in whatever list it stands.
TEST_F(scene, names_every_unknown_key) {
  folder_.write("wood.png", "not decoded here");
  const std::vector<std::string> lines = {
      "Option \"integer seed\" 3 \"float any\" 7",
      "Camera \"perspective\" \"float fov\" 40 *",
      "Film \"rgb\" \"integer xresolution\" [200] *",
      "Integrator \"volpath\" \"float any\" 7",
      "Sampler \"halton\" \"integer pixelsamples\" 16 \"float any\" 7",
      "PixelFilter \"gaussian\" \"float xradius\" 2 \"float any\" 7",
      "Accelerator \"bvh\" \"float any\" 7",
      "WorldBegin",
      "Attribute \"shape\" \"float radius\" 2 *",
      "Attribute \"material\" \"float roughness\" 0 *",
      "LightSource \"infinite\" \"rgb L\" [1 1 1] *",
      "LightSource \"point\" *",
      "LightSource \"distant\" *",
      "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"wood.png\" *",
      "Texture \"u\" \"spectrum\" \"scale\" \"texture tex\" \"t\" \"float scale\" 0.5 *",
      "MakeNamedMaterial \"m\" \"string type\" \"coateddiffuse\" \"texture reflectance\" \"u\" *",
      "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [0 0 0] *",
      "NamedMaterial \"m\"",
      "AreaLightSource \"diffuse\" *",
      "Shape \"disk\" *",
      "MediumInterface \"fog\" \"\"",
      "Material \"dielectric\" *",
      "Shape \"sphere\" \"float radius\" 1 *",
      "MediumInterface \"\" \"\"",
      "Material \"conductor\" *",
      kTriangle + " *",
      "Material \"interface\" *",
      "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] *"};
  const auto with_unknown = [&](size_t line) {
    std::string text;
    for (size_t i = 0; i < lines.size(); ++i)
      text +=
          lines[i].substr(0, lines[i].find(" *")) + (i == line ? " \"float unheard\" [1]\n" : "\n");
    return text;
  };
  read(with_unknown(lines.size()));
  expect_nothing_lost();
  for (size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].find(" *") == std::string::npos) continue;
    read(with_unknown(i));
    EXPECT_NE(losses_.find("\"float unheard\" of " + lines[i].substr(0, lines[i].find(' '))),
              std::string::npos)
        << lines[i] << losses_;
    EXPECT_EQ(std::count(losses_.begin(), losses_.end(), '\n'), 1) << losses_;
  }
  // Nobody needs the parameters of what nobody names.
  v4("MakeNamedMaterial \"m\" \"string type\" \"diffuse\" \"float unheard\" 1\n"
     "Texture \"t\" \"spectrum\" \"constant\" \"float unheard\" 1\n" +
     kTriangle);
  expect_nothing_lost();
}

TEST_F(scene, with_errors_is_refused_with_the_line) {
  const auto expect_refused = [&](const std::string& text, const std::string& words) {
    const std::string message = refusal(text);
    EXPECT_NE(message.find(words), std::string::npos) << message << " for " << text;
  };
  expect_refused("", "no WorldBegin");
  expect_refused("WorldBegin\n\nFoo", "line 3: \"Foo\" is not a directive");
  expect_refused("WorldBegin \"a", "line 1: a string does not end on its line");
  expect_refused("WorldBegin Translate 1 2", "\"end of the file\" is not a number");
  expect_refused("WorldBegin Translate 1 2 nan", "\"nan\" is not a number");
  expect_refused("WorldBegin Translate 1 2 1e999", "\"1e999\" is not a number");
  expect_refused("WorldBegin Shape \"sphere\" \"radius\" [1]", "not a parameter's type and name");
  expect_refused("WorldBegin Shape \"sphere\" \"float radius\" [1 2]",
                 "\"radius\" must have 1 number");
  expect_refused("WorldBegin Shape \"sphere\" \"float radius\" [1",
                 "\"end of the file\" is not a number");
  expect_refused("WorldBegin Shape \"sphere\" \"float radius\" [1 \"a\"]",
                 "values of different kinds");
  expect_refused(
      "WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0] \"integer indices\" [0 0 1]",
      "index 1 of a mesh of 1 points");
  expect_refused("WorldBegin AttributeEnd", "\"AttributeEnd\" without its beginning");
  expect_refused(kFilm4 + "WorldBegin AttributeBegin", "line 2: what begins here does not end");
  expect_refused("LookAt 0 0 0 0 1 0 0 1 0 WorldBegin", "parallel to \"up\"");
  expect_refused("Scale 0 1 1 Camera \"perspective\" WorldBegin", "flattens space");
  expect_refused("WorldBegin ObjectBegin \"a\" ObjectBegin \"b\"", "an object within an object");
  std::string nested = "WorldBegin ";
  for (int i = 0; i < 10001; ++i) nested += "AttributeBegin ";
  expect_refused(nested, "more than 10000 states");
  std::string many = "WorldBegin ObjectBegin \"a\" ";
  for (int i = 0; i < 1001; ++i) many += "Shape \"sphere\" ";
  many += "ObjectEnd ";
  for (int i = 0; i < 1000; ++i) many += "ObjectInstance \"a\" ";
  expect_refused(many, "more than 1000000 shapes");
  std::string deep = "WorldBegin Texture \"t\" \"float\" \"constant\" ";
  for (int i = 0; i < 200; ++i) deep += "Texture \"t\" \"float\" \"scale\" \"texture tex\" \"t\" ";
  expect_refused(deep, "more than 100 deep");
}

}  // namespace tdpt::foreign::pbrt_test
