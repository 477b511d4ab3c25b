#include "tools/tdpt-import/described.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libcommon/testing/files/temp_folder.h"
#include "tools/tdpt-import/materials.h"

namespace tdpt::foreign::mitsuba_test {

constexpr double kPi = std::numbers::pi;

void expect_near(const Vec3d& a, const Vec3d& b, double eps = 1e-6) {
  EXPECT_NEAR(a.x, b.x, eps);
  EXPECT_NEAR(a.y, b.y, eps);
  EXPECT_NEAR(a.z, b.z, eps);
}
void expect_colour(const Rgb& a, const Rgb& b, double eps = 1e-5) {
  expect_near({a.x, a.y, a.z}, {b.x, b.y, b.z}, eps);
}

class scene : public ::testing::Test {
 protected:
  using Parameters = std::map<std::string, std::string>;

  Described read(const std::string& text, const Parameters& parameters = {}) {
    Source source(folder_.write("a.xml", text));
    Described d = read_mitsuba(source, parameters);
    source.lose_unread();
    losses_.clear();
    for (const Source::Loss& loss : source.losses())
      losses_ += loss.first.where + ": " + loss.sentence + "\n";
    return d;
  }
  Described v0(const std::string& inside) {
    return read("<scene version=\"0.6.0\">\n" + inside + "</scene>");
  }
  Described v3(const std::string& inside, const Parameters& parameters = {}) {
    return read("<scene version=\"3.0.0\">\n" + inside + "</scene>", parameters);
  }
  // The material of a shape.
  Material surface(const std::string& bsdf, bool old = false) {
    const std::string shape = "<shape type=\"sphere\">" + bsdf + "</shape>";
    return (old ? v0(shape) : v3(shape)).materials.at(0);
  }
  // "line 3: words" of the refusal.
  std::string refusal(const std::string& inside, bool old = false) {
    try {
      old ? v0(inside) : v3(inside);
      return "";
    } catch (const InputError& e) {
      const std::string message = e.what();
      return message.substr(message.find(".xml:") + 5);
    }
  }
  void expect_lost(const std::string& words) const {
    EXPECT_NE(losses_.find(words), std::string::npos) << words << " in\n" << losses_;
  }
  void expect_nothing_lost() const { EXPECT_EQ(losses_, ""); }

