#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <mutex>

#include "libcommon/gpu/device_impl.h"

namespace tdpt::gpu {
namespace {

[[noreturn]] void no_device(const std::string& reason) {
  throw Error(Exit::no_device, reason);
}

// Messages that nobody has taken at the end of the process make it fail.
struct Messages {
  std::mutex mutex;
  std::vector<std::string> texts;
  ~Messages() {
    if (texts.empty()) return;
    fmt::print(stderr, "{} Vulkan validation messages\n", texts.size());
    std::fflush(nullptr);
    std::_Exit(static_cast<int>(Exit::internal));
  }
};
Messages& messages() {
  static Messages m;
  return m;
}

bool validating() {
  const char* v = std::getenv("TDPT_VULKAN_VALIDATION");
  return v && std::string_view(v) == "1";
}

VKAPI_ATTR VkBool32 VKAPI_CALL keep_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                            VkDebugUtilsMessageTypeFlagsEXT,
                                            const VkDebugUtilsMessengerCallbackDataEXT* data,
                                            void*) {
  const std::lock_guard lock(messages().mutex);
  fmt::print(stderr, "Vulkan validation: {}\n", data->pMessage);
  messages().texts.emplace_back(data->pMessage);
  return VK_FALSE;
}

vk::DebugUtilsMessengerCreateInfoEXT messenger_info() {
  messages();  // outlives every device
  using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
  return {{},
          Severity::eWarning | Severity::eError,
          vk::DebugUtilsMessageTypeFlagBitsEXT::eValidation,
          keep_message};
}

bool has_extension(const std::vector<vk::ExtensionProperties>& all, std::string_view name) {
  return std::any_of(all.begin(), all.end(),
                     [&](const auto& e) { return e.extensionName.data() == name; });
}

vk::raii::Instance make_instance() {
  static const vk::raii::Context* const context = [] {
    try {
      return new vk::raii::Context;  // the loader is opened once, and stays
    } catch (const std::exception&) {
      no_device("there is no Vulkan loader (libvulkan)");
    }
  }();
  if (!context->getDispatcher()->vkEnumerateInstanceVersion ||
      context->enumerateInstanceVersion() < VK_API_VERSION_1_2)
    no_device("the Vulkan loader is older than 1.2");
  const vk::ApplicationInfo app("tdpt", 0, nullptr, 0, VK_API_VERSION_1_2);
  vk::InstanceCreateInfo how({}, &app);
  std::vector<const char*> layers, extensions;
  if (has_extension(context->enumerateInstanceExtensionProperties(),
                    "VK_KHR_portability_enumeration")) {
    extensions.push_back("VK_KHR_portability_enumeration");
    how.flags |= vk::InstanceCreateFlagBits::eEnumeratePortabilityKHR;
  }
  const auto messenger = messenger_info();
  const auto enable = vk::ValidationFeatureEnableEXT::eSynchronizationValidation;
  const vk::ValidationFeaturesEXT features(enable, {}, &messenger);
  if (validating()) {
    layers.push_back("VK_LAYER_KHRONOS_validation");
    extensions.insert(extensions.end(), {"VK_EXT_debug_utils", "VK_EXT_validation_features"});
    how.pNext = &features;
  }
  how.setPEnabledLayerNames(layers).setPEnabledExtensionNames(extensions);
  try {
    return {*context, how};
  } catch (const vk::IncompatibleDriverError&) {
    no_device("there is no Vulkan driver");
  } catch (const vk::LayerNotPresentError&) {
    no_device("TDPT_VULKAN_VALIDATION=1, but the Khronos validation layer is not installed");
  }
}

/// The first queue family that computes.
uint32_t compute_family(const vk::raii::PhysicalDevice& device) {
  const auto families = device.getQueueFamilyProperties();
  uint32_t i = 0;
  while (i < families.size() && !(families[i].queueFlags & vk::QueueFlagBits::eCompute)) ++i;
  return i < families.size() ? i : UINT32_MAX;
}

std::string version_text(uint32_t v) {
  return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(v), VK_API_VERSION_MINOR(v),
                     VK_API_VERSION_PATCH(v));
}

