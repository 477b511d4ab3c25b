#include "tools/tdpt-import/meshes/meshes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <zlib.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"

namespace tdpt::foreign::meshes_test {

using Uv = std::array<float, 2>;
using Triangle = std::array<uint32_t, 3>;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// The bytes of `values`, each a T.
template <class T>
std::string as(std::initializer_list<double> values, std::endian order = std::endian::little) {
  std::string bytes;
  for (const double v : values) {
    const T value = static_cast<T>(v);
    std::string one(reinterpret_cast<const char*>(&value), sizeof(T));
    bytes += order == std::endian::native ? one : std::string(one.rbegin(), one.rend());
  }
  return bytes;
}

template <class Read>
std::string complaint(const Read& read) {
  try {
    read();
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
}

// ---- OBJ

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

Mesh obj(const std::string& text) {
  return read_obj(text, "a.obj");
}
std::string obj_complaint(const std::string& text) {
  return complaint([&] { obj(text); });
}

TEST(Meshes, ObjPolygonsBecomeFans) {
  const Mesh m = obj("# made by hand\nmtllib no.mtl\no a\n" + kSquare +
                     "g front\nusemtl red\ns 1\nf 1 2 3 4\r\ng back\nf -1 -2 -4\n");
  EXPECT_EQ(m.positions.size(), 4u);
  EXPECT_EQ(m.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {3, 2, 0}}));
  EXPECT_TRUE(m.normals.empty());
  EXPECT_TRUE(m.uv.empty());
}

// A backslash goes on in the next line, whatever ends it; comments may follow; a line keeps its
// number.
TEST(Meshes, ObjLinesGoOn) {
  const std::vector<Triangle> quad{{0, 1, 2}, {0, 2, 3}};
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string text =
        "\xEF\xBB\xBFv 0 0 0 # first\nv 1 0 0 1 0.5 0.5 0.5\nv\t1\t1 \\\n0\nv 0 1 0 1\n"
        "# not here \\\nf 1 2 \\ \n  3 \\\n4 # the face\n";
    for (size_t at = 0; (at = text.find('\n', at)) != text.npos; at += end.size())
      text.replace(at, 1, end);
    const Mesh m = obj(text);
    EXPECT_EQ(m.triangles, quad) << end.size();
    EXPECT_EQ(m.positions[2], Vec3f(1, 1, 0));
    EXPECT_EQ(obj_complaint(text + "f 1 2 \\" + end + "9" + end).substr(0, 15), "a.obj:line 10: ");
    EXPECT_EQ(obj(text + "f 1 2 3 \\").triangles.size(), 3u);  // at the end of the file
    EXPECT_EQ(obj_complaint(text + "f 1.5 2 3" + end),
              "a.obj:line 10: \"1.5\" is no index, expected whole numbers and /");
  }
}

TEST(Meshes, ObjMergesEqualCornersOnly) {
  const Mesh m =
      obj(kSquare + "vt 0 0\nvt 1 0.25\nvn 0 0 2\nf 1/1/1 2/2/1 3/1/1\nf 1/1/1 3/2/1 4/1/1\n");
  EXPECT_EQ(m.positions.size(), 5u);  // the third with either uv
  EXPECT_EQ(m.triangles[1][0], 0u);
  EXPECT_EQ(m.uv[0], (Uv{0, 1}));  // v is 1 - v
  EXPECT_EQ(m.uv[1], (Uv{1, 0.75f}));
  EXPECT_EQ(m.normals[0], Vec3f(0, 0, 1));  // of length 1
}

TEST(Meshes, ObjFacesWithoutNormalsStayFlatAmongOthers) {
  const Mesh m = obj(kSquare + "v 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1 2 5\n");
  ASSERT_EQ(m.positions.size(), 6u);
  EXPECT_EQ(m.normals[0], Vec3f(1, 0, 0));
  for (const uint32_t i : m.triangles[1]) EXPECT_EQ(m.normals[i], Vec3f(0, -1, 0));
}

