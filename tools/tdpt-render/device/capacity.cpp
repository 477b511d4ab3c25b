#include "tools/tdpt-render/device/capacity.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/math/sequence.h"
#include "tools/tdpt-render/path/sample/roulette.h"

namespace tdpt {
namespace {

// For one cache if no walk ends before the limit of depth, with the ends of its segments.
constexpr uint64_t kFewestSlots = 2 * kMostOfCache * (uint64_t{kMaxDepth} + 1) + 2 * kMostOfCache;
constexpr uint64_t kMostSlots = uint64_t{1} << 24;
constexpr uint64_t kSlotsOfSample = 16;  // more than most samples need
constexpr uint64_t kWorkGroup = 64;      // invocations, one per slot

// Bytes of PATH_TABLES and PATH_WORDS.
uint64_t bytes_of_paths(const Capacity& room, bool layered) {
  using namespace shader;
  constexpr uint64_t words_of_film = 0;
#define BYTES(binding, type, name, array, count) \
  +sizeof(type) * uint64_t {                     \
    count                                        \
  }
#define BYTES_OF_WORDS(binding, array, count) \
  +sizeof(uint) * uint64_t {                  \
    count                                     \
  }
  return 0 PATH_TABLES(BYTES) PATH_WORDS(BYTES_OF_WORDS);
#undef BYTES
#undef BYTES_OF_WORDS
}
// Bytes per slot, with its share of a sample.
uint64_t slot_bytes(bool layered) {
  constexpr uint32_t kSlots = kSlotsOfSample;
  return (bytes_of_paths({2 * kSlots, 2}, layered) - bytes_of_paths({kSlots, 1}, layered)) /
             kSlotsOfSample +
         1;
}

[[noreturn]] void refuse(const std::string& device, const std::string& why) {
  throw Error(Exit::no_device, device + ": " + why);
}

template <class T>
uint64_t bytes_of(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

}  // namespace

std::vector<SceneShare> shares_of(const RenderTables& t) {
  const SurfaceTables& s = t.surfaces;
  const LightTables& l = t.lights;
  return {{"the hierarchy of the triangles", bytes_of(t.bvh.nodes)},
          {"the triangles", bytes_of(t.bvh.triangles)},
          {"the faces of the triangles", bytes_of(s.faces)},
          {"the corners of the triangles", bytes_of(s.face_corners)},
          {"the attributes of vertices", bytes_of(s.corner_attributes)},
          {"the materials", bytes_of(s.materials) + bytes_of(s.material_maps)},
          {"the textures", bytes_of(s.texel_words) + bytes_of(s.maps)},
          {"the coverage of the triangles",
           bytes_of(s.coverage.coverage_of) + bytes_of(s.coverage.coverages)},
          {"the emissive surfaces", bytes_of(l.emitters)},
          {"the odds of the lights", bytes_of(l.words)},
          {"the lamps", bytes_of(l.lamps)},
          {"the sky", bytes_of(l.texels) + bytes_of(l.suns)},
          {"the rectangular lights", bytes_of(l.rect_lights)},
          {"the windows", bytes_of(l.windows) + bytes_of(l.frames)},
          {"the portals", bytes_of(t.portals.polygons) + bytes_of(t.portals.facets)},
          {"the corners of the portals", bytes_of(t.portals.corners)},
          {"the pairs of portals", bytes_of(t.portals.pairs)},
          {"what all scenes need",
           bytes_of(t.surface_curves) + bytes_of(t.sheen_curves) + sizeof(shader::sobol_points)}};
}

Capacity capacity_on(const std::string& name, const gpu::Limits& limits, const DeviceNeeds& needs) {
  if (needs.buffers > limits.buffers)
    refuse(name, fmt::format("a kernel binds {} buffers, the device allows {}", needs.buffers,
                             limits.buffers));
  uint64_t scene = 0;
  SceneShare largest{"", 0};
  for (const SceneShare& share : needs.scene) {
    scene += share.bytes;
    if (share.bytes > largest.bytes) largest = share;
  }
  if (scene > limits.texels)
    refuse(name, fmt::format("the scene takes {} bytes, {} of them {}, the device reads no more "
                             "than {} from a buffer",
                             scene, largest.bytes, largest.name, limits.texels));
  if (needs.film > limits.buffer)
    refuse(name, fmt::format("the film takes {} bytes, the device's largest buffer has {}",
                             needs.film, limits.buffer));
  const uint64_t fixed = scene + needs.film;
  const uint64_t slot = slot_bytes(needs.layered);
  const uint64_t most = limits.memory / 4 * 3;
  if (fixed + kFewestSlots * slot > most)
    refuse(name, fmt::format("scene, film and samples take {} bytes of memory at least, of the "
                             "device's they may take {}",
                             fixed + kFewestSlots * slot, most));
  Capacity room;
  const uint64_t in_memory = std::min(most - fixed, limits.memory / 8) / slot;
  room.vertices = static_cast<uint32_t>(
      std::min({std::max(in_memory, kFewestSlots), limits.buffer / sizeof(shader::PathVertex),
                limits.texels / slot, kWorkGroup * limits.groups, kMostSlots}));
  if (room.vertices < kFewestSlots)
    refuse(name, fmt::format("samples take {} vertices at least, the device holds {}", kFewestSlots,
                             room.vertices));
  room.samples = static_cast<uint32_t>(room.vertices / kSlotsOfSample);
  return room;
}

}  // namespace tdpt
