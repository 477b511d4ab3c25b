#include "tools/tdpt-import/meshes/meshes.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <zlib.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"

namespace tdpt::foreign {
namespace {

bool is_unit(const Vec3f& n) {
  return n.x != 0 || n.y != 0 || n.z != 0;
}

// In double precision, since squares of small or large floats leave the range of float.
Vec3f unit_or_zero(const Vec3d& n) {
  const double l = length(n);
  return l > 0 && std::isfinite(l) ? in_single(n / l) : Vec3f{};
}

void mend_normals(Mesh& mesh) {
  size_t usable = 0;
  for (Vec3f& n : mesh.normals) {
    n = unit_or_zero(in_double(n));
    usable += is_unit(n);
  }
  if (usable == 0) mesh.normals.clear();
  if (usable == mesh.normals.size()) return;
  std::vector<Vec3d> sums(mesh.positions.size());  // weighted by area
  for (const auto& corners : mesh.triangles)
    for (const uint32_t corner : corners) sums[corner] = sums[corner] + front_of(mesh, corners);
  for (size_t i = 0; i < sums.size(); ++i) {
    if (is_unit(mesh.normals[i])) continue;
    mesh.normals[i] = unit_or_zero(sums[i]);
    if (!is_unit(mesh.normals[i])) mesh.normals[i] = {0, 0, 1};  // only of triangles without area
  }
}

}  // namespace

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (size_t at = 0; (at = line.find_first_not_of(" \t\r", at)) != line.npos;) {
    const size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

std::optional<double> number_in(std::string_view word) {
  double number = 0;
  const char* begin = word.begin() + (word.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, word.end(), number);
  if (error == std::errc::invalid_argument || end != word.end()) return {};
  return error == std::errc() ? number : std::strtod(std::string(begin, end).c_str(), nullptr);
}

void check(Mesh& mesh, const std::string& name) {
  if (mesh.triangles.empty()) throw InputError(name, "", "has no faces");
  for (size_t i = 0; i < mesh.positions.size(); ++i)
    if (!is_finite(mesh.positions[i]))
      throw InputError(name, fmt::format("vertex {}", i), "its position is not finite");
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const uint32_t corner : mesh.triangles[i])
      if (corner >= mesh.positions.size())
        throw InputError(name, fmt::format("face {}", i),
                         fmt::format("refers to vertex {}, but the file has only {}", corner,
                                     mesh.positions.size()));
  for (auto& uv : mesh.uv)
    for (float& x : uv)
      if (!std::isfinite(x)) x = 0;
  mend_normals(mesh);
}

namespace {

// Mitsuba's .serialized, versions 3 and 4, little-endian. Each shape: the magic number and version
// (16 bits each), then a zlib stream of flags, in version 4 a name that ends with 0, counts of
// vertices and triangles (64 bits each), and arrays of positions, normals, texture coordinates,
// colours and corners. The file ends with the offset of each shape (64 bits, in version 3 32) and
// their number.

constexpr uint16_t kMagic = 0x041C;
enum Flags : uint32_t { normals = 1, uv = 2, colours = 8, face_normals = 0x10, doubles = 0x2000 };

class Inflater {
 public:
  Inflater(std::string_view packed, const std::string& name, const std::string& place)
      : packed_(packed), name_(name), place_(place) {
    if (inflateInit(&z_) != Z_OK) throw Error(Exit::internal, "zlib does not start");
  }
  ~Inflater() { inflateEnd(&z_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  [[noreturn]] void fail(const std::string& words) const { throw InputError(name_, place_, words); }

  /// Bytes that are not unpacked yet.
  size_t packed_left() const { return packed_.size() + z_.avail_in; }

  template <class T>
  std::vector<T> values(uint64_t n) {
    std::vector<T> all(n);
    read(reinterpret_cast<char*>(all.data()), n * sizeof(T));
    for (T& value : all) value = value_at<T>(reinterpret_cast<const char*>(&value));
    return all;
  }
  template <class T>
  T value() {
    return values<T>(1)[0];
  }

 private:
  void read(char* to, size_t size) {
    constexpr size_t most = size_t{1} << 30;  // at once: zlib counts in 32 bits
    while (size > 0) {
      if (z_.avail_in == 0) {
        z_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed_.data()));
        z_.avail_in = static_cast<uInt>(std::min(packed_.size(), most));
        packed_.remove_prefix(z_.avail_in);
      }
      const size_t wanted = std::min(size, most);
      z_.next_out = reinterpret_cast<Bytef*>(to);
      z_.avail_out = static_cast<uInt>(wanted);
      const int state = inflate(&z_, Z_NO_FLUSH);
      to += wanted - z_.avail_out, size -= wanted - z_.avail_out;
      if (size == 0) return;
      if (state == Z_STREAM_END) fail("its compressed data end early");
      if (state == Z_BUF_ERROR) fail("the file ends within its compressed data");
      if (state != Z_OK) fail("its compressed data are damaged");
    }
  }

