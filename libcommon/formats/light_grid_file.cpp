// Reads the file of a light grid in a child process: OpenVDB trusts lengths declared in a file,
// writes outside its memory if they are wrong, and aborts the program for others. The grid returns
// through a pipe, field by field.
#include <cstdio>
#include <string>
#include <type_traits>

#include "libcommon/base/child_process.h"
#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/formats/light_grid.h"

namespace tdpt {
namespace {

// Calls each(field). Adding a field to LightGrid breaks compilation here, so none is forgotten.
template <class Each>
void each_field(LightGrid& grid, const Each& each) {
  auto& [origin, voxel, dim, count, air, direction, lines, probes, bottleneck, reason, flux_share,
         cuts, walls, panes, scene_hash, cameras, provenance, hash] = grid;
  each(origin), each(voxel), each(dim), each(count), each(air), each(direction), each(lines);
  each(probes), each(bottleneck), each(reason), each(flux_share), each(cuts);
  each(walls), each(panes), each(scene_hash), each(cameras);
  each(provenance.lines), each(hash);
}

struct BrokenPipe {};

// Moves values through the pipe: writes them at one end, and sets them at the other. The other
// process may have gone wrong, so lengths beyond what a grid may have are refused.
class Pipe {
 public:
  Pipe(std::FILE* file, bool writes) : file_(file), writes_(writes) {}

  template <class T>
  void move(T& value) const {
    static_assert(std::is_trivially_copyable_v<T>);
    move_bytes(&value, sizeof value);
  }
  template <class T>
  requires requires(T list) { list.resize(1); }
  void move(T& list) const {
    size_t n = list.size();
    move(n);
    if (n > kMostVoxels) throw BrokenPipe();
    list.resize(n);
    if constexpr (std::is_trivially_copyable_v<typename T::value_type>)
      move_bytes(list.data(), n * sizeof(typename T::value_type));
    else
      for (auto& element : list) move(element);
  }

 private:
  void move_bytes(void* data, size_t size) const {
    const size_t moved =
        writes_ ? std::fwrite(data, 1, size, file_) : std::fread(data, 1, size, file_);
    if (moved != size) throw BrokenPipe();
  }

  std::FILE* file_;
  bool writes_;
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
        const Pipe out(file, true);
        LightGrid read;
        std::string message;
        try {
          read = parse_light_grid(bytes, name);
        } catch (const InputError& e) {
          message = e.what();
        }
        out.move(message);
        each_field(read, [&](auto& field) { out.move(field); });
      },
      [&](std::FILE* file) {
        try {
          const Pipe in(file, false);
          in.move(refused);
          each_field(grid, [&](auto& field) { in.move(field); });
        } catch (const BrokenPipe&) {
          return false;
        }
        return is_whole(grid);
      });
  if (!whole) throw InputError(name, "", "is damaged or cut short");
  if (!refused.empty()) throw InputError(refused);
  return grid;
}

}  // namespace tdpt