TEST(Meshes, ObjSaysWhatIsWrongInWhichLine) {
  EXPECT_EQ(obj_complaint(""), "a.obj: has no faces");
  EXPECT_EQ(obj_complaint(kSquare), "a.obj: has no faces");
  EXPECT_EQ(obj_complaint(kSquare + "f 1 2\n"), "a.obj: has no faces");
  EXPECT_EQ(obj_complaint("v 0 0\n"), "a.obj:line 1: has 2 of 3 numbers");
  EXPECT_EQ(obj_complaint("\n\nv 0 x 0\nv 1 1 1\n"), "a.obj:line 3: its position is not finite");
  for (const std::string word : {"nan", "inf", "1e", "1e39", "1e999"})
    EXPECT_EQ(obj_complaint("v 0 " + word + " 0"), "a.obj:line 1: its position is not finite");
  EXPECT_EQ(obj_complaint("vn 0 1"), "a.obj:line 1: has 2 of 3 numbers");
  EXPECT_EQ(obj_complaint("vt"), "a.obj:line 1: has 0 of 1 numbers");
  EXPECT_EQ(obj_complaint("vt "), "a.obj:line 1: has 0 of 1 numbers");
  EXPECT_EQ(obj_complaint(kSquare + "f 1 2 5\n"),
            "a.obj:line 5: refers to vertex 5, but there are 4 so far");
  EXPECT_EQ(obj_complaint(kSquare + "\r\nf 1 2 -5"),
            "a.obj:line 6: refers to vertex -5, but there are 4 so far");
  EXPECT_EQ(obj_complaint(kSquare + "f 0 1 2\n"),
            "a.obj:line 5: refers to vertex 0, but there are 4 so far");
  EXPECT_EQ(obj_complaint(kSquare + "f 4294967297 2 3\n"),
            "a.obj:line 5: refers to vertex 4294967297, but there are 4 so far");
  EXPECT_EQ(obj_complaint(kSquare + "f 1/1 2/1 3/1\n"),
            "a.obj:line 5: refers to texture coordinate 1, but there are 0 so far");
  EXPECT_EQ(obj_complaint(kSquare + "f 1//1 2//1 3//1\n"),
            "a.obj:line 5: refers to normal 1, but there are 0 so far");
}

TEST(Meshes, ObjNormalsThatAreNoneBecomeZero) {
  EXPECT_TRUE(obj(kSquare + "vn nan nan nan\nf 1//1 2//1 3//1\n").normals.empty());
  const Mesh m = obj(kSquare + "vn 0 0 0\nvn 1 0 0\nf 1//1 2//2 3//2\n");
  EXPECT_EQ(m.normals[0], Vec3f());
  EXPECT_EQ(m.normals[1], Vec3f(1, 0, 0));
}

// ---- PLY

std::string ply_header(const std::string& format, const std::string& face = "uchar int") {
  return "ply\nformat " + format +
         " 1.0\ncomment by hand\nelement camera 1\nproperty list uchar short path\nelement vertex "
         "4\n"
         "property float x\nproperty float y\nproperty float z\nproperty uchar red\n"
         "property double u\nproperty float v\nelement face 2\nproperty char tag\nproperty list " +
         face + " vertex_indices\nelement nothing 7\nend_header\n";
}
Mesh ply(const std::string& text) {
  return read_ply(text, "a.ply");
}
std::string ply_complaint(const std::string& text) {
  return complaint([&] { ply(text); });
}
void expect_the_square(const Mesh& m) {
  ASSERT_EQ(m.positions.size(), 4u);
  EXPECT_EQ(m.positions[2], Vec3f(1, 1, 0.5f));
  EXPECT_EQ(m.uv[1], (Uv{1, 0.25f}));  // as in the file
  EXPECT_TRUE(m.normals.empty());
  EXPECT_EQ(m.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {3, 2, 1}}));
}

