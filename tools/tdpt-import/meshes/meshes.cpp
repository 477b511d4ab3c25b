#include "tools/tdpt-import/meshes/meshes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <zlib.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"

namespace tdpt::foreign {
namespace {

Vec3d position(const Mesh& mesh, uint32_t vertex) {
  const Vec3f& p = mesh.positions[vertex];
  return {p.x, p.y, p.z};
}

bool is_unit(const Vec3f& n) {
  return n.x != 0 || n.y != 0 || n.z != 0;
}

// In double precision, since squares of small or large floats leave the range of float.
Vec3f unit_or_zero(const Vec3d& n) {
  const double l = length(n);
  if (!(l > 0) || !std::isfinite(l)) return {};
  return {static_cast<float>(n.x / l), static_cast<float>(n.y / l), static_cast<float>(n.z / l)};
}

void mend_normals(Mesh& mesh) {
  size_t usable = 0;
  for (Vec3f& n : mesh.normals) {
    n = unit_or_zero({n.x, n.y, n.z});
    usable += is_unit(n);
  }
  if (usable == 0) mesh.normals.clear();
  if (usable == mesh.normals.size()) return;
  std::vector<Vec3d> sums(mesh.positions.size());  // weighted by area
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3d at = position(mesh, a);
    const Vec3d n = cross(position(mesh, b) - at, position(mesh, c) - at);
    for (const uint32_t corner : {a, b, c}) sums[corner] = sums[corner] + n;
  }
  for (size_t i = 0; i < sums.size(); ++i) {
    if (is_unit(mesh.normals[i])) continue;
    mesh.normals[i] = unit_or_zero(sums[i]);
    if (!is_unit(mesh.normals[i])) mesh.normals[i] = {0, 0, 1};  // only of triangles without area
  }
}

}  // namespace

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
enum Flags : uint32_t { normals = 1, uv = 2, colours = 8, face_normals = 0x10, in_double = 0x2000 };

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

  void read(void* to, size_t size) {
    z_.next_out = static_cast<Bytef*>(to);
    z_.avail_out = static_cast<uInt>(size);
    while (z_.avail_out > 0) {
      if (z_.avail_in == 0) {
        const size_t some = std::min(packed_.size(), size_t{1} << 30);
        z_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed_.data()));
        z_.avail_in = static_cast<uInt>(some);
        packed_.remove_prefix(some);
      }
      const int state = inflate(&z_, Z_NO_FLUSH);
      if (z_.avail_out == 0) return;
      if (state == Z_STREAM_END) fail("its compressed data end early");
      if (state == Z_BUF_ERROR) fail("the file ends within its compressed data");
      if (state != Z_OK) fail("its compressed data are damaged");
    }
  }
  template <class T>
  T value() {
    char bytes[sizeof(T)];
    read(bytes, sizeof(T));
    return value_at<T>(bytes);
  }

  /// Calls `use` with each of `n` records of `width` values.
  template <class T, class Use>
  void records(uint64_t n, size_t width, const Use& use) {
    constexpr size_t at_once = 1024;
    std::vector<char> bytes(at_once * width * sizeof(T));
    for (uint64_t first = 0; first < n; first += at_once) {
      const auto some = static_cast<size_t>(std::min<uint64_t>(n - first, at_once));
      read(bytes.data(), some * width * sizeof(T));
      for (size_t i = 0; i < some; ++i)
        use([&, i](size_t k) { return value_at<T>(&bytes[(i * width + k) * sizeof(T)]); });
    }
  }

 private:
  z_stream z_{};
  std::string_view packed_;
  const std::string& name_;
  const std::string& place_;
};

template <class Real>
void read_vertices(Inflater& in, uint32_t flags, uint64_t count, Mesh& mesh) {
  const auto f = [](const auto& values, size_t k) { return static_cast<float>(values(k)); };
  in.records<Real>(count, 3, [&](const auto& v) {
    mesh.positions.push_back({f(v, 0), f(v, 1), f(v, 2)});
  });
  if (flags & normals)
    in.records<Real>(count, 3, [&](const auto& v) {
      if (!(flags & face_normals)) mesh.normals.push_back({f(v, 0), f(v, 1), f(v, 2)});
    });
  if (flags & uv)
    in.records<Real>(count, 2, [&](const auto& v) { mesh.uv.push_back({f(v, 0), f(v, 1)}); });
  if (flags & colours) in.records<Real>(count, 3, [](const auto&) {});
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
  const uint64_t real = flags & in_double ? 8 : 4;
  const uint64_t vertex =
      real * (3 + (flags & normals ? 3 : 0) + (flags & uv ? 2 : 0) + (flags & colours ? 3 : 0));
  // deflate shortens to a 1032nd at most.
  const uint64_t most = in.packed_left() * 1032 + 65536;
  if (vertices > most / vertex || triangles > (most - vertices * vertex) / 12)
    in.fail(fmt::format("{} vertices and {} triangles are more than its compressed data can hold",
                        vertices, triangles));
  expect_memory(name, place, fmt::format("{} vertices and {} triangles", vertices, triangles),
                vertices * sizeof(float) * 8 + triangles * 12);
  Mesh mesh;
  if (flags & in_double)
    read_vertices<double>(in, flags, vertices, mesh);
  else
    read_vertices<float>(in, flags, vertices, mesh);
  in.records<uint32_t>(triangles, 3, [&](const auto& v) {
    mesh.triangles.push_back({v(0), v(1), v(2)});
  });
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
