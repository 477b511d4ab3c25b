// Compute kernels, and how they are dispatched.
#pragma once
#include <set>

#include "libcommon/gpu/memory.h"

namespace tdpt::gpu {

/// A compute shader with the entry point main, and the memory bound to it. Copies share one kernel.
class Kernel {
 public:
  /// `program`: SPIR-V, as tdpt_shaders() of cmake/tdpt.cmake writes it to shaders/NAME.h.
  /// `memory`: bound to layout(set = 0, binding = 0, 1, 2, ...); kept alive by the kernel. Bindings
  /// that the program does not use are not bound and count for no limit. `push_bytes`: size of the
  /// push constants, a multiple of 4. `constants`: specialisation constants with constant_id 0, 1,
  /// 2, ...; bools are 0 or 1.
  Kernel(const Device& device, std::span<const uint32_t> program, const std::vector<Memory>& memory,
         uint32_t push_bytes = 0, const std::vector<uint32_t>& constants = {});

  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<Impl> impl_;
};

/// How many storage buffers a program uses of the memory that several programs share.
size_t storage_buffers_in(std::span<const uint32_t> program);

/// The constant_ids that a program reads: other constants do not change its kernel.
std::set<uint32_t> constants_of(std::span<const uint32_t> program);

/// A statistic from a driver's compiler, "VGPRs", "Scratch size", as the driver calls it.
struct Statistic {
  std::string name;
  double value;
};
/// Needs a device opened with `told`; it may lack memory. `program`, `push_bytes` and `constants`
/// as for Kernel; bindings may be storage buffers, texels and uniforms.
std::vector<Statistic> statistics_of(const Device& device, std::span<const uint32_t> program,
                                     uint32_t push_bytes,
                                     const std::vector<uint32_t>& constants = {});

/// Push constants: one struct, laid out as in the shader.
template <class T>
std::span<const std::byte> push(const T& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::as_bytes(std::span(&values, 1));
}

/// Passed by Device::run. All arguments must live until run() returns.
class Commands {
 public:
  /// `push`: from push(), or {}. `groups`: work groups along x; throws above the device's limit.
  void dispatch(const Kernel& kernel, std::span<const std::byte> push, uint32_t groups);
  /// The device reads the work groups along x, y, z from three uint32 in `groups` at byte `offset`
  /// (a multiple of 4). Their writer must keep each below 65536, which every device allows.
  void dispatch_indirect(const Kernel& kernel, std::span<const std::byte> push,
                         const Buffer& groups, uint64_t offset = 0);
  /// Sets every texel to 0.
  void clear(const Image3D& image);
  /// Sets every byte to 0.
  void clear(const Buffer& buffer);

  struct Impl;
  explicit Commands(const Impl& impl) : impl_(impl) {}
  const Impl& impl() const { return impl_; }

 private:
  const Impl& impl_;
};

}  // namespace tdpt::gpu
