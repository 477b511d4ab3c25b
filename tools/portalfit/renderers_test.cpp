#include "tools/portalfit/renderers.h"

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "tdpt_version.h"

namespace tdpt::renderers_test {

Portal quadrilateral(const Vec3d& at, const Vec3d& u, const Vec3d& v, double sky = 0.6) {
  Portal p;
  p.vertices = {at, at + u, at + u + v, at + v};
  p.triangles = {{0, 1, 2}, {0, 2, 3}};
  p.figures["sky"] = sky;
  return p;
}

// In the wall x = 2: 2 wide, 1.5 high, centre (2, 1.75, 3); its light goes to -x.
PortalFile one_window() {
  PortalFile file;
  file.portals = {quadrilateral({2, 1, 2}, {0, 0, 2}, {0, 1.5, 0})};
  file.scene_hash = "ca0c39";
  file.provenance.lines = {"made by portalfit 0.1.0: portalfit --for usd"};
  return file;
}

// Oblique, with numbers that have no short decimals.
PortalFile askew_window() {
  PortalFile file;
  const double a = 0.3, b = 1.1;
  file.portals = {quadrilateral({1.0 / 3, 2e-7, -1e4 / 7}, {std::cos(a) / 3, 0.1, -std::sin(a) / 3},
                                {0.01 * std::sin(b), std::sqrt(2.0), 0.02 * std::cos(b)})};
  return file;
}

// The part of `text` from `from` on.
std::string tail(const std::string& text, const std::string& from) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from << " is not in\n" << text;
  return at == std::string::npos ? "" : text.substr(at);
}

// The `n` numbers after the first `mark`.
std::vector<double> numbers_after(const std::string& text, const std::string& mark, size_t n) {
  std::vector<double> values;
  const std::string rest = tail(text, mark);
  const char* at = rest.c_str() + std::min(rest.size(), mark.size());
  while (*at != 0 && values.size() < n) {
    char* end = nullptr;
    const double v = std::strtod(at, &end);
    if (end == at) {
      ++at;
      continue;
    }
    values.push_back(v);
    at = end;
  }
  return values;
}

TEST(Renderers, AreFoundByName) {
  EXPECT_EQ(renderer_names(), (std::vector<std::string>{"cycles", "pbrt", "mitsuba", "usd"}));
  EXPECT_EQ(portals_for("none", one_window()), "");
}