  testing::TempFolder folder_;
  std::string losses_;
};

const std::string kSquareObj =
    "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "f 1/1 2/2 3/3 4/4\n";

// ---- the file

TEST_F(scene, takes_names_of_both_versions) {
  for (const bool old : {true, false}) {
    const std::string name = old ? "toWorld" : "to_world";
    const std::string text = "<shape type=\"sphere\"><transform name=\"" + name +
                             "\"><translate x=\"5\"/></transform></shape>";
    expect_near((old ? v0(text) : v3(text)).shapes.at(0).to_world.t, {5, 0, 0});
  }
}

TEST_F(scene, replaces_names_by_parameters_and_defaults) {
  const std::string text =
      "<default name=\"r\" value=\"2\"/><default name=\"r2\" value=\"7\"/>"
      "<shape type=\"sphere\"><float name=\"radius\" value=\"$r2\"/></shape>"
      "<shape type=\"sphere\"><float name=\"radius\" value=\"1$r\"/></shape>";
  const Described d = v3(text);
  const double unit = v3("<shape type=\"sphere\"/>").shapes.at(0).to_world.x.x;
  EXPECT_NEAR(d.shapes.at(0).to_world.x.x / unit, 7, 1e-9);
  EXPECT_NEAR(d.shapes.at(1).to_world.x.x / unit, 12, 1e-9);
  EXPECT_NEAR(v3(text, {{"r", "3"}}).shapes.at(1).to_world.x.x / unit, 13, 1e-9);
  EXPECT_EQ(refusal("<shape type=\"$kind\"/>"),
            "line 2: \"$kind\" has no value: neither a default nor --define gives it one");
}

TEST_F(scene, includes_files) {
  folder_.write("parts/b.xml", "<scene version=\"3.0.0\">\n<shape type=\"sphere\"/></scene>");
  folder_.write("parts/c.xml", "<shape version=\"3.0.0\" type=\"cube\"/>");
  const Described d =
      v3("<path value=\"parts\"/><include filename=\"b.xml\"/><include filename=\"parts/c.xml\"/>");
  EXPECT_EQ(d.shapes.size(), 2u);
  folder_.write("loop.xml", "<scene version=\"3.0.0\"><include filename=\"loop.xml\"/></scene>");
  EXPECT_EQ(refusal("<include filename=\"loop.xml\"/>"), "line 1: includes are nested too deeply");
  EXPECT_NE(refusal("<include filename=\"../b.xml\"/>"), "");
  EXPECT_NE(refusal("<include filename=\"none.xml\"/>"), "");
}

TEST_F(scene, resolves_references) {
  const Described d =
      v3("<shape type=\"sphere\"><ref id=\"b\"/></shape><bsdf type=\"diffuse\" id=\"a\"/>"
         "<alias id=\"a\" as=\"b\"/><shape type=\"sphere\"><ref id=\"a\"/></shape>");
  EXPECT_EQ(d.materials.size(), 1u);
  EXPECT_EQ(d.materials[0].name, "a");
  EXPECT_EQ(d.shapes.size(), 2u);
  EXPECT_EQ(refusal("\n<shape type=\"sphere\"><ref id=\"c\"/></shape>"),
            "line 3: no object has the id \"c\"");
  EXPECT_EQ(refusal("<bsdf type=\"null\" id=\"a\"/>\n<bsdf type=\"null\" id=\"a\"/>"),
            "line 3: a second object has the id \"a\"");
  EXPECT_EQ(refusal("<bsdf type=\"mask\" id=\"a\"><ref id=\"a\"/></bsdf>"),
            "line 2: objects refer to each other too deeply, or in a circle");
}

TEST_F(scene, refuses_what_is_malformed) {
  EXPECT_EQ(refusal("<shape type=\"sphere\">\n<float name=\"radius\" value=\"1m\"/></shape>"),
            "line 3: \"1m\" is not a finite number");
  EXPECT_EQ(refusal("<shape type=\"sphere\">\n<float name=\"radius\" value=\"nan\"/></shape>"),
            "line 3: \"nan\" is not a finite number");
  EXPECT_EQ(refusal("<shape type=\"sphere\"><transform name=\"to_world\">\n"
                    "<matrix value=\"1 2 3\"/></transform></shape>"),
            "line 3: a matrix of 3 numbers, expected 16");
  EXPECT_EQ(refusal("<shape type=\"obj\"/>"), "line 2: the shape \"obj\" has no \"filename\"");
  EXPECT_EQ(refusal("<shape/>"), "line 2: the shape \"\" has no attribute \"type\"");
  EXPECT_EQ(refusal("<cup type=\"x\"/>"), "line 2: the element <cup> is unknown");
  EXPECT_NE(refusal("<shape"), "");
  EXPECT_THROW(read("<html version=\"3\"/>"), InputError);
  EXPECT_THROW(read("<scene/>"), InputError);
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<bsdf type=\"mask\">";
  EXPECT_NE(refusal(deep), "");
  for (int i = 0; i < 100000; ++i) deep += "</bsdf>";
  EXPECT_EQ(refusal(deep), "line 2: is nested too deeply");
}

TEST_F(scene, names_what_is_not_read) {
  const Described d =
      v3("<integrator type=\"path\"/>\n<shape type=\"hair\"/>\n<emitter type=\"sunsky\"/>\n"
         "<sensor type=\"orthographic\"/>\n"
         "<shape type=\"sphere\"><float name=\"radiuss\" value=\"1\"/></shape>");
  EXPECT_EQ(d.shapes.size(), 1u);
  EXPECT_EQ(losses_,
            "line 3: the shape \"hair\" is not read and left out\n"
            "line 4: emitters of type \"sunsky\" are not read and left out\n"
            "line 5: sensors of type \"orthographic\" are not read and left out\n"
            "line 6: the parameter \"radiuss\" of the shape \"sphere\" is not read\n");
}

// ---- cameras

std::string camera(const std::string& inside) {
  return "<sensor type=\"perspective\"><float name=\"fov\" value=\"90\"/>" + inside +
         "<film type=\"hdrfilm\"><integer name=\"width\" value=\"200\"/>"
         "<integer name=\"height\" value=\"100\"/></film></sensor>";
}

TEST_F(scene, takes_lamps_by_reference) {
  const Described d =
      v3("<emitter type=\"area\" id=\"e\"><rgb name=\"radiance\" value=\"2\"/></emitter>"
         "<bsdf type=\"twosided\" id=\"b\"><bsdf type=\"diffuse\"/></bsdf>"
         "<shape type=\"rectangle\"><ref id=\"e\"/><ref id=\"b\"/></shape>"
         "<shape type=\"rectangle\"><ref id=\"e\"/><ref id=\"b\"/></shape>");
  EXPECT_EQ(d.shapes.at(1).emission->radiance.factor.x, 2);
  expect_nothing_lost();
  v3("<shape type=\"sphere\"><sampler type=\"independent\"/></shape>");
  expect_lost("the sampler \"independent\" of the shape \"sphere\" is not read");
}

TEST_F(scene, names_limits_of_integrators) {
  const auto integrator = [&](const std::string& type, const std::string& inside) {
    v3("<integrator type=\"" + type + "\">" + inside + "</integrator>");
    return losses_;
  };
  const std::string depth = "<integer name=\"max_depth\" value=\"";
  EXPECT_NE(integrator("path", depth + "8\"/>").find("--max-depth 8 "), std::string::npos);
  EXPECT_NE(integrator("direct", "").find("--max-depth 2 "), std::string::npos);
  EXPECT_NE(integrator("ao", "").find("shows other light"), std::string::npos);
  EXPECT_NE(integrator("path", "<boolean name=\"hide_emitters\" value=\"true\"/>"), "");
  EXPECT_EQ(integrator("path", depth + "-1\"/>"), "");
  EXPECT_EQ(integrator("path", depth + "65\"/>"), "");
}

TEST_F(scene, refuses_parameters_that_it_does_not_use) {
  EXPECT_THROW(v3("<shape type=\"sphere\"/>", {{"width", "3"}}), UsageError);
  EXPECT_THROW(v3("<default name=\"width\" value=\"4\"/>", {{"width", "3"}}), UsageError);
  v3("<shape type=\"sphere\"><float name=\"radius\" value=\"$width\"/></shape>", {{"width", "3"}});
}

// A value that nobody knows is named once, in whatever object it stands.
TEST_F(scene, names_every_unknown_key) {
  folder_.write("wood.png", "not decoded here");
  const std::string inside =
      "<sensor type=\"thinlens\"><float name=\"fov\" value=\"40\"/></sensor>"
      "<texture type=\"bitmap\" id=\"t\"><string name=\"filename\" value=\"wood.png\"/></texture>"
      "<bsdf type=\"twosided\" id=\"b\"><bsdf type=\"roughconductor\"><string "
      "name=\"distribution\" "
      "value=\"ggx\"/><ref name=\"specular_reflectance\" id=\"t\"/></bsdf></bsdf>"
      "<bsdf type=\"mask\" id=\"m\"><bsdf type=\"twosided\"><bsdf type=\"diffuse\"/></bsdf></bsdf>"
      "<emitter type=\"area\" id=\"e\"><rgb name=\"radiance\" value=\"2\"/></emitter>"
      "<emitter type=\"constant\"><blackbody name=\"radiance\" temperature=\"5000\"/></emitter>"
      "<emitter type=\"point\"><point name=\"position\" x=\"1\" y=\"2\" z=\"3\"/></emitter>"
      "<shape type=\"shapegroup\" id=\"g\"><shape type=\"cube\"><ref id=\"b\"/></shape></shape>"
      "<shape type=\"instance\"><ref id=\"g\"/></shape>"
      "<shape type=\"rectangle\"><ref id=\"m\"/><ref id=\"e\"/></shape>"
      "<shape type=\"sphere\"><bsdf type=\"dielectric\"/><medium type=\"homogeneous\" "
      "name=\"interior\"><rgb name=\"sigma_a\" value=\"1\"/></medium></shape>"
      "<shape type=\"sphere\"><bsdf type=\"null\"/></shape>";
  v3(inside);
  expect_nothing_lost();
  size_t objects = 0;
  for (size_t at = 0; (at = inside.find('<', at)) != inside.npos; ++at) {
    if (inside[at + 1] == '/') continue;
    const size_t name_end = inside.find(' ', at), end = inside.find('>', at);
    const std::string junk = "<float name=\"unheard\" value=\"1\"/>";
    if (inside.find("type=", at) > end) continue;  // not an object
    ++objects;
    const bool is_empty = inside[end - 1] == '/';
    const std::string closed =
        is_empty ? ">" + junk + "</" + inside.substr(at + 1, name_end - at - 1) + ">" : ">" + junk;
    v3(inside.substr(0, is_empty ? end - 1 : end) + closed + inside.substr(end + 1));
    EXPECT_NE(losses_.find("the parameter \"unheard\" of the "), std::string::npos)
        << inside.substr(at, 60);
    EXPECT_EQ(std::count(losses_.begin(), losses_.end(), '\n'), 1) << losses_;
  }
  EXPECT_EQ(objects, 19u);
  // Nobody needs the values of what nobody uses or of how to render.
  v3("<float name=\"unheard\" value=\"1\"/><integrator type=\"path\"><float name=\"unheard\" "
     "value=\"1\"/></integrator>");
  expect_nothing_lost();
  v3("<bsdf type=\"diffuse\" id=\"x\"><float name=\"unheard\" value=\"1\"/></bsdf>"
     "<shape type=\"shapegroup\"><float name=\"unheard\" value=\"1\"/></shape>");
  expect_nothing_lost();
}

TEST_F(scene, turns_cameras_round) {
  // By Mitsuba 3.9: looks along +z, the left of the picture is +x.
  const Camera c = v3(camera("")).cameras.at(0);
  expect_near(c.to_world.z, {0, 0, -1});
  expect_near(c.to_world.x, {-1, 0, 0});
  expect_near(c.to_world.y, {0, 1, 0});
  EXPECT_EQ(c.width, 200);
  EXPECT_EQ(c.height, 100);
  EXPECT_NEAR(c.yfov, 2 * std::atan(0.5), 1e-12);
  expect_nothing_lost();
}

TEST_F(scene, looks_at) {
  for (const char* up : {"0, 1, 0", "0 1 0", "0,5,0"}) {
    const Camera c = v0(camera(fmt::format("<transform name=\"toWorld\"><lookAt origin=\"1 2 3\" "
                                           "target=\"1, 2, -7\" up=\"{}\"/></transform>",
                                           up)))
                         .cameras.at(0);
    expect_near(c.to_world.x, {1, 0, 0});
    expect_near(c.to_world.y, {0, 1, 0});
    expect_near(c.to_world.z, {0, 0, 1});
    expect_near(c.to_world.t, {1, 2, 3});
  }
  const Camera mirrored =
      v0(camera("<transform name=\"toWorld\"><scale x=\"-1\"/></transform>")).cameras.at(0);
  EXPECT_TRUE(mirrored.to_world.mirrors());
  EXPECT_NE(refusal(camera("<transform name=\"to_world\"><lookat origin=\"0 0 0\" target=\"0 1 0\" "
                           "up=\"0 1 0\"/></transform>")),
            "");
}

TEST_F(scene, measures_fields_of_view) {
  const auto yfov = [&](const std::string& axis) {
    return v3(camera("<string name=\"fov_axis\" value=\"" + axis + "\"/>")).cameras.at(0).yfov;
  };
  EXPECT_NEAR(yfov("x"), 2 * std::atan(0.5), 1e-12);
  EXPECT_NEAR(yfov("larger"), 2 * std::atan(0.5), 1e-12);
  EXPECT_NEAR(yfov("y"), kPi / 2, 1e-12);
  EXPECT_NEAR(yfov("smaller"), kPi / 2, 1e-12);
  EXPECT_NEAR(yfov("diagonal"), 2 * std::atan(1 / std::sqrt(5)), 1e-12);
  const Camera c = v3("<sensor type=\"thinlens\"><float name=\"aperture_radius\" value=\"0.1\"/>"
                      "<float name=\"focus_distance\" value=\"3\"/></sensor>")
                       .cameras.at(0);
  EXPECT_EQ(c.width, 768);
  EXPECT_EQ(c.height, 576);
  EXPECT_NEAR(c.yfov, 2 * std::atan(std::hypot(36, 24) / 100 * 0.6), 1e-12);
  EXPECT_EQ(c.lens_radius, 0.1);
  EXPECT_EQ(c.focus_distance, 3);
}

// ---- shapes

// uv at a corner of a mesh.
std::array<float, 2> uv_at(const Mesh& mesh, const Vec3f& p) {
  for (size_t i = 0; i < mesh.positions.size(); ++i)
    if (length(mesh.positions[i] - p) < 1e-5f) return mesh.uv[i];
  return {-1, -1};
}

TEST_F(scene, keeps_the_coordinates_of_pictures) {
  using Uv = std::array<float, 2>;
  folder_.write("a.obj", kSquareObj);
  // By Mitsuba 3.9: v = 0 is the top row. A rectangle has it below, an OBJ file above.
  const Described d = v3(
      "<shape type=\"rectangle\"/><shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/>"
      "</shape><shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/>"
      "<boolean name=\"flip_tex_coords\" value=\"false\"/></shape>"
      "<shape type=\"cylinder\"/><shape type=\"disk\"/>");
  const auto mesh = [&](size_t shape) { return d.meshes[d.shapes.at(shape).mesh]; };
  EXPECT_EQ(uv_at(mesh(0), {-1, -1, 0}), (Uv{0, 0}));
  EXPECT_EQ(uv_at(mesh(0), {-1, 1, 0}), (Uv{0, 1}));
  EXPECT_EQ(uv_at(mesh(1), {-1, -1, 0}), (Uv{0, 1}));
  EXPECT_EQ(uv_at(mesh(2), {-1, -1, 0}), (Uv{0, 0}));
  for (size_t i = 0; i < mesh(3).positions.size(); ++i)
    EXPECT_NEAR(mesh(3).uv[i][1], mesh(3).positions[i].z, 1e-6);
  EXPECT_EQ(uv_at(mesh(4), {0, 0, 0})[0], 0);  // u is the radius
}

TEST_F(scene, takes_the_front_as_mitsuba) {
  folder_.write("a.obj", kSquareObj);
  folder_.write("n.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nvn 0 0 -1\nf 1//1 2//1 3//1\n");
  const auto front = [&](const std::string& file, const std::string& inside) {
    const Described d = v3("<shape type=\"obj\"><string name=\"filename\" value=\"" + file +
                           "\"/>" + inside + "</shape>");
    const Shape& s = d.shapes.at(0);
    const Mesh& m = d.meshes[s.mesh];
    const auto& t = m.triangles.at(0);
    const float z =
        cross(m.positions[t[1]] - m.positions[t[0]], m.positions[t[2]] - m.positions[t[0]]).z;
    return (z > 0) != s.turned ? 1 : -1;  // a mirroring in x keeps it
  };
  const std::string mirror =
      "<transform name=\"to_world\"><scale x=\"-1\" y=\"1\" z=\"1\"/></transform>";
  const std::string flat = "<boolean name=\"face_normals\" value=\"true\"/>";
  const std::string flip = "<boolean name=\"flip_normals\" value=\"true\"/>";
  // As measured with Mitsuba 3.9.
  EXPECT_EQ(front("a.obj", ""), 1);
  EXPECT_EQ(front("a.obj", flip), -1);
  EXPECT_EQ(front("a.obj", mirror), -1);
  EXPECT_EQ(front("a.obj", mirror + flip), 1);
  EXPECT_EQ(front("n.obj", ""), -1);
  EXPECT_EQ(front("n.obj", flat), 1);
  EXPECT_EQ(front("n.obj", mirror), -1);
  EXPECT_EQ(front("n.obj", mirror + flat), -1);
}

TEST_F(scene, smooths_meshes_without_normals) {
  folder_.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\n");
  const auto mesh = [&](const std::string& inside) {
    return v3("<shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/>" + inside +
              "</shape>")
        .meshes.at(0);
  };
  const Mesh smooth = mesh("");
  ASSERT_EQ(smooth.normals.size(), 4u);
  const float h = std::sqrt(0.5f);
  expect_colour(smooth.normals[0], {0, h, h});
  EXPECT_TRUE(mesh("<boolean name=\"face_normals\" value=\"true\"/>").normals.empty());
}

TEST_F(scene, places_round_shapes) {
  const std::string text =
      "<shape type=\"sphere\"><point name=\"center\" x=\"1\" y=\"2\" z=\"3\"/>"
      "<float name=\"radius\" value=\"2\"/><transform name=\"to_world\"><scale value=\"10\"/>"
      "</transform></shape><shape type=\"cylinder\"><point name=\"p0\" value=\"1, 0, 0\"/>"
      "<point name=\"p1\" value=\"5, 0, 0\"/><float name=\"radius\" value=\"0.5\"/></shape>";
  const Described d = v3(text);
  expect_near(d.shapes.at(0).to_world.t, {10, 20, 30});
  EXPECT_NEAR(length(d.shapes[0].to_world.x), 20, 1e-9);
  expect_near(d.shapes.at(1).to_world.t, {1, 0, 0});
  expect_near(d.shapes[1].to_world.z, {4, 0, 0});
  EXPECT_NEAR(length(d.shapes[1].to_world.x), 0.5, 1e-9);
  // 0.6 scales the radius alone.
  std::string old = text;
  old.replace(old.find("to_world"), 8, "toWorld");
  expect_near(v0(old).shapes.at(0).to_world.t, {1, 2, 3});
}

TEST_F(scene, repeats_groups) {
  const Described d =
      v3("<shape type=\"shapegroup\" id=\"g\"><shape type=\"cube\"><transform name=\"to_world\">"
         "<translate x=\"1\"/></transform></shape></shape>"
         "<shape type=\"instance\"><ref id=\"g\"/><transform name=\"to_world\"><scale value=\"2\"/>"
         "</transform></shape><shape type=\"instance\"><ref id=\"g\"/></shape>");
  ASSERT_EQ(d.shapes.size(), 2u);
  EXPECT_EQ(d.meshes.size(), 1u);
  expect_near(d.shapes[0].to_world.t, {2, 0, 0});
  expect_near(d.shapes[1].to_world.t, {1, 0, 0});
  EXPECT_NE(refusal("<shape type=\"instance\"/>"), "");
}

TEST_F(scene, gives_shapes_their_default_surface) {
  const Described d =
      v3("<shape type=\"cube\"/><shape type=\"cube\"><emitter type=\"area\"/></shape>");
  expect_colour(d.materials[d.shapes.at(0).material].base.factor, Rgb(0.5f));
  expect_colour(d.materials[d.shapes.at(1).material].base.factor, Rgb(0));
  expect_nothing_lost();
  v3("<shape type=\"rectangle\"/>");
  expect_lost("black on their back");
}

// ---- colours

TEST_F(scene, reads_colours) {
  const auto base = [&](const std::string& colour, bool old) {
    return surface("<bsdf type=\"twosided\"><bsdf type=\"diffuse\">" + colour + "</bsdf></bsdf>",
                   old)
        .base.factor;
  };
  for (const bool old : {true, false}) {
    expect_colour(base("<rgb name=\"reflectance\" value=\"0.1, 0.2 0.3\"/>", old),
                  {0.1f, 0.2f, 0.3f});
    expect_colour(base("<rgb name=\"reflectance\" value=\"0.1\"/>", old), Rgb(0.1f));
    expect_colour(base("<spectrum name=\"reflectance\" value=\"0.25\"/>", old), Rgb(0.25f));
  }
  expect_colour(base("<rgb name=\"reflectance\" value=\"#ff0033\"/>", true), {1, 0, 0.2f});
  expect_colour(base("<srgb name=\"reflectance\" value=\"#ff0080\"/>", true), {1, 0, 0.2158605f});
  // Those of Mitsuba 3.9 itself.
  expect_colour(
      base("<spectrum name=\"reflectance\" value=\"400:0.1, 500:0.2, 600:0.6, 700:0.8\"/>", false),
      {0.7325f, 0.3634f, 0.1193f}, 0.01);
  EXPECT_NE(refusal("<shape type=\"cube\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" "
                    "value=\"1 2\"/></bsdf></shape>"),
            "");
}

TEST_F(scene, reads_light) {
  const auto light = [&](const std::string& colour, bool old) {
    const std::string text = "<emitter type=\"constant\">" + colour + "</emitter>";
    return (old ? v0(text) : v3(text)).sky->colour;
  };
  // As measured with Mitsuba 3.9: only a number is white.
  expect_colour(light("<float name=\"radiance\" value=\"2\"/>", false), Rgb(2));
  expect_colour(light("<spectrum name=\"radiance\" value=\"2\"/>", false),
                {2.4096f, 1.8966f, 1.8178f}, 1e-3);
  expect_colour(
      light("<spectrum name=\"radiance\" value=\"400:0.1, 500:0.2, 600:0.6, 700:0.8\"/>", false),
      {0.8479f, 0.3479f, 0.1027f}, 0.01);
  expect_colour(light("<spectrum name=\"radiance\" value=\"2\"/>", true), Rgb(2));
  // Planck's law: 12.4 kW/m2/sr/nm on the average of the eye's response.
  EXPECT_NEAR(luminance(light("<blackbody name=\"radiance\" temperature=\"5000K\"/>", true)), 12470,
              150);
}

// ---- textures

TEST_F(scene, reads_bitmaps) {
  folder_.write("t.png", "not looked into");
  const std::string bitmap =
      "<bsdf type=\"twosided\"><bsdf type=\"diffuse\"><texture type=\"bitmap\" "
      "name=\"reflectance\"><string name=\"filename\" value=\"t.png\"/>";
  const std::string end = "</texture></bsdf></bsdf>";
  Texture t = *surface(bitmap + end).base.texture;
  EXPECT_TRUE(t.srgb);
  EXPECT_EQ(t.map, (std::array<double, 6>{1, 0, 0, 0, 1, 0}));
  t = *surface(bitmap +
               "<boolean name=\"raw\" value=\"true\"/><string name=\"wrap_mode\" "
               "value=\"clamp\"/><string name=\"filter_type\" value=\"nearest\"/>"
               "<transform name=\"to_uv\"><translate x=\"0.5\"/><scale x=\"2\" y=\"3\"/>"
               "</transform>" +
               end)
           .base.texture;
  EXPECT_FALSE(t.srgb);
  EXPECT_TRUE(t.nearest);
  EXPECT_EQ(t.wrap_u, Texture::Wrap::clamp);
  EXPECT_EQ(t.map, (std::array<double, 6>{2, 0, 1, 0, 3, 0}));
  t = *surface(bitmap +
                   "<float name=\"uscale\" value=\"2\"/><float name=\"voffset\" "
                   "value=\"0.25\"/><float name=\"gamma\" value=\"1\"/>" +
                   end,
               true)
           .base.texture;
  EXPECT_FALSE(t.srgb);
  EXPECT_EQ(t.map, (std::array<double, 6>{2, 0, 0, 0, 1, 0.25}));
  expect_nothing_lost();
}

TEST_F(scene, makes_checkerboards) {
  const Described d =
      v3("<shape type=\"cube\"><bsdf type=\"diffuse\"><texture type=\"checkerboard\" "
         "name=\"reflectance\"><rgb name=\"color0\" value=\"1 0 0\"/></texture></bsdf></shape>");
  const Image& image = d.images.at(0);
  expect_colour(image.texels.at(0), {1, 0, 0});  // uv of 0 to 1/2
  expect_colour(image.texels.at(1), Rgb(0.2f));
  expect_colour(image.texels.at(3), {1, 0, 0});
  EXPECT_TRUE(d.materials.at(0).base.texture->nearest);
}

TEST_F(scene, names_textures_that_it_has_not) {
  const Material m = surface(
      "<bsdf type=\"diffuse\"><texture type=\"mesh_attribute\" name=\"reflectance\">"
      "<string name=\"name\" value=\"vertex_color\"/></texture></bsdf>");
  expect_colour(m.base.factor, Rgb(0.5f));
  EXPECT_EQ(
      losses_,
      "line 2: textures of type \"mesh_attribute\" are not read: grey of 0.5 in their place\n");
}

// ---- surfaces

TEST_F(scene, reads_conductors) {
  const auto au = *conductor_named("Au");
  for (const bool old : {true, false}) {
    const Material m = surface(
        "<bsdf type=\"roughconductor\"><string name=\"material\" value=\"Au\"/>"
        "<string name=\"distribution\" value=\"ggx\"/><float name=\"alpha\" "
        "value=\"0.25\"/></bsdf>",
        old);
    ASSERT_TRUE(m.eta_k);
    expect_colour((*m.eta_k)[0], au[0], 1e-3);
    EXPECT_EQ(m.metallic, 1);
    EXPECT_FLOAT_EQ(m.roughness.factor, 0.5f);
    expect_nothing_lost();
  }
  // Without a material 0.6 has copper and 3 a mirror.
  EXPECT_TRUE(surface("<bsdf type=\"conductor\"/>", true).eta_k);
  expect_colour(surface("<bsdf type=\"conductor\"/>").base.factor, Rgb(1));
  surface("<bsdf type=\"roughconductor\"><float name=\"ext_eta\" value=\"1\"/></bsdf>");
  expect_lost("microfacets of type \"beckmann\" become GGX");
  expect_lost("the parameter \"ext_eta\" of the bsdf \"roughconductor\" is not read");
}

TEST_F(scene, reads_glass) {
  const Material m = surface("<bsdf type=\"dielectric\"/>");
  EXPECT_EQ(m.transmission, 1);
  EXPECT_TRUE(m.solid);
  EXPECT_NEAR(m.ior, 1.5046 / 1.000277, 1e-5);
  EXPECT_FALSE(surface("<bsdf type=\"thindielectric\"/>").solid);
  // A bubble of air in water is water outside, seen from the back.
  const Described d =
      v3("<shape type=\"sphere\"><bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"air\"/>"
         "<float name=\"ext_ior\" value=\"1.33\"/></bsdf></shape>");
  EXPECT_NEAR(d.materials.at(0).ior, 1.33 / 1.000277, 1e-5);
  EXPECT_TRUE(d.shapes.at(0).turned);
  EXPECT_EQ(refusal("<shape type=\"cube\">\n<bsdf type=\"dielectric\"><string name=\"int_ior\" "
                    "value=\"cheese\"/></bsdf></shape>"),
            "line 3: no material \"cheese\" has a known index of refraction");
  EXPECT_EQ(refusal("<shape type=\"cube\"><bsdf type=\"dielectric\">\n<float name=\"eta\" "
                    "value=\"0\"/></bsdf></shape>"),
            "line 3: an index of refraction of 0");
}

TEST_F(scene, colours_glass_by_its_medium) {
  const auto body = [&](const char* scattering) {
    return v0(fmt::format("<shape type=\"sphere\"><bsdf type=\"dielectric\"/><medium "
                          "type=\"homogeneous\" name=\"interior\"><rgb name=\"sigmaA\" value=\"0 1 "
                          "2\"/><rgb name=\"sigmaS\" value=\"{}\"/></medium></shape>",
                          scattering))
        .materials.at(0)
        .attenuation;
  };
  expect_colour(body("0"), {1, std::exp(-1.0f), std::exp(-2.0f)});
  expect_nothing_lost();
  expect_colour(body("1"), Rgb(1));
  expect_lost("media (fog, absorption, scattering) are left out");
}

TEST_F(scene, reads_layers) {
  Material m = surface(
      "<bsdf type=\"mask\"><float name=\"opacity\" value=\"0.25\"/><bsdf type=\"twosided\">"
      "<bsdf type=\"plastic\"><rgb name=\"diffuse_reflectance\" value=\"0.2\"/>"
      "<boolean name=\"nonlinear\" value=\"true\"/></bsdf></bsdf></bsdf>");
  EXPECT_EQ(m.opacity.factor, 0.25f);
  EXPECT_EQ(m.specular, 1);
  EXPECT_LT(m.base.factor.x, 0.2f);
  expect_nothing_lost();
  m = surface(
      "<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.75\"/><bsdf type=\"diffuse\"/>"
      "<bsdf type=\"conductor\"/></bsdf>");
  EXPECT_EQ(m.metallic, 1);
  expect_lost("surfaces of type \"blendbsdf\" become the heaviest of those mixed");
  m = surface(
      "<bsdf type=\"mixturebsdf\"><string name=\"weights\" value=\"0.3, 0.7\"/>"
      "<bsdf type=\"diffuse\"/><bsdf type=\"conductor\"/></bsdf>",
      true);
  EXPECT_EQ(m.metallic, 1);
  EXPECT_TRUE(surface("<bsdf type=\"null\"/>").invisible);
  m = surface("<bsdf type=\"coating\"><bsdf type=\"conductor\"/></bsdf>", true);
  EXPECT_EQ(m.coat, 1);
  EXPECT_EQ(m.metallic, 1);
  expect_nothing_lost();
  EXPECT_NE(refusal("<shape type=\"cube\"><bsdf type=\"twosided\"/></shape>"), "");
}

// What enters comes out by the interface as seen from below, R (1 - 0.596) at index 1.5, and
// nothing a second time: in a furnace .092 + .908 x .6 x .404 of a diffuse base of 0.6.
TEST_F(scene, coats_diffuse_surfaces_as_plastic_without_light_from_within) {
  const std::string base =
      "<bsdf type=\"twosided\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.6\"/>"
      "</bsdf></bsdf></bsdf>";
  Material m = surface(
      "<bsdf type=\"coating\"><float name=\"intIOR\" value=\"1.5\"/>"
      "<float name=\"extIOR\" value=\"1\"/>" +
          base,
      true);
  expect_nothing_lost();
  EXPECT_NEAR(m.base.factor.x, 0.6 * (1 - 0.0918) / 2.25, 0.001);
  EXPECT_EQ(m.coat, 0);
  EXPECT_EQ(m.specular, 1);
  EXPECT_FLOAT_EQ(m.ior, 1.5f);
  EXPECT_EQ(m.roughness.factor, 0);
  const float smooth = m.base.factor.x;
  m = surface(
      "<bsdf type=\"roughcoating\"><string name=\"distribution\" value=\"ggx\"/>"
      "<float name=\"alpha\" value=\"0.25\"/>" +
          base,
      true);
  EXPECT_EQ(m.roughness.factor, 0.5f);
  EXPECT_NEAR(m.base.factor.x, smooth, 0.1f * smooth);
  m = surface("<bsdf type=\"coating\"><rgb name=\"sigmaA\" value=\"0.1\"/>" + base, true);
  expect_lost("the absorption in coats is left out");
  m = surface("<bsdf type=\"coating\"><bsdf type=\"plastic\"/></bsdf>", true);
  EXPECT_EQ(m.coat, 1);  // not Lambertian
  expect_lost("coats become glTF's");
}

TEST_F(scene, reads_normal_maps_and_names_bumps) {
  folder_.write("t.png", "not looked into");
  surface(
      "<bsdf type=\"bumpmap\"><texture type=\"bitmap\"><string name=\"filename\" "
      "value=\"t.png\"/></texture><bsdf type=\"diffuse\"/></bsdf>");
  expect_lost("bump maps are left out");
  const Material n = surface(
      "<bsdf type=\"normalmap\"><texture name=\"normalmap\" type=\"bitmap\"><boolean name=\"raw\" "
      "value=\"true\"/><string name=\"filename\" value=\"t.png\"/></texture>"
      "<bsdf type=\"diffuse\"/></bsdf>");
  ASSERT_TRUE(n.normal);
  EXPECT_FALSE(n.normal->srgb);
}

TEST_F(scene, reads_principled_surfaces) {
  const Material m = surface(
      "<bsdf type=\"principled\"><rgb name=\"base_color\" value=\"0.1 0.2 0.3\"/>"
      "<float name=\"roughness\" value=\"0.4\"/><float name=\"metallic\" value=\"0.5\"/>"
      "<float name=\"clearcoat\" value=\"1\"/><float name=\"sheen\" value=\"1\"/></bsdf>");
  EXPECT_GT(m.base.factor.x, 0.1f);
  EXPECT_LT(m.base.factor.x, 0.13f);
  EXPECT_FLOAT_EQ(m.roughness.factor, 0.4f);  // alpha is its square in both
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_NEAR(m.ior, 1.5, 1e-6);
  EXPECT_EQ(m.coat, 0.25f);
  expect_lost("up to a tenth more or less by direction");
  expect_lost("the highlights of clear coats become GGX");
  expect_lost("the \"sheen\" of principled surfaces is left out");
  surface("<bsdf type=\"principled\"><float name=\"metallic\" value=\"1\"/></bsdf>");
  expect_nothing_lost();
}

// A body's colour is met twice, at both sides.
TEST_F(scene, colours_principled_glass_by_the_root) {
  const std::string inside =
      "<rgb name=\"base_color\" value=\"0.81 0.25 0.04\"/>"
      "<float name=\"spec_trans\" value=\"1\"/></bsdf>";
  const Material m = surface("<bsdf type=\"principled\">" + inside);
  expect_nothing_lost();
  expect_colour(m.base.factor, {0.9f, 0.5f, 0.2f});
  EXPECT_TRUE(m.solid);
  expect_colour(surface("<bsdf type=\"principledthin\">" + inside).base.factor,
                {0.81f, 0.25f, 0.04f});
  expect_lost("principled surfaces become glTF's");
  surface("<bsdf type=\"principled\"><float name=\"spec_trans\" value=\"0.5\"/></bsdf>");
  expect_lost("principled surfaces become glTF's");
}

// Mitsuba 3 takes a number from a coloured picture as its luminance, 0.x as its mean.
TEST_F(scene, takes_numbers_of_pictures_by_their_luminance) {
  folder_.write("red.pfm", std::string("PF\n1 1\n-1\n\0\0\x80\x3f\0\0\0\0\0\0\0\0", 22));
  const std::string mask =
      "<bsdf type=\"mask\"><texture type=\"bitmap\" name=\"opacity\"><string name=\"filename\" "
      "value=\"red.pfm\"/></texture><bsdf type=\"diffuse\"/></bsdf>";
  EXPECT_TRUE(surface(mask).opacity.texture->luminance);
  EXPECT_FALSE(surface(mask, true).opacity.texture->luminance);
}

TEST_F(scene, reads_textures_in_d65) {
  folder_.write("red.pfm", std::string("PF\n1 1\n-1\n\0\0\x80\x3f\0\0\0\0\0\0\0\0", 22));
  const Described d =
      v3("<shape type=\"sphere\"><emitter type=\"area\"><texture type=\"d65\" name=\"radiance\">"
         "<float name=\"scale\" value=\"3\"/><texture type=\"bitmap\"><string name=\"filename\" "
         "value=\"red.pfm\"/></texture></texture></emitter></shape>");
  EXPECT_TRUE(d.shapes.at(0).emission->radiance.texture);
  EXPECT_EQ(d.shapes[0].emission->radiance.factor.x, 3);
  expect_nothing_lost();
}

TEST_F(scene, names_rough_principled_metals) {
  const auto metal = [&](const char* roughness) {
    surface(
        "<bsdf type=\"principled\"><float name=\"metallic\" value=\"1\"/><float "
        "name=\"roughness\" value=\"" +
        std::string(roughness) + "\"/></bsdf>");
  };
  metal("0.4");
  expect_nothing_lost();
  metal("1");
  expect_lost("up to a tenth more or less by direction");
}

TEST_F(scene, names_metals_so_rough_that_shadowing_counts) {
  const std::string text =
      "<bsdf type=\"roughconductor\"><string name=\"distribution\" "
      "value=\"ggx\"/><float name=\"alpha\" value=\"{}\"/></bsdf>";
  surface(fmt::format(fmt::runtime(text), 0.2));
  expect_nothing_lost();
  surface(fmt::format(fmt::runtime(text), 0.8));
  expect_lost("metals of roughness 0.8 reflect 5 % more in glTF");
}

TEST_F(scene, names_shapes_that_are_black_inside) {
  const auto is_named = [&](const std::string& shape) {
    v3(shape + "</shape>");
    return losses_.find("are black on their back in Mitsuba") != losses_.npos;
  };
  EXPECT_FALSE(is_named("<shape type=\"sphere\">"));
  EXPECT_FALSE(is_named("<shape type=\"cube\">"));
  EXPECT_TRUE(is_named("<shape type=\"rectangle\">"));
  EXPECT_TRUE(
      is_named("<shape type=\"cube\"><bsdf type=\"mask\"><float name=\"opacity\" value=\"0.3\"/>"
               "<bsdf type=\"diffuse\"/></bsdf>"));
}

TEST_F(scene, stands_in_for_strange_surfaces) {
  expect_colour(surface("<bsdf type=\"phong\"><rgb name=\"diffuseReflectance\" value=\"0.1\"/>"
                        "<float name=\"exponent\" value=\"3\"/></bsdf>",
                        true)
                    .base.factor,
                Rgb(0.1f));
  EXPECT_EQ(losses_, "line 2: surfaces of type \"phong\" become Lambertian\n");
}

// ---- lights

// Where a direction of the scene is in the image of its sky: u, v from the upper left.
std::array<double, 2> in_map(const Sky& sky, const Vec3d& direction) {
  const Vec3d d = sky.to_map.vector(direction);
  const double u = 0.5 + std::atan2(d.x, -d.z) / (2 * kPi);
  return {u - std::floor(u), std::acos(d.y) / kPi};
}

TEST_F(scene, turns_environments) {
  folder_.write("e.exr", "not looked into");
  const auto sky = [&](const std::string& map) {
    return *v3("<emitter type=\"envmap\"><string name=\"filename\" value=\"e.exr\"/>"
               "<float name=\"scale\" value=\"3\"/><transform name=\"to_world\">" +
               map + "</transform></emitter>")
                .sky;
  };
  // As measured with Mitsuba 3.9.
  EXPECT_NEAR(in_map(sky(""), {1, 0, 0})[0], 0.25, 1e-6);
  EXPECT_NEAR(in_map(sky(""), {0, 0, 1})[0], 0.5, 1e-6);
  EXPECT_NEAR(in_map(sky(""), {0, 1, 0})[1], 0, 1e-6);
  const std::string turn = "<rotate y=\"1\" angle=\"30\"/>";
  EXPECT_NEAR(in_map(sky(turn), {1, 0, 0})[0], 1 / 3.0, 1e-6);
  EXPECT_NEAR(in_map(sky(turn), {0, 0, 1})[0], 0.5 + 1 / 12.0, 1e-6);
  expect_colour(sky("").colour, Rgb(3));
  expect_nothing_lost();
}

// Emitters of their own, and shapes that are openings and no surfaces.
// +Y of Mitsuba's normal maps is normal x dp/du, which is up or down in the image.
TEST_F(scene, keeps_the_sense_of_normal_maps) {
  folder_.write("n.pfm", std::string("Pf\n1 1\n-1\n\0\0\x80\x3f", 14));
  const auto is_down = [&](const char* shape, const std::string& more) {
    const Described d = v3(fmt::format(
        "<shape type=\"{}\">{}<bsdf type=\"twosided\"><bsdf type=\"normalmap\"><texture "
        "type=\"bitmap\" name=\"normalmap\"><string name=\"filename\" value=\"n.pfm\"/>"
        "</texture><bsdf type=\"diffuse\"/></bsdf></bsdf></shape>",
        shape, more));
    return d.materials.at(d.shapes.at(0).material).normal->green_down;
  };
  const std::string flipped = "<boolean name=\"flip_normals\" value=\"true\"/>",
                    mirrored = "<transform name=\"to_world\"><scale x=\"-1\"/></transform>";
  for (const char* down : {"rectangle", "disk", "cylinder"}) EXPECT_TRUE(is_down(down, "")) << down;
  for (const char* up : {"cube", "sphere"}) EXPECT_FALSE(is_down(up, "")) << up;
  EXPECT_FALSE(is_down("rectangle", flipped));
  EXPECT_FALSE(is_down("rectangle", mirrored));
}

// An emitter that a shape refers to is no portal of its own.
TEST_F(scene, keeps_portals_by_reference_once) {
  const Described d =
      v3("<emitter type=\"constant\"/><emitter type=\"portal\" id=\"p\"/><shape "
         "type=\"rectangle\"><transform name=\"to_world\"><translate x=\"3\"/></transform><ref "
         "id=\"p\"/></shape>");
  ASSERT_EQ(d.portals.size(), 1u);
  EXPECT_EQ(d.portals[0].to_world.t.x, 3);
  expect_nothing_lost();
}

TEST_F(scene, keeps_portals) {
  const Described d =
      v3("<emitter type=\"constant\"/><emitter type=\"portal\"><transform name=\"to_world\">"
         "<translate z=\"-4\"/></transform></emitter>"
         "<shape type=\"rectangle\"><bsdf type=\"null\"/><emitter type=\"portal\"/></shape>"
         "<shape type=\"sphere\"/>");
  expect_nothing_lost();
  ASSERT_EQ(d.portals.size(), 2u);
  EXPECT_EQ(d.shapes.size(), 1u);
  expect_near(d.portals[1].to_world.t, {0, 0, -4});
  EXPECT_EQ(d.meshes[d.portals[0].mesh].triangles.size(), 2u);
  EXPECT_EQ(d.meshes[d.portals[1].mesh].triangles.size(), 2u);
}

TEST_F(scene, reads_lamps) {
  const Described d =
      v3("<emitter type=\"point\"><point name=\"position\" x=\"1\" y=\"2\" z=\"3\"/>"
         "<rgb name=\"intensity\" value=\"4 5 6\"/></emitter>"
         "<emitter type=\"spot\"><transform name=\"to_world\"><lookat origin=\"0 5 0\" "
         "target=\"0 0 0\" up=\"1 0 0\"/></transform><float name=\"cutoff_angle\" "
         "value=\"40\"/></emitter>"
         "<emitter type=\"directional\"><vector name=\"direction\" x=\"0\" y=\"-1\" z=\"0\"/>"
         "<rgb name=\"irradiance\" value=\"7\"/></emitter>");
  ASSERT_EQ(d.lamps.size(), 3u);
  expect_near(d.lamps[0].at, {1, 2, 3});
  expect_colour(d.lamps[0].intensity, {4, 5, 6});
  EXPECT_EQ(d.lamps[1].kind, Lamp::Kind::spot);
  expect_near(d.lamps[1].at, {0, 5, 0});
  expect_near(d.lamps[1].towards, {0, -1, 0});
  EXPECT_NEAR(d.lamps[1].outer, 40 * kPi / 180, 1e-12);
  EXPECT_NEAR(d.lamps[1].inner, 30 * kPi / 180, 1e-12);
  expect_near(d.lamps[2].towards, {0, -1, 0});
  expect_colour(d.lamps[2].intensity, Rgb(7));
  expect_lost("spots fade as glTF has it");
}

TEST_F(scene, reads_emitters_on_shapes) {
  const Described d =
      v0("<shape type=\"rectangle\"><emitter type=\"area\"><rgb name=\"radiance\" value=\"1 2 3\"/>"
         "<float name=\"samplingWeight\" value=\"2\"/></emitter></shape>");
  ASSERT_TRUE(d.shapes.at(0).emission);
  expect_colour(d.shapes[0].emission->radiance.factor, {1, 2, 3});
  EXPECT_FALSE(d.shapes[0].emission->both_sides);
  expect_nothing_lost();
}

}  // namespace tdpt::foreign::mitsuba_test
