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
  bool is_any_usable = false;
  for (Vec3f& n : mesh.normals) {
    // In double precision, since squares of small or large floats leave the range of float.
    const double l = length(in_double(n));
    n = l > 0 && std::isfinite(l) ? in_single(in_double(n) / l) : Vec3f{};
    is_any_usable |= n != Vec3f{};
  }
  if (!is_any_usable) mesh.normals.clear();
}

std::string inflated(std::string_view packed, const std::string& name, const std::string& place) {
  constexpr size_t kStep = size_t{1} << 18;
  constexpr int kZlibOrGzip = 32 + MAX_WBITS;
  z_stream z{};
  if (inflateInit2(&z, kZlibOrGzip) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&z, inflateEnd);
  std::string out;
  for (int state = Z_OK; state != Z_STREAM_END;) {
    if (z.avail_in == 0) {  // zlib counts in 32 bits
      z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
      z.avail_in = static_cast<uInt>(std::min(packed.size(), kStep));
      packed.remove_prefix(z.avail_in);
    }
    const size_t before = out.size();
    expect_memory(name, place, size_words(before + kStep) + " of inflated data", before + kStep);
    out.resize(before + kStep);
    z.next_out = reinterpret_cast<Bytef*>(out.data() + before);
    z.avail_out = static_cast<uInt>(kStep);
    state = inflate(&z, Z_NO_FLUSH);
    out.resize(out.size() - z.avail_out);
    if (state == Z_BUF_ERROR) throw InputError(name, place, "its compressed data end early");
    if (state != Z_OK && state != Z_STREAM_END)
      throw InputError(name, place, "its compressed data are damaged");
  }
  return out;
}

namespace {

// Takes little-endian values off the front of bytes.
class BinaryReader {
 public:
  BinaryReader(std::string_view bytes, const std::string& name, const std::string& place)
      : rest_(bytes), name_(name), place_(place) {}

  template <class T>
  T value() {
    expect(1, sizeof(T), "bytes");
    const T out = value_at<T>(rest_.data());
    rest_.remove_prefix(sizeof(T));
    return out;
  }

  /// Fails unless there are bytes for so many things of this size.
  void expect(uint64_t count, size_t size, const char* what) const {
    if (count > rest_.size() / size)
      throw InputError(name_, place_,
                       fmt::format("should have {} more {}, but has bytes for only {}", count, what,
                                   rest_.size() / size));
  }

 private:
  std::string_view rest_;
  std::string name_, place_;
};

// Mitsuba's .serialized, versions 3 and 4, little-endian. Each shape: the magic number and version
// (16 bits each), then a zlib stream of flags, in version 4 a name that ends with 0, counts of
// vertices and triangles (64 bits each), and arrays of positions, normals, texture coordinates,
// colours and corners. The file ends with the offset of each shape (64 bits, in version 3 32) and
// their number.

constexpr uint16_t kMagic = 0x041C;
enum Flags : uint32_t { normals = 1, uv = 2, colours = 8, face_normals = 0x10, doubles = 0x2000 };

// The bytes from where shape `index` begins.
std::string_view shape_in(std::string_view bytes, size_t index, size_t width,
                          const std::string& name) {
  if (index == 0) return bytes;  // also of files without a list
  const auto count = value_at<uint32_t>(bytes.data() + bytes.size() - 4);
  if (index >= count || count > (bytes.size() - 4) / width)
    throw InputError(name, "", fmt::format("has no shape {}, only {}", index, count));
  const char* at = bytes.data() + bytes.size() - 4 - width * (count - index);
  const uint64_t offset = width == 4 ? value_at<uint32_t>(at) : value_at<uint64_t>(at);
  const std::string_view shape = bytes.substr(std::min<uint64_t>(offset, bytes.size()));
  if (shape.size() < 4 || value_at<uint16_t>(shape.data()) != kMagic)
    throw InputError(name, fmt::format("shape {}", index),
                     "does not begin where the file's list says");
  return shape;
}

}  // namespace

Mesh read_serialized(std::string_view bytes, const std::string& name, size_t index) {
  if (bytes.size() < 8 || value_at<uint16_t>(bytes.data()) != kMagic)
    throw InputError(name, "", "is not in Mitsuba's .serialized format");
  const auto version = value_at<uint16_t>(bytes.data() + 2);
  if (version != 3 && version != 4)
    throw InputError(name, "", fmt::format("is of version {}, expected 3 or 4", version));
  const std::string place = fmt::format("shape {}", index);
  const std::string shape =
      inflated(shape_in(bytes, index, version == 3 ? 4 : 8, name).substr(4), name, place);
  BinaryReader in(shape, name, place);
  const auto flags = in.value<uint32_t>();
  if (version == 4)
    while (in.value<char>() != 0) continue;  // its name
  const auto vertices = in.value<uint64_t>(), triangles = in.value<uint64_t>();
  const auto real = [&] {
    return flags & doubles ? static_cast<float>(in.value<double>()) : in.value<float>();
  };
  const auto vectors = [&](bool is_there) {
    in.expect(is_there ? vertices : 0, 3 * sizeof(float), "vertices");
    std::vector<Vec3f> all(is_there ? vertices : 0);
    for (Vec3f& v : all) {
      const float x = real(), y = real();
      v = {x, y, real()};
    }
    return all;
  };
  Mesh mesh;
  mesh.positions = vectors(true);
  mesh.normals = vectors(flags & normals);
  if (flags & face_normals) mesh.normals.clear();
  mesh.uv.resize(flags & uv ? vertices : 0);
  for (auto& [u, v] : mesh.uv) u = real(), v = real();
  vectors(flags & colours);
  in.expect(triangles, 12, "triangles");
  mesh.triangles.resize(triangles);
  for (auto& corners : mesh.triangles)
    for (uint32_t& corner : corners) corner = in.value<uint32_t>();
  check(mesh, name);
  return mesh;
}

// Tungsten's .wo3, little-endian: a count (64 bits) of vertices and these, each a position, a
// normal and uv as 8 floats; a count of triangles and these, each 3 corners and a material as 4
// integers.
Mesh read_wo3(std::string_view bytes, const std::string& name) {
  BinaryReader in(bytes, name, "");
  Mesh mesh;
  const auto vertices = in.value<uint64_t>();
  in.expect(vertices, 8 * sizeof(float), "vertices");
  for (uint64_t i = 0; i < vertices; ++i) {
    float v[8];
    for (float& x : v) x = in.value<float>();
    mesh.positions.push_back({v[0], v[1], v[2]});
    mesh.normals.push_back({v[3], v[4], v[5]});
    mesh.uv.push_back({v[6], v[7]});
  }
  const auto triangles = in.value<uint64_t>();
  in.expect(triangles, 16, "triangles");
  for (uint64_t i = 0; i < triangles; ++i) {
    std::array<uint32_t, 4> t;
    for (uint32_t& x : t) x = in.value<uint32_t>();
    mesh.triangles.push_back({t[0], t[1], t[2]});
  }
  check(mesh, name);
  flip_v(mesh);
  return mesh;
}

}  // namespace tdpt::foreign