DeviceInfo describe(const vk::raii::PhysicalDevice& device) {
  static constexpr const char* kKinds[] = {"other", "integrated", "discrete", "virtual", "cpu"};
  const vk::PhysicalDeviceProperties p = device.getProperties();
  DeviceInfo info{p.deviceName,
                  kKinds[std::min(4, static_cast<int>(p.deviceType))],
                  version_text(p.driverVersion),
                  version_text(p.apiVersion),
                  "",
                  {}};
  if (p.apiVersion < VK_API_VERSION_1_2) {
    info.unfit = "it has Vulkan " + info.vulkan + ", and 1.2 is needed";
    return info;
  }
  if (compute_family(device) == UINT32_MAX) {
    info.unfit = "it has no compute queue";
    return info;
  }
  const auto more =
      device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceVulkan11Properties,
                            vk::PhysicalDeviceVulkan12Properties>();
  const auto& v12 = more.get<vk::PhysicalDeviceVulkan12Properties>();
  info.driver = fmt::format("{} {}", v12.driverName.data(), v12.driverInfo.data());
  Limits& l = info.limits;
  const vk::PhysicalDeviceMemoryProperties heaps = device.getMemoryProperties();
  for (uint32_t i = 0; i < heaps.memoryHeapCount; ++i)
    if (heaps.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal)
      l.memory = std::max(l.memory, heaps.memoryHeaps[i].size);
  l.allocation =
      std::min(l.memory, more.get<vk::PhysicalDeviceVulkan11Properties>().maxMemoryAllocationSize);
  l.buffer = std::min<uint64_t>(p.limits.maxStorageBufferRange, l.allocation) / 4 * 4;
  l.groups = p.limits.maxComputeWorkGroupCount[0];
  l.group_size =
      std::min(p.limits.maxComputeWorkGroupInvocations, p.limits.maxComputeWorkGroupSize[0]);
  l.push_constants = p.limits.maxPushConstantsSize;
  l.buffers = p.limits.maxPerStageDescriptorStorageBuffers;
  l.images = p.limits.maxPerStageDescriptorStorageImages;
  try {
    using Usage = vk::ImageUsageFlagBits;
    const auto image = device.getImageFormatProperties(
        vk::Format::eR32Uint, vk::ImageType::e3D, vk::ImageTiling::eOptimal,
        Usage::eStorage | Usage::eTransferSrc | Usage::eTransferDst);
    l.image = std::min(image.maxResourceSize, l.allocation);
    l.image_side = std::min({image.maxExtent.width, image.maxExtent.height, image.maxExtent.depth});
  } catch (const vk::FormatNotSupportedError&) {
    info.unfit = "it has no 3D images of whole numbers";
  }
  return info;
}

std::string lower(std::string s) {
  for (char& c : s)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return s;
}

struct Found {
  vk::raii::Instance instance = make_instance();
  vk::raii::PhysicalDevices physical{instance};
  std::vector<DeviceInfo> infos;
  Found() {
#ifdef __SANITIZE_ADDRESS__
    // Keeps the drivers loaded, so that their leaks can be told from ours by their name
    // (lsan.supp).
    [[maybe_unused]] static const VkInstance kept = make_instance().release();
#endif
    if (physical.empty()) no_device("there is no Vulkan device");
    for (const auto& p : physical) infos.push_back(describe(p));
  }
};

}  // namespace

std::vector<std::string> take_validation_messages() {
  const std::lock_guard lock(messages().mutex);
  return std::exchange(messages().texts, {});
}

std::vector<DeviceInfo> list_devices() {
  return calling_vulkan("cannot list the Vulkan devices", [] { return Found().infos; });
}

size_t pick_device(const std::vector<DeviceInfo>& devices, const std::string& which) {
  std::string names;
  for (size_t i = 0; i < devices.size(); ++i)
    names += fmt::format("{}{}: {} ({})", i ? ", " : "", i, devices[i].name,
                         devices[i].unfit.empty() ? devices[i].kind : devices[i].unfit);
  std::vector<size_t> fitting;
  if (which.empty()) {
    for (const char* kind : {"discrete", "integrated", "virtual", "cpu", "other"})
      for (size_t i = 0; i < devices.size(); ++i)
        if (devices[i].kind == kind && devices[i].unfit.empty()) return i;
    no_device("no Vulkan device can be used; there are: " + names);
  }
  const bool number = which.find_first_not_of("0123456789") == std::string::npos;
  for (size_t i = 0; i < devices.size(); ++i)
    if (number ? std::to_string(i) == which
               : lower(devices[i].name).find(lower(which)) != std::string::npos)
      fitting.push_back(i);
  if (fitting.size() != 1)
    no_device(fmt::format("{} Vulkan device is called '{}'; there are: {}",
                          fitting.empty() ? "no" : "more than one", which, names));
  const DeviceInfo& d = devices[fitting[0]];
  if (!d.unfit.empty()) no_device(d.name + " cannot be used: " + d.unfit);
  return fitting[0];
}