TEST(Meshes, PlyAscii) {
  expect_the_square(ply(ply_header("ascii") +
                        "2 -3 4\n0 0 0 9 0 0\n1 0 0 9 1 .25\n+1 1 5e-1 9 1 1\n0 1 0 9 0 1\n"
                        "-1 4 0 1 2 3\n-1 3 3 2 1"));
}

TEST(Meshes, PlyBinaryOfEitherOrder) {
  for (const auto& [word, order] : {std::pair{"binary_little_endian", std::endian::little},
                                    std::pair{"binary_big_endian", std::endian::big}}) {
    const auto vertex = [o = order](double x, double y, double z, double v) {
      return as<float>({x, y, z}, o) + "r" + as<double>({x}, o) + as<float>({v}, o);
    };
    const std::string vertices = as<uint8_t>({2}) + as<int16_t>({-3, 4}, order) +
                                 vertex(0, 0, 0, 0) + vertex(1, 0, 0, 0.25) + vertex(1, 1, 0.5, 1) +
                                 vertex(0, 1, 0, 1);
    expect_the_square(ply(ply_header(word) + vertices + "t" + as<uint8_t>({4}) +
                          as<int32_t>({0, 1, 2, 3}, order) + "t" + as<uint8_t>({3}) +
                          as<int32_t>({3, 2, 1}, order)));
    expect_the_square(ply(ply_header(word, "uint uint16") + vertices + "t" +
                          as<uint32_t>({4}, order) + as<uint16_t>({0, 1, 2, 3}, order) + "t" +
                          as<uint32_t>({3}, order) + as<uint16_t>({3, 2, 1}, order)));
    expect_the_square(ply(ply_header(word, "short uint8") + vertices + "t" +
                          as<int16_t>({4}, order) + as<uint8_t>({0, 1, 2, 3}) + "t" +
                          as<int16_t>({3}, order) + as<uint8_t>({3, 2, 1})));
  }
}

std::string ply_triangle(const std::string& properties, const std::string& values) {
  return "ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float x\r\nproperty float y\r\n"
         "property float z\r\n" +
         properties + "element face 1\r\nproperty list int int vertex_index\r\nend_header\r\n" +
         values;
}

