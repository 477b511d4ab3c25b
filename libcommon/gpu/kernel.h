// Kernels, and how they are run.
#pragma once
#include "libcommon/gpu/memory.h"

namespace tdpt::gpu {

enum class Binding { buffer, image };

/// A compute shader with the entry point main.
class Kernel {
 public:
  /// `program`: SPIR-V, as tdpt_shaders() of cmake/tdpt.cmake leaves it in shaders/NAME.h.
  /// `bindings`: what stands at layout(set = 0, binding = 0, 1, 2, ...).
  /// `push_bytes`: size of the push constants, a multiple of 4.
  /// `constants`: specialization constants, layout(constant_id = 0, 1, 2, ...), each 32 bits.
  Kernel(const Device& device, std::span<const uint32_t> program,
         const std::vector<Binding>& bindings, uint32_t push_bytes = 0,
         const std::vector<uint32_t>& constants = {});
  Kernel(Kernel&&) = default;
  Kernel& operator=(Kernel&&) = default;

  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<Impl> impl_;
};

/// What a kernel finds at one binding.
struct Bound {
  Bound(const Buffer& b) : buffer(&b) {}  // NOLINT: implicit, for lists of arguments
  Bound(const Image3D& i) : image(&i) {}  // NOLINT
  const Buffer* buffer = nullptr;
  const Image3D* image = nullptr;
};

/// Push constants: one struct, laid out as in the shader; or none.
struct Push {
  Push() = default;
  template <class T>
  Push(const T& values) : bytes(std::as_bytes(std::span(&values, 1))) {  // NOLINT: as above
    static_assert(std::is_trivially_copyable_v<T>);
  }
  std::span<const std::byte> bytes;
};

/// Given by Device::run. Everything named here lives until run() returns.
class Commands {
 public:
  /// `groups`: work groups along x; above limits().groups it throws.
  void dispatch(const Kernel& kernel, const std::vector<Bound>& bound, Push push, uint32_t groups);
  /// The device reads the work groups along x, y, z from three uint32 in `groups`, at byte `offset`
  /// (a multiple of 4). Whoever writes them keeps each within limits().groups.
  void dispatch_indirect(const Kernel& kernel, const std::vector<Bound>& bound, Push push,
                         const Buffer& groups, uint64_t offset = 0);
  /// All of the buffer, in words.
  void fill(const Buffer& buffer, uint32_t word);
  void clear(const Image3D& image, uint32_t texel = 0);

  struct Impl;
  explicit Commands(Impl& impl) : impl_(impl) {}

 private:
  Impl& impl_;
};

}  // namespace tdpt::gpu
