// Kernels, and how they are run.
#pragma once
#include <set>

#include "libcommon/gpu/memory.h"

namespace tdpt::gpu {

/// A compute shader with the entry point main, and the memory it works on. Copies are the same one.
class Kernel {
 public:
  /// `program`: SPIR-V, as tdpt_shaders() of cmake/tdpt.cmake leaves it in shaders/NAME.h.
  /// `memory`: what stands at layout(set = 0, binding = 0, 1, 2, ...); it lives as long as this.
  /// What the program does not name is not bound, and counts for no limit.
  /// `push_bytes`: size of the push constants, a multiple of 4. `constants`: of specialisation,
  /// those with constant_id 0, 1, 2, ...; bools are 0 or 1.
  Kernel(const Device& device, std::span<const uint32_t> program, const std::vector<Memory>& memory,
         uint32_t push_bytes = 0, const std::vector<uint32_t>& constants = {});

  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<Impl> impl_;
};

/// How many storage buffers a program names, of all that is bound for several.
size_t storage_buffers_in(std::span<const uint32_t> program);

/// The constant_ids that a program reads: others make no other kernel of it.
std::set<uint32_t> constants_of(std::span<const uint32_t> program);

/// What a driver's compiler tells of a program: "VGPRs", "Scratch size", as the driver calls it.
struct Statistic {
  std::string name;
  double value;
};
/// Of a device that was opened for it, be it one without memory. `program`, `push_bytes` and
/// `constants` as of Kernel; what it binds are storage buffers, texels and uniforms.
std::vector<Statistic> statistics_of(const Device& device, std::span<const uint32_t> program,
                                     uint32_t push_bytes,
                                     const std::vector<uint32_t>& constants = {});

/// Push constants: one struct, laid out as in the shader.
template <class T>
std::span<const std::byte> push(const T& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::as_bytes(std::span(&values, 1));
}

/// Given by Device::run. Everything named here lives until run() returns.
class Commands {
 public:
  /// `push`: as of push(), or {}. `groups`: work groups along x; above the device's limit it
  /// throws.
  void dispatch(const Kernel& kernel, std::span<const std::byte> push, uint32_t groups);
  /// The device reads the work groups along x, y, z from three uint32 in `groups`, at byte `offset`
  /// (a multiple of 4). Whoever writes them keeps each below 65536, which every device allows.
  void dispatch_indirect(const Kernel& kernel, std::span<const std::byte> push,
                         const Buffer& groups, uint64_t offset = 0);
  /// Makes every texel 0.
  void clear(const Image3D& image);
  /// Makes every byte 0.
  void clear(const Buffer& buffer);

  struct Impl;
  explicit Commands(const Impl& impl) : impl_(impl) {}
  const Impl& impl() const { return impl_; }

 private:
  const Impl& impl_;
};

}  // namespace tdpt::gpu