// Of old Macintoshes.
TEST(Meshes, PlyLinesThatEndInCarriageReturns) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
  std::replace(text.begin(), text.end(), '\n', '\r');
  // The first float begins with a byte that is a line end, too.
  text += as<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + as<uint8_t>({3, 0, 1, 2});
  text[text.find("end_header\r") + 11] = '\n';
  EXPECT_EQ(read_ply(text, "a.ply").triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST(Meshes, PlyNormalsAndTheNamesOfUv) {
  for (const auto& [u, v] :
       {std::pair{"u", "v"}, std::pair{"s", "t"}, std::pair{"texture_u", "texture_v"},
        std::pair{"texture_s", "texture_t"}}) {
    const Mesh m = ply(
        ply_triangle("property float nx\nproperty float ny\nproperty float nz\nproperty float " +
                         std::string(u) + "\nproperty float " + v + "\n",
                     "0 0 0 0 3 0 0.5 0.25\n1 0 0 nan 0 0 0 0\n0 1 0 0 1 0 nan 0\n3 0 1 2\n"));
    EXPECT_EQ(m.uv[0], (Uv{0.5f, 0.25f}));
    EXPECT_EQ(m.uv[2], (Uv{0, 0}));
    EXPECT_EQ(m.normals[0], Vec3f(0, 1, 0));
    EXPECT_EQ(m.normals[1], Vec3f());
  }
}

TEST(Meshes, PlySaysWhatIsWrongInItsHeader) {
  const auto header = [](const std::string& lines) {
    return ply_complaint("ply\nformat ascii 1.0\n" + lines + "end_header\n");
  };
  EXPECT_EQ(ply_complaint(""), "a.ply:header: ends before end_header");
  EXPECT_EQ(ply_complaint("plz\n"), "a.ply:line 1: is not \"ply\"");
  EXPECT_EQ(ply_complaint("ply\nend_header\n"), "a.ply:header: has no format");
  EXPECT_EQ(ply_complaint("ply\nformat ascii 1.0\n"), "a.ply:header: ends before end_header");
  for (const std::string line :
       {"format text 1.0", "elephant", "element vertex -1", "property int x"})
    EXPECT_EQ(ply_complaint("ply\n" + line + "\n"),
              "a.ply:line 2: \"" + line + "\" is no line of a PLY header");
  for (const std::string line : {"property int x y", "property half x"})
    EXPECT_EQ(header("element a 1\n" + line + "\n"),
              "a.ply:line 4: \"" + line + "\" is no line of a PLY header");
  EXPECT_EQ(header("element vertex 0\nproperty float x\n"),
            "a.ply:header: vertices have no x, y and z");
  EXPECT_EQ(header("element face 1\n"), "a.ply:header: faces have no list vertex_indices");
  EXPECT_EQ(header("element vertex 0\nproperty float x\nproperty float y\nproperty float z\n"),
            "a.ply: has no faces");
  EXPECT_EQ(header("element a 18446744073709551615\nproperty float x\n"),
            "a.ply:a 0: the file ends before it is complete");
  EXPECT_EQ(header("element a 18446744073709551615\n"), "a.ply: has no faces");
}

TEST(Meshes, PlySaysWhatIsWrongInItsValues) {
  const auto values = [](const std::string& text) { return ply_complaint(ply_triangle("", text)); };
  const std::string three = "0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_EQ(values(three + "3 0 1 2"), "");
  EXPECT_EQ(values("0 0 0\n1 zero 0\n0 1 0\n3 0 1 2"), "a.ply:vertex 1: \"zero\" is not a number");
  EXPECT_EQ(values("0 0 0\n1 nan 0\n0 1 0\n3 0 1 2"), "a.ply:vertex 1: its position is not finite");
  EXPECT_EQ(values("0 0 0\n1 1e39 0\n0 1 0\n3 0 1 2"),
            "a.ply:vertex 1: its position is not finite");
  EXPECT_EQ(values("0 0 0\n1 0 0\n0 1     "),
            "a.ply:vertex 2: the file ends before it is complete");
  EXPECT_EQ(values(three), "a.ply:face 0: the file ends before it is complete");
  EXPECT_EQ(values(three + "3 0 1"), "a.ply:face 0: the file ends before it is complete");
  EXPECT_EQ(values(three + "3 0 1 3"), "a.ply:face 0: refers to vertex 3, but the file has only 3");
  EXPECT_EQ(values(three + "3 0 1 -1"), "a.ply:face 0: -1 is no number of a vertex");
  EXPECT_EQ(values(three + "3 0 1 1.5"), "a.ply:face 0: 1.5 is no number of a vertex");
  EXPECT_EQ(values(three + "-3 0 1 2"), "a.ply:face 0: -3 is no length of a list");
  EXPECT_EQ(values(three + "2 0 1"), "a.ply: has no faces");
}

TEST(Meshes, PlyTruncatedAnywhereIsRefused) {
  const std::string whole =
      ply_header("binary_little_endian") + as<uint8_t>({0}) + std::string(4 * 25, '\0') + "t" +
      as<uint8_t>({3}) + as<int32_t>({0, 1, 2}) + "t" + as<uint8_t>({3}) + as<int32_t>({0, 1, 2});
  EXPECT_EQ(ply_complaint(whole), "");
  for (size_t n = 0; n < whole.size(); ++n) EXPECT_NE(ply_complaint(whole.substr(0, n)), "") << n;
}

// ---- WO3

std::string wo3_vertex(double x, double y, double z, double v) {
  return as<float>({x, y, z, 0, 0, 1, 0.5, v});
}
const std::string kWo3Vertices =
    as<uint64_t>({3}) + wo3_vertex(0, 0, 0, 0) + wo3_vertex(1, 0, 0, 0.25) + wo3_vertex(0, 1, 0, 1);
std::string wo3_complaint(const std::string& bytes) {
  return complaint([&] { read_wo3(bytes, "a.wo3"); });
}

TEST(Meshes, Wo3) {
  const Mesh m = read_wo3(kWo3Vertices + as<uint64_t>({1}) + as<int32_t>({0, 1, 2, -1}), "a.wo3");
  EXPECT_EQ(m.positions[1], Vec3f(1, 0, 0));
  EXPECT_EQ(m.normals[1], Vec3f(0, 0, 1));
  EXPECT_EQ(m.uv[1], (Uv{0.5f, 0.75f}));
  EXPECT_EQ(m.triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST(Meshes, Wo3SaysWhatIsWrong) {
  EXPECT_EQ(wo3_complaint("abc"), "a.wo3: should have 1 more bytes, but has bytes for only 0");
  EXPECT_EQ(wo3_complaint(as<uint64_t>({1e18})),
            "a.wo3: should have 1000000000000000000 more vertices, but has bytes for only 0");
  EXPECT_NE(wo3_complaint(kWo3Vertices), "");
  EXPECT_EQ(wo3_complaint(kWo3Vertices + as<uint64_t>({2}) + as<int32_t>({0, 1, 2, -1})),
            "a.wo3: should have 2 more triangles, but has bytes for only 1");
  EXPECT_EQ(wo3_complaint(kWo3Vertices + as<uint64_t>({0})), "a.wo3: has no faces");
  EXPECT_EQ(wo3_complaint(kWo3Vertices + as<uint64_t>({1}) + as<int32_t>({0, 1, 3, -1})),
            "a.wo3:face 0: refers to vertex 3, but the file has only 3");
  EXPECT_EQ(wo3_complaint(as<uint64_t>({1}) + wo3_vertex(0, kInf, 0, 0) + as<uint64_t>({1}) +
                          as<int32_t>({0, 0, 0, 0})),
            "a.wo3:vertex 0: its position is not finite");
}

// ---- .serialized

std::string packed(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, 0);
  compress(reinterpret_cast<Bytef*>(out.data()), &size,
           reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  return out.substr(0, size);
}
std::string magic(int version) {
  return as<uint16_t>({0x041C, double(version)});
}

template <class Real>
std::string shape_bytes(int version, unsigned flags, double height) {
  std::string b = as<uint32_t>({double(flags)});
  if (version == 4) b += std::string("a triangle\0", 11);
  b += as<uint64_t>({3, 1}) + as<Real>({0, 0, height, 1, 0, height, 0, 1, height});
  if (flags & 1) b += as<Real>({0, 0, 2, kNan, 0, 0, 0, 1, 0});
  if (flags & 2) b += as<Real>({0, 0, 1, 0.25, 0, 1});
  if (flags & 8) b += as<Real>({1, 1, 1, 1, 1, 1, 1, 1, 1});
  return b + as<uint32_t>({0, 1, 2});
}
Mesh serialized(const std::string& bytes, size_t index = 0) {
  return read_serialized(bytes, "a.serialized", index);
}
std::string serialized_complaint(const std::string& bytes, size_t index = 0) {
  return complaint([&] { serialized(bytes, index); });
}
/// Two shapes, at heights 0.5 and 2, with the list of their offsets.
std::string two_shapes(int version) {
  const std::string a = magic(version) + packed(shape_bytes<float>(version, 0x100b, 0.5));
  const std::string b = magic(version) + packed(shape_bytes<double>(version, 0x2003, 2));
  const double at = static_cast<double>(a.size());
  return a + b + (version == 3 ? as<uint32_t>({0, at}) : as<uint64_t>({0, at})) + as<uint32_t>({2});
}

TEST(Meshes, SerializedShapesOfBothVersionsAndPrecisions) {
  for (const int version : {3, 4})
    for (const size_t index : {0u, 1u}) {
      const Mesh m = serialized(two_shapes(version), index);
      EXPECT_EQ(m.positions,
                (std::vector<Vec3f>{
                    {0, 0, index ? 2 : 0.5f}, {1, 0, index ? 2 : 0.5f}, {0, 1, index ? 2 : 0.5f}}));
      EXPECT_EQ(m.normals, (std::vector<Vec3f>{{0, 0, 1}, {}, {0, 1, 0}}));
      EXPECT_EQ(m.uv[1], (Uv{1, 0.25f}));  // as in the file
      EXPECT_EQ(m.triangles, (std::vector<Triangle>{{0, 1, 2}}));
    }
}

TEST(Meshes, SerializedWithoutListOrWithFaceNormals) {
  const Mesh plain = serialized(magic(4) + packed(shape_bytes<float>(4, 0, 0)));
  EXPECT_TRUE(plain.normals.empty() && plain.uv.empty());
  EXPECT_TRUE(serialized(magic(4) + packed(shape_bytes<float>(4, 0x1011, 0))).normals.empty());
}

TEST(Meshes, SerializedSaysWhatIsWrong) {
  const std::string good = shape_bytes<float>(4, 0x1003, 0);
  EXPECT_EQ(serialized_complaint(""), "a.serialized: is not in Mitsuba's .serialized format");
  EXPECT_EQ(serialized_complaint("PK345678"),
            "a.serialized: is not in Mitsuba's .serialized format");
  EXPECT_EQ(serialized_complaint(magic(5) + packed(good)),
            "a.serialized: is of version 5, expected 3 or 4");
  EXPECT_EQ(serialized_complaint(two_shapes(4), 2), "a.serialized: has no shape 2, only 2");
  EXPECT_EQ(serialized_complaint(magic(4) + as<uint32_t>({1000}), 3),
            "a.serialized: has no shape 3, only 1000");
  for (const double offset : {4., 99.})
    EXPECT_EQ(serialized_complaint(magic(4) + as<uint64_t>({0, offset}) + as<uint32_t>({2}), 1),
              "a.serialized:shape 1: does not begin where the file's list says");
  EXPECT_EQ(serialized_complaint(magic(4) + "not zlib"),
            "a.serialized:shape 0: its compressed data are damaged");
  EXPECT_EQ(serialized_complaint(magic(4) + packed(good.substr(0, good.size() - 1))),
            "a.serialized:shape 0: should have 1 more triangles, but has bytes for only 0");
  const std::string whole = magic(4) + packed(good);
  EXPECT_EQ(serialized_complaint(whole), "");
  for (size_t n = 8; n + 8 < whole.size(); ++n)
    EXPECT_EQ(serialized_complaint(whole.substr(0, n)),
              "a.serialized:shape 0: its compressed data end early")
        << n;
  const std::string liar =
      as<uint32_t>({0x1000}) + "a" + std::string(1, '\0') + as<uint64_t>({1e15, 4});
  EXPECT_EQ(serialized_complaint(magic(4) + packed(liar)),
            "a.serialized:shape 0: should have 1000000000000000 more vertices, but has bytes for "
            "only 0");
  std::string far = shape_bytes<float>(4, 0, 0);
  far[far.size() - 4] = 9;
  EXPECT_EQ(serialized_complaint(magic(4) + packed(far)),
            "a.serialized:face 0: refers to vertex 9, but the file has only 3");
}

TEST(Meshes, SerializedZerosTakeNoMoreThanMaxMemory) {
  const uint64_t before = memory_limit();
  limit_memory(1 << 20);
  const std::string zeros = as<uint32_t>({0x1000}) + std::string(1, '\0') +
                            as<uint64_t>({100000, 1}) + std::string(1200012, '\0');
  const std::string words = serialized_complaint(magic(4) + packed(zeros));
  limit_memory(before);
  EXPECT_TRUE(words.find("of inflated data") != words.npos) << words;
}

}  // namespace tdpt::foreign::meshes_test
