#include "libcommon/gpu/statistics_bench.h"

#include <algorithm>
#include <map>

#include "libcommon/gpu/device_impl.h"

namespace tdpt::gpu {
namespace {

constexpr auto kCompute = vk::ShaderStageFlagBits::eCompute;

// The same physical device once more, which tells of its kernels.
vk::raii::Device telling_device(const Device::Impl& d) {
  const float priority = 1;
  const vk::DeviceQueueCreateInfo queues({}, 0, 1, &priority);
  const char* const tells = VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME;
  const auto all = d.physical.enumerateDeviceExtensionProperties();
  if (std::none_of(all.begin(), all.end(), [&](const vk::ExtensionProperties& e) {
        return std::string_view(e.extensionName.data()) == tells;
      }))
    throw Error(Exit::no_device,
                "the driver of " + d.info.name + " tells nothing of kernels: it lacks " + tells);
  const vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR feature(VK_TRUE);
  return {d.physical, vk::DeviceCreateInfo({}, queues, {}, tells, nullptr, &feature)};
}

// The bindings of a program, typed by the storage classes of its variables.
std::vector<vk::DescriptorSetLayoutBinding> layout_of(std::span<const uint32_t> program) {
  constexpr uint32_t kHeader = 5, kOpVariable = 59, kOpDecorate = 71, kBinding = 33;
  constexpr uint32_t kUniform = 2, kStorageBuffer = 12;
  std::map<uint32_t, uint32_t> class_of;
  std::vector<std::pair<uint32_t, uint32_t>> bound;  // variable, binding
  for (size_t i = kHeader; i < program.size() && program[i] >> 16 != 0; i += program[i] >> 16) {
    const uint32_t op = program[i] & 0xFFFF;
    if (op == kOpVariable) class_of[program[i + 2]] = program[i + 3];
    if (op == kOpDecorate && program[i + 2] == kBinding)
      bound.emplace_back(program[i + 1], program[i + 3]);
  }
  using Type = vk::DescriptorType;
  std::vector<vk::DescriptorSetLayoutBinding> slots;
  for (const auto& [variable, binding] : bound) {
    const uint32_t storage = class_of[variable];
    const Type type = storage == kStorageBuffer ? Type::eStorageBuffer
                      : storage == kUniform     ? Type::eUniformBuffer
                                                : Type::eUniformTexelBuffer;
    slots.emplace_back(binding, type, 1, kCompute);
  }
  return slots;
}

double value_of(const vk::PipelineExecutableStatisticKHR& s) {
  switch (s.format) {
    case vk::PipelineExecutableStatisticFormatKHR::eBool32:
      return s.value.b32 ? 1 : 0;
    case vk::PipelineExecutableStatisticFormatKHR::eInt64:
      return static_cast<double>(s.value.i64);
    case vk::PipelineExecutableStatisticFormatKHR::eFloat64:
      return s.value.f64;
    default:
      return static_cast<double>(s.value.u64);
  }
}

}  // namespace

std::vector<Statistic> statistics_of(const Device& device, std::span<const uint32_t> program,
                                     uint32_t push_bytes, const std::vector<uint32_t>& constants) {
  return calling_vulkan("nothing is told of a kernel on " + device.info().name, [&] {
    const vk::raii::Device vulkan = telling_device(*device.impl());
    const std::vector<vk::DescriptorSetLayoutBinding> slots = layout_of(program);
    const vk::raii::DescriptorSetLayout set(vulkan, vk::DescriptorSetLayoutCreateInfo({}, slots));
    const vk::PushConstantRange push(kCompute, 0, push_bytes);
    const vk::raii::PipelineLayout layout(vulkan, {{}, 1, &*set, push_bytes > 0, &push});
    const vk::raii::ShaderModule module(vulkan, {{}, program.size_bytes(), program.data()});
    std::vector<vk::SpecializationMapEntry> entries;
    for (uint32_t i = 0; i < constants.size(); ++i) entries.emplace_back(i, 4 * i, 4);
    const vk::SpecializationInfo special(static_cast<uint32_t>(entries.size()), entries.data(),
                                         4 * constants.size(), constants.data());
    const vk::PipelineShaderStageCreateInfo stage({}, kCompute, *module, "main", &special);
    const vk::raii::Pipeline pipeline(
        vulkan, nullptr,
        vk::ComputePipelineCreateInfo(vk::PipelineCreateFlagBits::eCaptureStatisticsKHR, stage,
                                      *layout));
    std::vector<Statistic> all;
    for (const vk::PipelineExecutableStatisticKHR& s :
         vulkan.getPipelineExecutableStatisticsKHR({*pipeline, 0}))
      all.push_back({s.name.data(), value_of(s)});
    return all;
  });
}

}  // namespace tdpt::gpu
