// What the plain headers of this folder hide. Internal to it.
#pragma once
#include <fmt/format.h>
#include <vulkan/vulkan_raii.hpp>

#include "libcommon/base/error.h"
#include "libcommon/gpu/kernel.h"

namespace tdpt::gpu {

/// Calls f(); what Vulkan throws becomes "WHAT: vkFunction: ResultName".
template <class F>
auto calling_vulkan(const std::string& what, F f) {
  try {
    return f();
  } catch (const vk::SystemError& e) {
    throw Error(Exit::no_device, what + ": " + e.what());
  }
}

/// "NAME allows LIMIT WHAT; ASKED are asked for".
inline void require_within(const DeviceInfo& device, uint64_t limit, const char* what,
                           uint64_t asked) {
  if (asked > limit)
    throw Error(Exit::no_device,
                fmt::format("{} allows {} {}; {} are asked for", device.name, limit, what, asked));
}

/// A buffer with memory of its own.
struct Block {
  vk::raii::DeviceMemory memory = nullptr;
  vk::raii::Buffer buffer = nullptr;
  uint64_t bytes = 0;
  std::byte* mapped = nullptr;  ///< where the host sees it; null: it does not
};

struct Device::Impl {
  DeviceInfo info;
  bool host_sees = false;      ///< buffers lie where the host sees them, as the device has no other
  uint64_t piece = 16u << 20;  ///< bytes of the staging buffer
  double tick = 0;             ///< of a timestamp [s]; 0: there are none
  uint64_t tick_mask = 0;
  bool recording = false;

  vk::raii::Instance instance = nullptr;
  vk::raii::DebugUtilsMessengerEXT messenger = nullptr;
  vk::raii::PhysicalDevice physical = nullptr;
  vk::raii::Device device = nullptr;
  vk::raii::Queue queue = nullptr;
  vk::raii::CommandPool pool = nullptr;
  vk::raii::CommandBuffer commands = nullptr;
  vk::raii::Fence fence = nullptr;
  vk::raii::QueryPool queries = nullptr;
  Block staging_block;

  void create(const vk::raii::PhysicalDevice& chosen);
  /// Memory of the first kind in `wishes` that there is.
  vk::raii::DeviceMemory allocate(const vk::MemoryRequirements& need,
                                  std::initializer_list<vk::MemoryPropertyFlags> wishes) const;
  Block make_block(uint64_t bytes, vk::BufferUsageFlags usage, bool mapped) const;
  const Block& staging();
  /// Throws inside of run(): whoever records commands cannot wait for others.
  void require_idle() const;
  double run(const std::function<void()>& record);
  /// What follows sees what was written before.
  void barrier() const;
};

struct Buffer::Impl {
  std::shared_ptr<Device::Impl> device;
  Block block;
};

struct Image3D::Impl {
  std::shared_ptr<Device::Impl> device;
  std::array<uint32_t, 3> size;
  vk::raii::DeviceMemory memory = nullptr;
  vk::raii::Image image = nullptr;
  vk::raii::ImageView view = nullptr;
};

struct Kernel::Impl {
  std::shared_ptr<Device::Impl> device;
  std::vector<Binding> bindings;
  uint32_t push_bytes;
  vk::raii::DescriptorSetLayout set_layout = nullptr;
  vk::raii::PipelineLayout layout = nullptr;
  vk::raii::Pipeline pipeline = nullptr;
};

struct Commands::Impl {
  Device::Impl& device;
  std::vector<vk::raii::DescriptorPool> pools;
  std::vector<vk::raii::DescriptorSet> sets;  // one of each pool

  void bind(const Kernel::Impl& kernel, const std::vector<Bound>& bound, const Push& push);
};

inline constexpr vk::ImageSubresourceRange kWholeImage{vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1};

}  // namespace tdpt::gpu
