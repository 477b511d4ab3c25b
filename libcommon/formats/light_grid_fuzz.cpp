// Parses arbitrary bytes as a light grid. A grid that was read must lie in its box and round-trip.
// Inputs that would crash the child process of read_light_grid() are no faults and are skipped.
#include "libcommon/formats/light_grid.h"

#include <cstdlib>
#include <new>

#include "libcommon/testing/files/fuzz.h"

using namespace tdpt;

// OpenVDB allocates whatever length a block declares before it reads the block. Limited to 64 MiB
// here, or most of the time would go into clearing memory.
void* operator new(size_t size) {
  void* const memory = size >> 26 ? nullptr : std::malloc(size);
  if (!memory) throw std::bad_alloc();
  return memory;
}
void* operator new[](size_t size) {
  return operator new(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, size_t) noexcept {
  std::free(memory);
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using testing::require;
  const std::string bytes(testing::text_of(data, size));
  std::string refused;
  LightGrid apart;
  const bool read = testing::reads([&] {
    try {
      apart = read_light_grid(testing::file_of(bytes));
    } catch (const InputError& e) {
      refused = e.what();
      throw;
    }
  });
  if (refused.ends_with(" is damaged or cut short")) return 0;
  LightGrid a;
  require(read == testing::reads([&] { a = parse_light_grid(bytes, "input"); }),
          "both processes read it, or none");
  if (!read) return 0;
  require(a.dim == apart.dim && a.hash == apart.hash && a.count == apart.count &&
              a.lines.size() == apart.lines.size() && a.reason == apart.reason,
          "both read the same");
  const size_t n = a.count.size();
  require(a.air.size() == n && a.direction.size() == n, "a voxel has all three values");
  if (n > 4096) return 0;  // larger grids take too long
  const LightGrid b = read_light_grid(testing::file_of(light_grid_bytes(a)));
  require(a.dim == b.dim && a.voxel == b.voxel && a.origin == b.origin && a.count == b.count &&
              a.air == b.air && a.direction == b.direction,
          "voxels come back");
  require(a.lines.size() == b.lines.size() && a.probes.size() == b.probes.size() &&
              a.cuts.size() == b.cuts.size(),
          "lines come back");
  return 0;
}
