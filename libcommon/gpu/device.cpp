#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>

#include "libcommon/gpu/device_impl.h"

namespace tdpt::gpu {
namespace {

constexpr const char* kNoDriver =
    "there is no Vulkan driver: that of the device's maker, or Debian's package "
    "mesa-vulkan-drivers";

[[noreturn]] void no_device(const std::string& reason) {
  throw Error(Exit::no_device, reason);
}

bool validating() {
  const char* v = std::getenv("TDPT_VULKAN_VALIDATION");
  return v && std::string_view(v) == "1";
}

VKAPI_ATTR VkBool32 VKAPI_CALL fail_by_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                               VkDebugUtilsMessageTypeFlagsEXT,
                                               const VkDebugUtilsMessengerCallbackDataEXT* data,
                                               void*) {
  fmt::print(stderr, "Vulkan validation: {}: {}\n",
             data->pMessageIdName ? data->pMessageIdName : "", data->pMessage);
  std::fflush(nullptr);
  std::_Exit(static_cast<int>(Exit::internal));
}

// The C interface, since vulkan.hpp has changed the callback's type.
vk::raii::DebugUtilsMessengerEXT make_messenger(const vk::raii::Instance& instance) {
  VkDebugUtilsMessengerCreateInfoEXT info{};
  info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
  info.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                         VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  info.pfnUserCallback = fail_by_message;
  return {instance, vk::DebugUtilsMessengerCreateInfoEXT(info)};
}

const vk::raii::Context& loader() try {
  static const vk::raii::Context* const opened = new vk::raii::Context;  // never destroyed
  return *opened;
} catch (const std::exception&) {
  no_device("there is no Vulkan loader (libvulkan), Debian's package libvulkan1");
}

vk::raii::Instance make_instance() {
  const vk::ApplicationInfo app("tdpt", 0, nullptr, 0, VK_API_VERSION_1_2);
  const auto enable = vk::ValidationFeatureEnableEXT::eSynchronizationValidation;
  const vk::ValidationFeaturesEXT features(enable);
  std::vector<const char*> layers, extensions;
  if (validating()) {
    layers = {"VK_LAYER_KHRONOS_validation"};
    extensions = {"VK_EXT_debug_utils", "VK_EXT_validation_features"};
  }
  try {
    return {loader(), {{}, &app, layers, extensions, validating() ? &features : nullptr}};
  } catch (const vk::IncompatibleDriverError&) {
    no_device(kNoDriver);
  } catch (const vk::LayerNotPresentError&) {
    no_device("TDPT_VULKAN_VALIDATION=1, but the Khronos validation layer is not installed");
  }
}

/// The first queue family with compute; UINT32_MAX: none.
uint32_t compute_family(const vk::raii::PhysicalDevice& device) {
  const auto families = device.getQueueFamilyProperties();
  for (uint32_t i = 0; i < families.size(); ++i)
    if (families[i].queueFlags & vk::QueueFlagBits::eCompute) return i;
  return UINT32_MAX;
}

Limits limits_of(const vk::raii::PhysicalDevice& device) {
  Limits l;
  const vk::PhysicalDeviceMemoryProperties all = device.getMemoryProperties();
  for (uint32_t i = 0; i < all.memoryHeapCount; ++i)
    if (all.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal)
      l.memory = std::max(l.memory, all.memoryHeaps[i].size);
  using More = vk::PhysicalDeviceMaintenance3Properties;
  const auto p = device.getProperties2<vk::PhysicalDeviceProperties2, More>();
  const vk::PhysicalDeviceLimits& limits = p.get<vk::PhysicalDeviceProperties2>().properties.limits;
  const uint64_t allocation = std::min(l.memory, p.get<More>().maxMemoryAllocationSize);
  l.buffer = std::min<uint64_t>(limits.maxStorageBufferRange, allocation);
  l.image = std::min(uint64_t{1} << 31, allocation);  // no device allows less than 2^31
  l.image_side = limits.maxImageDimension3D;
  // Kernels index texels with int, and their words with uint.
  constexpr uint64_t kTexel = 16, kMostTexels = uint64_t{1} << 30;
  l.texels =
      std::min(kTexel * std::min<uint64_t>(limits.maxTexelBufferElements, kMostTexels), allocation);
  l.buffers =
      std::min(limits.maxPerStageDescriptorStorageBuffers, limits.maxDescriptorSetStorageBuffers);
  l.groups = limits.maxComputeWorkGroupCount[0];
  return l;
}

DeviceInfo describe(const vk::raii::PhysicalDevice& device) {
  static constexpr const char* kKinds[] = {"other", "integrated", "discrete", "virtual", "cpu"};
  const vk::PhysicalDeviceProperties p = device.getProperties();
  const uint32_t v = p.apiVersion;
  DeviceInfo info{p.deviceName, kKinds[std::min(4, static_cast<int>(p.deviceType))], "", {}};
  if (v < VK_API_VERSION_1_2)
    info.unfit = fmt::format("it has Vulkan {}.{}, and 1.2 is needed", VK_API_VERSION_MAJOR(v),
                             VK_API_VERSION_MINOR(v));
  else if (compute_family(device) == UINT32_MAX)
    info.unfit = "it has no compute queue";
  else
    info.limits = limits_of(device);
  return info;
}

std::vector<DeviceInfo> describe_all(const vk::raii::PhysicalDevices& devices) {
#ifdef __SANITIZE_ADDRESS__
  // Keeps the drivers loaded, so that leak reports name them and can be suppressed (lsan.supp).
  [[maybe_unused]] static const VkInstance kept = make_instance().release();
#endif
  if (devices.empty()) no_device("there is no Vulkan device");
  std::vector<DeviceInfo> infos;
  for (const auto& d : devices) infos.push_back(describe(d));
  return infos;
}

}  // namespace