Device Device::open(const std::string& which) {
  return calling_vulkan("cannot open a Vulkan device", [&] {
    Found found;
    const size_t i = pick_device(found.infos, which);
    auto impl = std::make_shared<Impl>();
    impl->info = found.infos[i];
    impl->instance = std::move(found.instance);
    if (validating()) impl->messenger = {impl->instance, messenger_info()};
    impl->create(found.physical[i]);
    return Device(impl);
  });
}

void Device::Impl::create(const vk::raii::PhysicalDevice& chosen) {
  physical = chosen;
  host_sees = info.kind == "integrated" || info.kind == "cpu";
  const uint32_t family = compute_family(physical);
  const float priority = 1;
  const vk::DeviceQueueCreateInfo queues({}, family, 1, &priority);
  std::vector<const char*> extensions;
  if (has_extension(physical.enumerateDeviceExtensionProperties(), "VK_KHR_portability_subset"))
    extensions.push_back("VK_KHR_portability_subset");
  device = {physical, vk::DeviceCreateInfo({}, queues, {}, extensions)};
  queue = {device, family, 0};
  pool = {device, vk::CommandPoolCreateInfo({}, family)};
  commands =
      std::move(vk::raii::CommandBuffers(device, {*pool, vk::CommandBufferLevel::ePrimary, 1})[0]);
  fence = {device, vk::FenceCreateInfo()};
  const uint32_t bits = physical.getQueueFamilyProperties()[family].timestampValidBits;
  if (bits == 0) return;
  tick = 1e-9 * double{physical.getProperties().limits.timestampPeriod};
  tick_mask = UINT64_MAX >> (64 - bits);
  queries = {device, vk::QueryPoolCreateInfo({}, vk::QueryType::eTimestamp, 2)};
}

const DeviceInfo& Device::info() const {
  return impl_->info;
}

double Device::run(const std::function<void(Commands&)>& record) {
  Commands::Impl impl{*impl_, {}, {}};  // lives until the device is done
  Commands commands(impl);
  return calling_vulkan("cannot run on " + info().name,
                        [&] { return impl_->run([&] { record(commands); }); });
}

void Device::Impl::require_idle() const {
  if (recording) throw Error(Exit::internal, "commands are recorded while others are");
}

double Device::Impl::run(const std::function<void()>& record) {
  require_idle();
  pool.reset();
  commands.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
  if (tick > 0) {
    commands.resetQueryPool(*queries, 0, 2);
    commands.writeTimestamp(vk::PipelineStageFlagBits::eTopOfPipe, *queries, 0);
  }
  barrier();
  {
    const struct Recording {
      bool& on;
      ~Recording() { on = false; }
    } until_here{recording = true};
    record();
  }
  if (tick > 0) commands.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *queries, 1);
  commands.end();
  const auto start = std::chrono::steady_clock::now();
  device.resetFences(*fence);
  queue.submit(vk::SubmitInfo({}, {}, *commands), *fence);
  (void)device.waitForFences(*fence, true, UINT64_MAX);
  if (tick <= 0)
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto ticks = queries.getResults<uint64_t>(0, 2, 16, 8, vk::QueryResultFlagBits::e64).second;
  return tick * static_cast<double>((ticks[1] - ticks[0]) & tick_mask);
}

void Device::Impl::barrier() const {
  using Stage = vk::PipelineStageFlagBits;
  using Access = vk::AccessFlagBits;
  const vk::PipelineStageFlags work =
      Stage::eComputeShader | Stage::eTransfer | Stage::eDrawIndirect;
  const vk::AccessFlags writes = Access::eShaderWrite | Access::eTransferWrite;
  const vk::AccessFlags reads = Access::eShaderRead | Access::eTransferRead |
                                Access::eIndirectCommandRead | Access::eHostRead;
  commands.pipelineBarrier(work, work | Stage::eHost, {}, vk::MemoryBarrier(writes, writes | reads),
                           {}, {});
}

}  // namespace tdpt::gpu
