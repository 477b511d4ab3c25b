// Wavefront OBJ. tinyobjloader's callback interface cuts the lines into numbers; what its LoadObj
// adds (tags, ear clipping) takes time and memory beyond any multiple of the file's size. Polygons
// become fans, as in Mitsuba and Tungsten.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <istream>
#include <streambuf>
#include <unordered_map>

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign {
namespace {

// Indices of a position, a texture coordinate and a normal; -1: none.
using Corner = std::array<int, 3>;
struct CornerHash {
  size_t operator()(const Corner& c) const {
    uint64_t h = 0;
    for (const int i : c) h = (h ^ static_cast<uint32_t>(i)) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
    return h;
  }
};

// The text with one kind of line end and without comments. A backslash at the end of a line joins
// the next one to it; empty lines after them keep the numbers of all others.
std::string whole_lines(std::string_view bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  std::string out;
  out.reserve(bytes.size());
  size_t joined = 0;
  bool in_comment = false;
  for (size_t at = 0; at < bytes.size(); ++at) {
    const bool continues = bytes[at] == '\\' && !in_comment;
    std::string_view rest = bytes.substr(at + continues);
    const size_t blanks = continues ? std::min(rest.find_first_not_of(" \t"), rest.size()) : 0;
    rest.remove_prefix(blanks);
    const size_t end =
        rest.starts_with("\r\n") ? 2 : rest.starts_with('\n') || rest.starts_with('\r');
    if (continues && (end > 0 || rest.empty())) {
      out += ' ', ++joined;
      at += blanks + end;
    } else if (end > 0) {
      out.append(1 + joined, '\n');
      joined = 0, in_comment = false;
      at += end - 1;
    } else {
      in_comment |= bytes[at] == '#';
      out += in_comment ? ' ' : bytes[at];
    }
  }
  return out;
}

// A file in memory as a stream that knows the line it is at.
struct Lines : std::streambuf {
  explicit Lines(std::string_view bytes) {
    char* begin = const_cast<char*>(bytes.data());  // streambuf's words; nothing writes
    setg(begin, begin, begin + bytes.size());
  }
  /// Of the line that was read last.
  size_t number() const {
    const auto ends = std::count(eback(), gptr(), '\n');
    return static_cast<size_t>(ends) + (gptr() == eback() || gptr()[-1] != '\n');
  }
  std::string_view text() const {
    std::string_view before(eback(), static_cast<size_t>(gptr() - eback()));
    while (before.ends_with('\n') || before.ends_with('\r')) before.remove_suffix(1);
    return before.substr(before.find_last_of("\r\n") + 1);
  }
};

class Reader {
 public:
  Reader(std::string_view bytes, const std::string& name)
      : text_(whole_lines(bytes)), lines_(text_), name_(name) {}

  Mesh mesh() {
    tinyobj::callback_t calls;
    calls.vertex_cb = [](void* self, float x, float y, float z, float) {
      static_cast<Reader*>(self)->vertex({x, y, z});
    };
    calls.normal_cb = [](void* self, float x, float y, float z) {
      static_cast<Reader*>(self)->expect_words(3, false);
      static_cast<Reader*>(self)->normals_.push_back({x, y, z});
    };
    calls.texcoord_cb = [](void* self, float u, float v, float) {
      static_cast<Reader*>(self)->expect_words(1, false);
      static_cast<Reader*>(self)->uv_.push_back({u, v});
    };
    calls.index_cb = [](void* self, tinyobj::index_t* corners, int n) {
      static_cast<Reader*>(self)->face(corners, static_cast<size_t>(n));
    };
    std::istream stream(&lines_);
    tinyobj::LoadObjWithCallback(stream, calls, this);
    return assembled();
  }

 private:
  [[noreturn]] void fail(const std::string& words) const {
    throw InputError(name_, fmt::format("line {}", lines_.number()), words);
  }

  // tinyobjloader reads 0 from words that are no numbers, and where there are none.
  void expect_words(int least, bool numbers) const {
    std::string_view rest = lines_.text();
    const auto word = [&rest] {
      rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
      const std::string_view taken = rest.substr(0, rest.find_first_of(" \t"));
      rest.remove_prefix(taken.size());
      return taken;
    };
    word();  // v, vn, vt
    for (int i = 0; i < least; ++i) {
      const std::string_view text = word();
      if (text.empty()) fail(fmt::format("has {} of {} numbers", i, least));
      double number = 0;
      const char* begin = text.begin() + (text.starts_with('+') ? 1 : 0);
      const auto [end, error] = std::from_chars(begin, text.end(), number);
      if (numbers &&
          (error == std::errc::invalid_argument || end != text.end() || !std::isfinite(number)))
        fail(fmt::format("\"{}\" is not a finite number", shown(text, 40)));
    }
  }

  void vertex(const Vec3f& p) {
    expect_words(3, true);
    if (!is_finite(p)) fail("the position is too large");
    positions_.push_back(p);
  }

  // Zero-based, of a number from 1 upwards or, backwards from the last one so far, from -1
  // downwards.
  int index(int given, size_t count, const char* what) const {
    const auto n = static_cast<int64_t>(count);
    const int64_t i = given > 0 ? given - 1 : n + given;
    if (given == 0 || i < 0 || i >= n)
      fail(fmt::format("refers to {} {}, but there are {} so far", what, given, count));
    return static_cast<int>(i);
  }

  void face(const tinyobj::index_t* given, size_t n) {
    std::string_view words = lines_.text();
    words.remove_prefix(std::min(words.find('f') + 1, words.size()));
    if (const size_t at = words.find_first_not_of("0123456789/+- \t"); at != words.npos)
      fail(fmt::format("\"{}\" is no index, expected whole numbers and /",
                       shown(std::string(words.substr(at)), 40)));
    for (size_t at = 0; (at = words.find_first_of("0123456789", at)) != words.npos;) {
      const size_t digits = std::min(words.find_first_not_of("0123456789", at), words.size()) - at;
      if (digits > 9) fail(fmt::format("an index of {} digits", digits));
      at += digits;
    }
    polygon_.clear();
    for (size_t i = 0; i < n; ++i) {
      const auto& [v, vn, vt] = given[i];
      polygon_.push_back({index(v, positions_.size(), "vertex"),
                          vt == 0 ? -1 : index(vt, uv_.size(), "texture coordinate"),
                          vn == 0 ? -1 : index(vn, normals_.size(), "normal")});
      has_uv_ |= vt != 0;
      has_normals_ |= vn != 0;
    }
    for (size_t i = 2; i < n; ++i)
      corners_.insert(corners_.end(), {polygon_[0], polygon_[i - 1], polygon_[i]});
  }

  // Faces without normals stay flat among those with normals: each gets one of its own.
  void flatten() {
    for (size_t i = 0; i < corners_.size(); i += 3) {
      if (std::all_of(&corners_[i], &corners_[i] + 3, [](const Corner& c) { return c[2] >= 0; }))
        continue;
      const auto at = [&](size_t k) {
        const Vec3f& p = positions_[static_cast<size_t>(corners_[i + k][0])];
        return Vec3d{p.x, p.y, p.z};
      };
      const Vec3d n = cross(at(1) - at(0), at(2) - at(0));
      const Vec3d unit = length(n) > 0 ? normalize(n) : Vec3d{0, 0, 1};
      for (size_t k = 0; k < 3; ++k)
        if (corners_[i + k][2] < 0) corners_[i + k][2] = static_cast<int>(normals_.size());
      normals_.push_back(
          {static_cast<float>(unit.x), static_cast<float>(unit.y), static_cast<float>(unit.z)});
    }
  }

  Mesh assembled() {
    if (has_normals_) flatten();
    Mesh mesh;
    std::unordered_map<Corner, uint32_t, CornerHash> vertices;
    for (size_t i = 0; i < corners_.size(); ++i) {
      const Corner& c = corners_[i];
      const auto [found, is_new] =
          vertices.try_emplace(c, static_cast<uint32_t>(mesh.positions.size()));
      if (is_new) {
        mesh.positions.push_back(positions_[static_cast<size_t>(c[0])]);
        if (has_uv_)
          mesh.uv.push_back(c[1] < 0 ? std::array<float, 2>{} : uv_[static_cast<size_t>(c[1])]);
        if (has_normals_) mesh.normals.push_back(normals_[static_cast<size_t>(c[2])]);
      }
      if (i % 3 == 0) mesh.triangles.emplace_back();
      mesh.triangles.back()[i % 3] = found->second;
    }
    check(mesh, name_);
    flip_v(mesh);
    return mesh;
  }

  const std::string text_;
  Lines lines_;
  const std::string& name_;
  std::vector<Vec3f> positions_, normals_;
  std::vector<std::array<float, 2>> uv_;
  std::vector<Corner> polygon_, corners_;  ///< corners_: three per triangle
  bool has_uv_ = false, has_normals_ = false;
};

}  // namespace

Mesh read_obj(std::string_view bytes, const std::string& name) {
  return Reader(bytes, name).mesh();
}

}  // namespace tdpt::foreign
