// Wavefront OBJ. Polygons become fans, as in Mitsuba and Tungsten.
#include <algorithm>
#include <charconv>
#include <unordered_map>

#include <fmt/format.h>

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

class ObjReader {
 public:
  ObjReader(std::string_view bytes, const std::string& name) : rest_(bytes), name_(name) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
  }

  Mesh mesh() {
    while (next_line()) {
      const auto words = words_of(line_);
      if (words.empty()) continue;
      if (words[0] == "v") {
        const auto v = numbers(words, 3, true);
        positions_.push_back({v[0], v[1], v[2]});
        if (!is_finite(positions_.back())) fail("the position is too large");
      } else if (words[0] == "vn") {
        const auto v = numbers(words, 3, false);
        normals_.push_back({v[0], v[1], v[2]});
      } else if (words[0] == "vt") {
        const auto v = numbers(words, 1, false);
        uv_.push_back({v[0], v[1]});
      } else if (words[0] == "f") {
        face(words);
      }
    }
    return assembled();
  }

 private:
  [[noreturn]] void fail(const std::string& words) const {
    throw InputError(name_, fmt::format("line {}", number_), words);
  }

  // Takes a line without its comment, and those that a backslash at its end joins to it.
  bool next_line() {
    if (rest_.empty()) return false;
    line_.clear();
    number_ = next_number_;
    for (bool continues = true; continues && !rest_.empty(); ++next_number_) {
      std::string_view part = rest_.substr(0, rest_.find_first_of("\r\n"));
      rest_.remove_prefix(part.size());
      rest_.remove_prefix(std::min<size_t>(rest_.size(), rest_.starts_with("\r\n") ? 2 : 1));
      const size_t comment = part.find('#');
      part = part.substr(0, comment);
      const size_t last = part.find_last_not_of(" \t");
      continues = comment == part.npos && last != part.npos && part[last] == '\\';
      line_ += part.substr(0, continues ? last : part.npos);
      line_ += ' ';
    }
    return true;
  }

  // The first three numbers after the line's keyword, 0 for those beyond `least` that it lacks and,
  // unless they are `needed`, for words that are none.
  std::array<float, 3> numbers(const std::vector<std::string_view>& words, size_t least,
                               bool needed) const {
    std::array<float, 3> out{};
    if (words.size() <= least) fail(fmt::format("has {} of {} numbers", words.size() - 1, least));
    for (size_t i = 0; i < std::min<size_t>(3, words.size() - 1); ++i) {
      const auto number = number_in(words[i + 1]);
      if (needed && (!number || words[i + 1].find_first_of("0123456789") == words[i + 1].npos))
        fail(fmt::format("\"{}\" is not a finite number", shown(words[i + 1], 40)));
      out[i] = static_cast<float>(number.value_or(0));
    }
    return out;
  }

  // Zero-based, of a number from 1 upwards or, backwards from the last one so far, from -1
  // downwards.
  int index(int64_t given, size_t count, const char* what) const {
    const auto n = static_cast<int64_t>(count);
    const int64_t i = given > 0 ? given - 1 : n + given;
    if (given == 0 || i < 0 || i >= n)
      fail(fmt::format("refers to {} {}, but there are {} so far", what, given, count));
    return static_cast<int>(i);
  }

  // "7", "7/3", "7//2" or "7/3/2".
  Corner corner(std::string_view word) {
    int64_t given[3] = {};
    const char* at = word.begin();
    for (size_t k = 0; k < 3 && at != word.end(); ++k) {
      if (k > 0 && *at++ != '/') break;
      if (k > 0 && (at == word.end() || *at == '/')) continue;  // left out
      const auto [end, error] = std::from_chars(at + (*at == '+'), word.end(), given[k]);
      if (error != std::errc()) break;
      at = end;
    }
    if (at != word.end())
      fail(fmt::format("\"{}\" is no index, expected whole numbers and /", shown(word, 40)));
    has_uv_ |= given[1] != 0, has_normals_ |= given[2] != 0;
    return {index(given[0], positions_.size(), "vertex"),
            given[1] == 0 ? -1 : index(given[1], uv_.size(), "texture coordinate"),
            given[2] == 0 ? -1 : index(given[2], normals_.size(), "normal")};
  }

  void face(const std::vector<std::string_view>& words) {
    std::vector<Corner> polygon;
    for (size_t i = 1; i < words.size(); ++i) polygon.push_back(corner(words[i]));
    for (size_t i = 2; i < polygon.size(); ++i)
      corners_.insert(corners_.end(), {polygon[0], polygon[i - 1], polygon[i]});
  }

  // Faces without normals stay flat among those with normals: each gets one of its own.
  void flatten() {
    for (size_t i = 0; i < corners_.size(); i += 3) {
      if (std::all_of(&corners_[i], &corners_[i] + 3, [](const Corner& c) { return c[2] >= 0; }))
        continue;
      const auto at = [&](size_t k) {
        return in_double(positions_[static_cast<size_t>(corners_[i + k][0])]);
      };
      const Vec3d n = cross(at(1) - at(0), at(2) - at(0));
      for (size_t k = 0; k < 3; ++k)
        if (corners_[i + k][2] < 0) corners_[i + k][2] = static_cast<int>(normals_.size());
      normals_.push_back(in_single(length(n) > 0 ? normalize(n) : Vec3d{0, 0, 1}));
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

  std::string_view rest_;
  const std::string& name_;
  std::string line_;
  size_t number_ = 0, next_number_ = 1;  ///< of the line, of the one after it
  std::vector<Vec3f> positions_, normals_;
  std::vector<std::array<float, 2>> uv_;
  std::vector<Corner> corners_;  ///< three per triangle
  bool has_uv_ = false, has_normals_ = false;
};

}  // namespace

Mesh read_obj(std::string_view bytes, const std::string& name) {
  return ObjReader(bytes, name).mesh();
}

}  // namespace tdpt::foreign
