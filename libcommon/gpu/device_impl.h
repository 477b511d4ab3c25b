// Implementation behind the public headers of this folder. Internal to it.
#pragma once
#include <fmt/format.h>
#include <vulkan/vulkan_raii.hpp>

#include "libcommon/base/error.h"
#include "libcommon/gpu/kernel.h"

namespace tdpt::gpu {

/// Calls f(); Vulkan errors become "WHAT: vkFunction: ResultName".
template <class F>
auto calling_vulkan(const std::string& what, F f) {
  try {
    return f();
  } catch (const vk::SystemError& e) {
    throw Error(Exit::no_device, what + ": " + e.what());
  }
}

/// A host-visible buffer through which copies go.
struct Staging {
  vk::raii::Buffer buffer = nullptr;
  vk::raii::DeviceMemory memory = nullptr;
  std::byte* bytes = nullptr;
  uint64_t size = 0;
};

struct Device::Impl {
  DeviceInfo info;
  vk::PhysicalDeviceLimits limits;
  uint64_t piece = 16u << 20;  ///< largest copy to or from the host at a time, bytes
  vk::raii::Instance instance = nullptr;
  vk::raii::DebugUtilsMessengerEXT messenger = nullptr;
  vk::raii::PhysicalDevice physical = nullptr;
  vk::raii::Device device = nullptr;
  vk::raii::Queue queue = nullptr;
  vk::raii::CommandPool pool = nullptr;
  Staging staging;  ///< grown to the largest copy so far

  /// Throws "NAME allows LIMIT WHAT; ASKED are asked for" if the limit is exceeded.
  void require_within(uint64_t limit, const char* what, uint64_t asked) const;
};

struct Memory::Impl {
  Impl(const Device& device_, vk::DescriptorType type_, uint64_t bytes_)
      : device(device_), type(type_), bytes(bytes_) {}
  /// Its own buffer, or the one that it is a view of.
  vk::Buffer whole() const { return of ? *of->buffer : *buffer; }

  Device device;
  vk::DescriptorType type;
  uint64_t bytes;
  uint64_t offset = 0;  // of a part
  vk::Extent3D size;    // of an image
  vk::raii::DeviceMemory memory = nullptr;
  vk::raii::Buffer buffer = nullptr;  // or an image
  vk::raii::Image image = nullptr;
  vk::raii::ImageView view = nullptr;
  vk::raii::BufferView texels = nullptr;
  std::shared_ptr<Impl> of;  // of a view
};

struct Kernel::Impl {
  Device device;
  std::vector<Memory> memory;
  vk::raii::DescriptorSetLayout set_layout = nullptr;
  vk::raii::PipelineLayout layout = nullptr;
  vk::raii::Pipeline pipeline = nullptr;
  vk::raii::DescriptorPool pool = nullptr;
  vk::raii::DescriptorSet set = nullptr;
};

struct Commands::Impl {
  const vk::raii::CommandBuffer& vulkan;

  void bind(const Kernel::Impl& kernel, std::span<const std::byte> push) const;
  /// Later commands see earlier writes.
  void barrier() const;
};

inline constexpr vk::ImageSubresourceRange kWholeImage{vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1};

}  // namespace tdpt::gpu