// Blender's x, y, z are x, -z, y; its lamp shines along its -Z, so its Z is +x. USD's is, too.
TEST(Renderers, HaveALightForAWindow) {
  const std::vector<std::pair<std::string, std::string>> cases{{"cycles", R"(
    ("portal.0", 2, 1.5,
     ((0, 0, 1, 2),
      (-1, 0, 0, -3),
      (0, -1, 0, 1.75),
      (0, 0, 0, 1))),
)"},
                                                               {"mitsuba", R"(
    <emitter type="portal" id="portal_0">
        <transform name="to_world">
            <matrix value="0 0 -1 2 0 0.75 0 1.75 1 0 0 3 0 0 0 1"/>
        </transform>
    </emitter>
</scene>
)"},
                                                               {"pbrt", R"(
# portal.0
AttributeBegin
    ConcatTransform [ 0 0 1 0  -1 0 0 0  0 1 0 0  0 0 0 1 ]
    LightSource "infinite" "string filename" "sky.exr"
        "point3 portal" [ 2 1 2 2 1 4 2 2.5 4 2 2.5 2 ]
AttributeEnd
)"},
                                                               {"usd", R"(
    def PortalLight "portal_0"
    {
        float inputs:height = 1.5
        float inputs:width = 2
        matrix4d xformOp:transform = ( (0, 0, 1, 0), (0, -1, 0, 0), (1, 0, 0, 0), (2, 1.75, 3, 1) )
        uniform token[] xformOpOrder = ["xformOp:transform"]
    }
)"}};
  for (const auto& [name, lights] : cases) {
    const std::string text = portals_for(name, one_window());
    for (const std::string& words :
         {lights, std::string("1 light portal by portalfit (tdpt " TDPT_VERSION "), in metres"),
          std::string("scene ca0c39"), std::string("made by portalfit 0.1.0: portalfit ")})
      EXPECT_NE(text.find(words), std::string::npos) << words << " is not in\n" << text;
  }
}

TEST(Renderers, PbrtsWayOutIsAgainstTheNormal) {
  const std::vector<double> p =
      numbers_after(portals_for("pbrt", askew_window()), "\"point3 portal\" [", 12);
  ASSERT_EQ(p.size(), 12u);
  const Vec3d p0{p[0], p[1], p[2]}, p1{p[3], p[4], p[5]}, p3{p[9], p[10], p[11]};
  // As PortalImageInfiniteLight does: Frame::FromXY(p3 - p0, p1 - p0).
  EXPECT_NEAR(
      dot(normalize(cross(p3 - p0, p1 - p0)), rectangle_of(askew_window().portals[0]).normal), -1,
      1e-9);
}

TEST(Renderers, PbrtsMapStandsAsOurs) {
  // Column by column. pbrt's tool reads latitude-longitude maps with z up: u is the azimuth from x
  // to y.
  const std::vector<double> m =
      numbers_after(portals_for("pbrt", one_window()), "ConcatTransform [", 16);
  ASSERT_EQ(m.size(), 16u);
  const auto looks_to = [&](double u, double v) {
    const double azimuth = 2 * std::numbers::pi * u, polar = std::numbers::pi * v;
    const Vec3d w{std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                  std::cos(polar)};
    return Vec3d{m[0], m[1], m[2]} * w.x + Vec3d{m[4], m[5], m[6]} * w.y +
           Vec3d{m[8], m[9], m[10]} * w.z;
  };
  EXPECT_LT(length(looks_to(0.5, 0.5) - Vec3d{0, 0, -1}), 1e-12);
  EXPECT_LT(length(looks_to(0.75, 0.5) - Vec3d{1, 0, 0}), 1e-12);
  EXPECT_LT(length(looks_to(0.3, 0) - Vec3d{0, 1, 0}), 1e-12);
}

TEST(Renderers, PbrtCountsNoLightTwice) {
  PortalFile file = one_window();
  // A window that overlaps with the first, a separate one, and a door further in.
  file.portals.push_back(quadrilateral({2, 1, 3}, {0, 0, 2}, {0, 1.5, 0}));
  file.portals.push_back(quadrilateral({2, 1, 6}, {0, 0, 1}, {0, 1.5, 0}));
  file.portals.push_back(quadrilateral({-2, 0, 2}, {0, 0, 1}, {0, 2, 0}, 0.01));
  const std::string text = portals_for("pbrt", file);
  EXPECT_EQ(numbers_after(text, "\"point3 portal\" [", 12),
            (std::vector<double>{2, 1, 2, 2, 1, 5, 2, 2.5, 5, 2, 2.5, 2}));
  EXPECT_NE(text.find("\n# portal.0, portal.1\nAttributeBegin\n"), std::string::npos);
  EXPECT_NE(text.find("\n# portal.2\nAttributeBegin\n"), std::string::npos);
  EXPECT_EQ(text.find("portal.3"), std::string::npos);
}

TEST(Renderers, NumbersReadBackAsTheyWere) {
  const PortalFile file = askew_window();
  const Rectangle r = rectangle_of(file.portals[0]);
  const Vec3d &c = r.centre, &x = r.x, &y = r.y, &n = r.normal;
  EXPECT_EQ(numbers_after(portals_for("cycles", file), "(\"portal.0\",", 14),
            (std::vector<double>{r.width, r.height, x.x, -y.x, -n.x, c.x, -x.z, y.z, n.z, -c.z, x.y,
                                 -y.y, -n.y, c.y}));
  EXPECT_EQ(numbers_after(portals_for("usd", file), "inputs:height", 2),
            (std::vector<double>{r.height, r.width}));
  EXPECT_EQ(numbers_after(portals_for("usd", file), "xformOp:transform", 16),
            (std::vector<double>{x.x, x.y, x.z, 0, -y.x, -y.y, -y.z, 0, -n.x, -n.y, -n.z, 0, c.x,
                                 c.y, c.z, 1}));
  const Vec3d u = x * (0.5 * r.width), v = y * (0.5 * r.height);
  EXPECT_EQ(numbers_after(portals_for("mitsuba", file), "matrix value=", 16),
            (std::vector<double>{u.x, v.x, n.x, c.x, u.y, v.y, n.y, c.y, u.z, v.z, n.z, c.z, 0, 0,
                                 0, 1}));
  std::vector<double> corners;
  for (const Vec3d& p : r.corners())
    for (int i = 0; i < 3; ++i) corners.push_back(p[i]);
  EXPECT_EQ(numbers_after(portals_for("pbrt", file), "\"point3 portal\" [", 12), corners);
}

TEST(Renderers, APortalFileWithoutPortalsIsATextWithoutPortals) {
  for (const std::string& name : renderer_names()) {
    const std::string text = portals_for(name, {});
    EXPECT_NE(text.find("No light portals by portalfit"), std::string::npos) << name;
    EXPECT_EQ(text.find("portal.0"), std::string::npos) << name;
    EXPECT_EQ(text.find("portal_0"), std::string::npos) << name;
    EXPECT_EQ(text.find("LightSource \"infinite\" \"string"), std::string::npos) << name;
  }
}

TEST(Renderers, NamesFromOutsideStayComments) {
  PortalFile file = one_window();
  file.provenance.lines = {"from a\nimport os\r-->\x01\xc3\xa4.vdb ca0c39"};
  for (const std::string& name : renderer_names()) {
    const std::string text = portals_for(name, file);
    EXPECT_EQ(text.find("\nimport os"), std::string::npos) << name;
    for (const char c : text) EXPECT_TRUE(c == '\n' || (c >= ' ' && c <= '~')) << name;
  }
  EXPECT_NE(portals_for("mitsuba", file).find("<!-- from a?import os?- ->???.vdb ca0c39 -->\n"),
            std::string::npos);
}

}  // namespace tdpt::renderers_test
