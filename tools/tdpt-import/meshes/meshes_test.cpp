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

// Each of the files is refused with the words; "" is not refused.
template <class Read>
void expect_complaints(const Read& read, const std::string& name,
                       const std::vector<std::pair<std::string, std::string>>& files) {
  for (size_t i = 0; i < files.size(); ++i) {
    std::string said;
    try {
      read(files[i].first, name);
    } catch (const InputError& e) {
      said = e.what();
    }
    const std::string& words = files[i].second;
    EXPECT_EQ(said.empty(), words.empty()) << "file " << i << ": " << said;
    EXPECT_TRUE(said.starts_with(said.empty() ? "" : name + ":")) << said;
    EXPECT_NE(said.find(words), said.npos) << "file " << i << ": " << said;
  }
}

// ---- OBJ

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

Mesh obj(const std::string& text) {
  return read_obj(text, "a.obj");
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
    EXPECT_EQ(obj(text + "f 1 2 3 \\").triangles.size(), 3u);  // at the end of the file
    expect_complaints(read_obj, "a.obj",
                      {{text + "f 1 2 \\" + end + "9" + end, ":line 10: "},
                       {text + "f 1.5 2 3" + end, ":line 10: \"1.5\" is no index"}});
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
  expect_complaints(read_obj, "a.obj",
                    {{"", "no faces"},
                     {kSquare + "f 1 2\n", "no faces"},
                     {"v 0 0\n", "line 1: has 2 of 3"},
                     {"\n\nv 0 x 0\nv 1 1 1\n", "line 3: its position is not finite"},
                     {"v 0 1e 0", "line 1: its position is not finite"},
                     {"v 0 1e39 0", "line 1: its position is not finite"},
                     {"v 0 1e999 0", "line 1: its position is not finite"},
                     {"vn 0 1", "line 1: has 2 of 3"},
                     {"vt ", "line 1: has 0 of 1"},
                     {kSquare + "f 1 2 5\n", "line 5: refers to vertex 5"},
                     {kSquare + "\r\nf 1 2 -5", "line 6: refers to vertex -5"},
                     {kSquare + "f 0 1 2\n", "line 5: refers to vertex 0"},
                     {kSquare + "f 4294967297 2 3\n", "line 5: refers to vertex 4294967297"},
                     {kSquare + "f 1/1 2/1 3/1\n", "line 5: refers to texture coordinate 1"},
                     {kSquare + "f 1//1 2//1 3//1\n", "line 5: refers to normal 1"}});
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
  const std::string ascii = "ply\nformat ascii 1.0\n", end = "end_header\n";
  const std::string vertices = "element vertex 0\nproperty float x\n";
  const std::string huge = "element a 18446744073709551615\n";
  expect_complaints(read_ply, "a.ply",
                    {{"", "header: ends before"},
                     {ascii, "header: ends before"},
                     {"plz\n", "line 1: is not \"ply\""},
                     {"ply\nend_header\n", "header: has no format"},
                     {"ply\nformat text 1.0\n", "line 2: \"format text 1.0\""},
                     {"ply\nelephant\n", "line 2: \"elephant\""},
                     {"ply\nelement vertex -1\n", "line 2: \"element vertex -1\""},
                     {"ply\nproperty int x\n", "line 2: \"property int x\""},
                     {ascii + "element a 1\nproperty int x y\n", "line 4: \"property int x y\""},
                     {ascii + "element a 1\nproperty half x\n", "line 4: \"property half x\""},
                     {ascii + vertices + end, "header: vertices have no x, y and z"},
                     {ascii + "element face 1\n" + end, "header: faces have no list"},
                     {ascii + huge + "property float x\n" + end, "a 0: the file ends before"},
                     {ascii + huge + end, "no faces"}});
}

TEST(Meshes, PlySaysWhatIsWrongInItsValues) {
  std::vector<std::pair<std::string, std::string>> files{
      {"0 0 0\n1 zero 0\n0 1 0\n3 0 1 2", "vertex 1: \"zero\" is not a number"},
      {"0 0 0\n1 nan 0\n0 1 0\n3 0 1 2", "vertex 1: its position is not finite"},
      {"0 0 0\n1 1e39 0\n0 1 0\n3 0 1 2", "vertex 1: its position is not finite"},
      {"0 0 0\n1 0 0\n0 1     ", "vertex 2: the file ends before"}};
  const std::string three = "0 0 0\n1 0 0\n0 1 0\n";
  for (const auto& [face, words] :
       std::vector<std::pair<std::string, std::string>>{{"3 0 1 2", ""},
                                                        {"", "face 0: the file ends before"},
                                                        {"3 0 1", "face 0: the file ends before"},
                                                        {"3 0 1 3", "face 0: refers to vertex 3"},
                                                        {"3 0 1 -1", "face 0: -1 is no number"},
                                                        {"3 0 1 1.5", "face 0: 1.5 is no number"},
                                                        {"-3 0 1 2", "face 0: -3 is no length"},
                                                        {"2 0 1", "no faces"}})
    files.push_back({three + face, words});
  for (auto& [values, words] : files) values = ply_triangle("", values);
  expect_complaints(read_ply, "a.ply", files);
}

