// Wavefront OBJ. Polygons become fans, as in Mitsuba and Tungsten.
#include <algorithm>
#include <charconv>
#include <map>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign {
namespace {

// Indices of a position, a texture coordinate and a normal; -1: none.
using Corner = std::array<int, 3>;
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
        positions_.push_back(vector(words, 3));
        if (!is_finite(positions_.back())) fail("its position is not finite");
      } else if (words[0] == "vn") {
        normals_.push_back(vector(words, 3));
      } else if (words[0] == "vt") {
        const Vec3f v = vector(words, 1);
        uv_.push_back({v.x, v.y});
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
      const std::string_view all = rest_.substr(0, rest_.find_first_of("\r\n"));
      rest_.remove_prefix(all.size());
      rest_.remove_prefix(std::min<size_t>(rest_.size(), rest_.starts_with("\r\n") ? 2 : 1));
      const std::string_view part = all.substr(0, all.find('#'));
      const size_t last = part.find_last_not_of(" \t");
      continues = part.size() == all.size() && last != part.npos && part[last] == '\\';
      (line_ += part.substr(0, continues ? last : part.npos)) += ' ';
    }
    return true;
  }

  // The first three numbers after the line's keyword; 0 for those beyond `least` that it lacks, and
  // not a number for words that are none.
  Vec3f vector(const std::vector<std::string_view>& words, size_t least) const {
    if (words.size() <= least) fail(fmt::format("has {} of {} numbers", words.size() - 1, least));
    float v[3] = {};
    for (size_t i = 0; i < std::min<size_t>(3, words.size() - 1); ++i)
      v[i] = static_cast<float>(number_in(words[i + 1]).value_or(NAN));
    return {v[0], v[1], v[2]};
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
    std::map<Corner, uint32_t> vertices;
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
