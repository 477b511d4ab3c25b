// Reads the file of a light grid in a child process: OpenVDB trusts lengths declared in a file,
// writes outside its memory if they are wrong, and aborts the program for others. The grid returns
// through a pipe, field by field.
#include <cstdio>
#include <string>
#include <type_traits>
#include <vector>

#include "libcommon/base/child_process.h"
#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/formats/light_grid.h"

namespace tdpt {
namespace {

// Calls each(field). Adding a field to Grid breaks compilation here, so none is forgotten.
template <class Grid, class Each>
void each_field(Grid& grid, const Each& each) {
  auto& [origin, voxel, dim, count, air, direction, lines, probes, bottleneck, reason, flux_share,
         cuts, walls, panes, scene_hash, cameras, provenance, hash] = grid;
  each(origin), each(voxel), each(dim), each(count), each(air), each(direction), each(lines);
  each(probes), each(bottleneck), each(reason), each(flux_share), each(cuts);
  each(walls), each(panes), each(scene_hash), each(cameras);
  each(provenance.lines), each(hash);
}

class Out {
 public:
  explicit Out(std::FILE* file) : file_(file) {}

  template <class T>
  void put(const T& value) const {
    static_assert(std::is_trivially_copyable_v<T>);
    put_bytes(&value, sizeof value);
  }
  template <class T>
  void put(const std::vector<T>& values) const {
    static_assert(std::is_trivially_copyable_v<T>);
    put(values.size());
    put_bytes(values.data(), values.size() * sizeof(T));
  }
  void put(const std::string& text) const {
    put(text.size());
    put_bytes(text.data(), text.size());
  }
  template <class T>
  requires requires(T list) { list.size(); }
  void put(const std::vector<T>& lists) const {
    put(lists.size());
    for (const T& list : lists) put(list);
  }

 private:
  // The reading end detects what could not be written.
  void put_bytes(const void* data, size_t size) const { std::fwrite(data, 1, size, file_); }

  std::FILE* file_;
};

struct TooShort {};

// The reading end. The other process may have gone wrong, so lengths beyond what a grid may have
// are refused.
class In {
 public:
  explicit In(std::FILE* file) : file_(file) {}

  template <class T>
  void get(T& value) const {
    static_assert(std::is_trivially_copyable_v<T>);
    get_bytes(&value, sizeof value);
  }
  template <class T>
  void get(std::vector<T>& values) const {
    static_assert(std::is_trivially_copyable_v<T>);
    values.resize(length());
    get_bytes(values.data(), values.size() * sizeof(T));
  }
  void get(std::string& text) const {
    text.resize(length());
    get_bytes(text.data(), text.size());
  }
  template <class T>
  requires requires(T list) { list.size(); }
  void get(std::vector<T>& lists) const {
    lists.resize(length());
    for (T& list : lists) get(list);
  }

 private:
  size_t length() const {
    size_t n = 0;
    get(n);
    if (n > kMostVoxels) throw TooShort();
    return n;
  }
  void get_bytes(void* data, size_t size) const {
    if (std::fread(data, 1, size, file_) != size) throw TooShort();
  }

  std::FILE* file_;
};

// Whether each voxel has all three values.
bool is_whole(const LightGrid& grid) {
  size_t n = 1;
  for (const int side : grid.dim) n *= static_cast<size_t>(side);
  return grid.count.size() == n && grid.air.size() == n && grid.direction.size() == n;
}

}  // namespace

LightGrid read_light_grid(const std::string& path) {
  return read_light_grid(read_file(path), display_name(path));
}

LightGrid read_light_grid(const std::string& bytes, const std::string& name) {
  LightGrid grid;
  std::string refused;
  const bool whole = in_another_process(
      [&](std::FILE* file) {
        const Out out(file);
        LightGrid read;
        std::string message;
        try {
          read = parse_light_grid(bytes, name);
        } catch (const InputError& e) {
          message = e.what();
        }
        out.put(message);
        each_field(read, [&](const auto& field) { out.put(field); });
      },
      [&](std::FILE* file) {
        try {
          const In in(file);
          in.get(refused);
          each_field(grid, [&](auto& field) { in.get(field); });
        } catch (const TooShort&) {
          return false;
        }
        return is_whole(grid);
      });
  if (!whole) throw InputError(name, "", "is damaged or cut short");
  if (!refused.empty()) throw InputError(refused);
  return grid;
}

}  // namespace tdpt