TEST(Meshes, PlyTruncatedAnywhereIsRefused) {
  const std::string whole =
      ply_header("binary_little_endian") + as<uint8_t>({0}) + std::string(4 * 25, '\0') + "t" +
      as<uint8_t>({3}) + as<int32_t>({0, 1, 2}) + "t" + as<uint8_t>({3}) + as<int32_t>({0, 1, 2});
  EXPECT_EQ(ply(whole).triangles.size(), 2u);
  for (size_t n = 0; n < whole.size(); ++n)
    expect_complaints(read_ply, "a.ply", {{whole.substr(0, n), ": "}});
}

// ---- WO3

std::string wo3_vertex(double x, double y, double z, double v) {
  return as<float>({x, y, z, 0, 0, 1, 0.5, v});
}
const std::string kWo3Vertices =
    as<uint64_t>({3}) + wo3_vertex(0, 0, 0, 0) + wo3_vertex(1, 0, 0, 0.25) + wo3_vertex(0, 1, 0, 1);

TEST(Meshes, Wo3) {
  const Mesh m = read_wo3(kWo3Vertices + as<uint64_t>({1}) + as<int32_t>({0, 1, 2, -1}), "a.wo3");
  EXPECT_EQ(m.positions[1], Vec3f(1, 0, 0));
  EXPECT_EQ(m.normals[1], Vec3f(0, 0, 1));
  EXPECT_EQ(m.uv[1], (Uv{0.5f, 0.75f}));
  EXPECT_EQ(m.triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST(Meshes, Wo3SaysWhatIsWrong) {
  const auto faces = [](double n, std::initializer_list<double> corners = {}) {
    return kWo3Vertices + as<uint64_t>({n}) + as<int32_t>(corners);
  };
  expect_complaints(read_wo3, "a.wo3",
                    {{"abc", "should have 1 more bytes"},
                     {as<uint64_t>({1e18}), "should have 1000000000000000000 more vertices"},
                     {kWo3Vertices, ": "},
                     {faces(2, {0, 1, 2, -1}), "should have 2 more triangles"},
                     {faces(1, {0, 1, 3, -1}), "face 0: refers to vertex 3"},
                     {as<uint64_t>({1}) + wo3_vertex(0, kInf, 0, 0) + as<uint64_t>({1}) +
                          as<int32_t>({0, 0, 0, 0}),
                      "vertex 0: its position is not finite"}});
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
  const std::string good = shape_bytes<float>(4, 0x1003, 0), whole = magic(4) + packed(good);
  const std::string liar =
      as<uint32_t>({0x1000}) + "a" + std::string(1, '\0') + as<uint64_t>({1e15, 4});
  std::string far = shape_bytes<float>(4, 0, 0);
  far[far.size() - 4] = 9;
  const auto shape = [](size_t index) {
    return [=](const std::string& bytes, const std::string& name) {
      read_serialized(bytes, name, index);
    };
  };
  std::vector<std::pair<std::string, std::string>> files{
      {"", "is not in Mitsuba's .serialized"},
      {"PK345678", "is not in Mitsuba's .serialized"},
      {magic(5) + packed(good), "is of version 5"},
      {magic(4) + "not zlib", "shape 0: its compressed data are damaged"},
      {magic(4) + packed(good.substr(0, good.size() - 1)), "shape 0: should have 1 more triangles"},
      {magic(4) + packed(liar), "shape 0: should have 1000000000000000 more vertices"},
      {magic(4) + packed(far), "face 0: refers to vertex 9"},
      {whole, ""}};
  for (size_t n = 8; n + 8 < whole.size(); ++n)
    files.push_back({whole.substr(0, n), "shape 0: its compressed data end early"});
  expect_complaints(shape(0), "a.serialized", files);
  expect_complaints(shape(2), "a.serialized", {{two_shapes(4), "has no shape 2, only 2"}});
  expect_complaints(
      shape(1), "a.serialized",
      {{magic(4) + as<uint64_t>({0, 4}) + as<uint32_t>({2}), "shape 1: does not begin"},
       {magic(4) + as<uint64_t>({0, 99}) + as<uint32_t>({2}), "shape 1: does not begin"}});
}

TEST(Meshes, SerializedZerosTakeNoMoreThanMaxMemory) {
  const uint64_t before = memory_limit();
  limit_memory(1 << 20);
  const std::string zeros = as<uint32_t>({0x1000}) + std::string(1, '\0') +
                            as<uint64_t>({100000, 1}) + std::string(1200012, '\0');
  const auto read = [](const std::string& bytes, const std::string&) { serialized(bytes); };
  expect_complaints(read, "a.serialized", {{magic(4) + packed(zeros), "of inflated data"}});
  limit_memory(before);
}

}  // namespace tdpt::foreign::meshes_test