  z_stream z_{};
  std::string_view packed_;
  const std::string& name_;
  const std::string& place_;
};

template <class Real>
void read_vertices(Inflater& in, uint32_t flags, uint64_t count, Mesh& mesh) {
  const auto vectors = [&] {
    const auto v = in.values<Real>(3 * count);
    std::vector<Vec3f> all;
    for (size_t i = 0; i < v.size(); i += 3)
      all.push_back(in_single({double{v[i]}, double{v[i + 1]}, double{v[i + 2]}}));
    return all;
  };
  mesh.positions = vectors();
  if (flags & normals) mesh.normals = vectors();
  if (flags & face_normals) mesh.normals.clear();
  const auto v = in.values<Real>(flags & uv ? 2 * count : 0);
  for (size_t i = 0; i < v.size(); i += 2)
    mesh.uv.push_back({static_cast<float>(v[i]), static_cast<float>(v[i + 1])});
  if (flags & colours) vectors();
}

// Where shape `index` begins.
size_t offset_of(std::string_view bytes, size_t index, uint16_t version, const std::string& name) {
  if (index == 0) return 0;  // also of files without a dictionary
  const size_t width = version == 3 ? 4 : 8;
  const auto count = value_at<uint32_t>(bytes.data() + bytes.size() - 4);
  if (index >= count)
    throw InputError(name, "", fmt::format("has no shape {}, only {}", index, count));
  if (count > (bytes.size() - 4) / width)
    throw InputError(name, "", fmt::format("is too short for a list of {} shapes", count));
  const char* at = bytes.data() + bytes.size() - 4 - width * (count - index);
  const uint64_t offset = version == 3 ? value_at<uint32_t>(at) : value_at<uint64_t>(at);
  if (offset > bytes.size() - 4)
    throw InputError(name, fmt::format("shape {}", index), "begins outside the file");
  return offset;
}

}  // namespace

Mesh read_serialized(std::string_view bytes, const std::string& name, size_t index) {
  if (bytes.size() < 8 || value_at<uint16_t>(bytes.data()) != kMagic)
    throw InputError(name, "", "is not in Mitsuba's .serialized format");
  const auto version = value_at<uint16_t>(bytes.data() + 2);
  if (version != 3 && version != 4)
    throw InputError(name, "", fmt::format("is of version {}, expected 3 or 4", version));
  const std::string place = fmt::format("shape {}", index);
  const std::string_view shape = bytes.substr(offset_of(bytes, index, version, name));
  if (value_at<uint16_t>(shape.data()) != kMagic)
    throw InputError(name, place, "does not begin where the file's list says");
  Inflater in(shape.substr(4), name, place);
  const auto flags = in.value<uint32_t>();
  if (version == 4)
    while (in.value<char>() != 0) continue;  // its name
  const auto vertices = in.value<uint64_t>(), triangles = in.value<uint64_t>();
  const uint64_t real = flags & doubles ? 8 : 4;
  const uint64_t vertex =
      real * (3 + (flags & normals ? 3 : 0) + (flags & uv ? 2 : 0) + (flags & colours ? 3 : 0));
  // deflate shortens to a 1032nd at most.
  const uint64_t most = in.packed_left() * 1032 + 65536;
  if (vertices > most / vertex || triangles > (most - vertices * vertex) / 12)
    in.fail(fmt::format("{} vertices and {} triangles are more than its compressed data can hold",
                        vertices, triangles));
  expect_memory(name, place, fmt::format("{} vertices and {} triangles", vertices, triangles),
                vertices * (8 * sizeof(float) + 3 * real) + triangles * 24);
  Mesh mesh;
  if (flags & doubles)
    read_vertices<double>(in, flags, vertices, mesh);
  else
    read_vertices<float>(in, flags, vertices, mesh);
  const auto corners = in.values<uint32_t>(3 * triangles);
  for (size_t i = 0; i < corners.size(); i += 3)
    mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  check(mesh, name);
  return mesh;
}

namespace {

// Tungsten's .wo3, little-endian: a count (64 bits) of vertices and these, each a position, a
// normal and uv as 8 floats; a count of triangles and these, each 3 corners and a material as 4
// integers.

// Takes a count and that many records off the front of `bytes`.
std::string_view records(std::string_view& bytes, size_t size, const char* what,
                         const std::string& name) {
  if (bytes.size() < 8) throw InputError(name, "", fmt::format("ends before its {}", what));
  const auto count = value_at<uint64_t>(bytes.data());
  bytes.remove_prefix(8);
  if (count > bytes.size() / size)
    throw InputError(name, "",
                     fmt::format("has {} {} by its count, but bytes for only {}", count, what,
                                 bytes.size() / size));
  const std::string_view taken = bytes.substr(0, count * size);
  bytes.remove_prefix(taken.size());
  return taken;
}

}  // namespace

Mesh read_wo3(std::string_view bytes, const std::string& name) {
  constexpr size_t vertex_size = 32, triangle_size = 16;
  const std::string_view vertices = records(bytes, vertex_size, "vertices", name);
  const std::string_view triangles = records(bytes, triangle_size, "triangles", name);
  if (!bytes.empty())
    throw InputError(name, "", counted(bytes.size(), "byte") + " after the last triangle");
  Mesh mesh;
  for (size_t at = 0; at < vertices.size(); at += vertex_size) {
    const auto f = [&](size_t i) { return value_at<float>(vertices.data() + at + 4 * i); };
    mesh.positions.push_back({f(0), f(1), f(2)});
    mesh.normals.push_back({f(3), f(4), f(5)});
    mesh.uv.push_back({f(6), f(7)});
  }
  for (size_t at = 0; at < triangles.size(); at += triangle_size) {
    const auto corner = [&](size_t i) { return value_at<uint32_t>(triangles.data() + at + 4 * i); };
    mesh.triangles.push_back({corner(0), corner(1), corner(2)});
  }
  check(mesh, name);
  flip_v(mesh);
  return mesh;
}

}  // namespace tdpt::foreign