std::vector<DeviceInfo> list_devices() {
  return calling_vulkan("cannot list the Vulkan devices", [] {
    const vk::raii::Instance instance = make_instance();
    return describe_all(vk::raii::PhysicalDevices(instance));
  });
}

size_t pick_device(const std::vector<DeviceInfo>& devices, const std::string& which) {
  const bool number = !which.empty() && which.find_first_not_of("0123456789") == std::string::npos;
  const auto is_meant = [&](size_t i) {
    return number ? std::to_string(i) == which
                  : strcasestr(devices[i].name.c_str(), which.c_str()) != nullptr;
  };
  for (const char* kind : {"discrete", "integrated", "virtual", "cpu", "other"})
    for (size_t i = 0; i < devices.size(); ++i)
      if (devices[i].kind == kind && devices[i].unfit.empty() && is_meant(i)) return i;
  std::string all;
  for (size_t i = 0; i < devices.size(); ++i)
    all += fmt::format("{}{}: {} ({})", i ? ", " : "", i, devices[i].name,
                       devices[i].unfit.empty() ? devices[i].kind : devices[i].unfit);
  const std::string asked = which.empty() ? "" : "'" + which + "' ";
  no_device("no Vulkan device " + asked + "can be used; there are: " + all);
}

Device Device::open(const std::string& which) {
  return calling_vulkan("cannot open a Vulkan device", [&] {
    auto impl = std::make_shared<Impl>();
    impl->instance = make_instance();
    const vk::raii::PhysicalDevices all(impl->instance);
    const std::vector<DeviceInfo> infos = describe_all(all);
    const size_t i = pick_device(infos, which);
    impl->info = infos[i];
    if (validating()) impl->messenger = make_messenger(impl->instance);
    impl->physical = all[i];
    impl->limits = all[i].getProperties().limits;
    const uint32_t family = compute_family(all[i]);
    const float priority = 1;
    const vk::DeviceQueueCreateInfo queues({}, family, 1, &priority);
    impl->device = {impl->physical, vk::DeviceCreateInfo({}, queues)};
    impl->queue = {impl->device, family, 0};
    impl->pool = {impl->device, vk::CommandPoolCreateInfo({}, family)};
    return Device(impl);
  });
}

void Device::Impl::require_within(uint64_t limit, const char* what, uint64_t asked) const {
  if (asked > limit)
    throw Error(Exit::no_device,
                fmt::format("{} allows {} {}; {} are asked for", info.name, limit, what, asked));
}

const DeviceInfo& Device::info() const {
  return impl_->info;
}

double Device::run(const std::function<void(Commands&)>& record) {
  return calling_vulkan("cannot run on " + info().name, [&] {
    const vk::raii::CommandBuffers buffers(impl_->device,
                                           {*impl_->pool, vk::CommandBufferLevel::ePrimary, 1});
    const Commands::Impl recorded{buffers[0]};
    Commands commands(recorded);
    buffers[0].begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    record(commands);
    recorded.barrier();  // later commands and the host see all writes
    buffers[0].end();
    const auto start = std::chrono::steady_clock::now();
    impl_->queue.submit(vk::SubmitInfo({}, {}, *buffers[0]));
    impl_->queue.waitIdle();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  });
}

}  // namespace tdpt::gpu
