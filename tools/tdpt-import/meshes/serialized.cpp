// Mitsuba's .serialized, versions 3 and 4, little-endian. Each shape: the magic number and version
// (16 bits each), then a zlib stream of flags, in version 4 a name that ends with 0, counts of
// vertices and triangles (64 bits each), and arrays of positions, normals, texture coordinates,
// colours and corners. The file ends with the offset of each shape (64 bits, in version 3 32) and
// their number.
#include <zlib.h>

#include <fmt/format.h>
#include <algorithm>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "tools/tdpt-import/meshes/checked.h"
#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign {
namespace {

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

}  // namespace tdpt::foreign
