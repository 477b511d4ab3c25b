
#include "libcommon/gpu/device_impl.h"

namespace tdpt::gpu {
namespace {

constexpr auto kCompute = vk::ShaderStageFlagBits::eCompute;

vk::raii::Pipeline make_pipeline(const Device::Impl& d, std::span<const uint32_t> program,
                                 const vk::raii::PipelineLayout& layout,
                                 const std::vector<uint32_t>& constants) {
  const vk::raii::ShaderModule module(d.device, {{}, program.size_bytes(), program.data()});
  std::vector<vk::SpecializationMapEntry> entries;
  for (uint32_t i = 0; i < constants.size(); ++i) entries.emplace_back(i, 4 * i, 4);
  const vk::SpecializationInfo special(static_cast<uint32_t>(entries.size()), entries.data(),
                                       4 * constants.size(), constants.data());
  const vk::PipelineShaderStageCreateInfo stage({}, kCompute, *module, "main", &special);
  return {d.device, nullptr, vk::ComputePipelineCreateInfo({}, stage, *layout)};
}

// Calls see(words) for each SPIR-V instruction; its first word holds the opcode.
template <class See>
void for_instructions(std::span<const uint32_t> program, const See& see) {
  constexpr size_t kHeader = 5;
  for (size_t i = kHeader; i < program.size() && program[i] >> 16 != 0; i += program[i] >> 16)
    see(program.subspan(i, program[i] >> 16));
}

// The values that OpDecorate assigns to a program's variables or constants.
std::set<uint32_t> decorated(std::span<const uint32_t> program, uint32_t decoration) {
  constexpr uint32_t kOpDecorate = 71;
  std::set<uint32_t> numbers;
  for_instructions(program, [&](std::span<const uint32_t> words) {
    if ((words[0] & 0xFFFF) == kOpDecorate && words[2] == decoration) numbers.insert(words[3]);
  });
  return numbers;
}

std::set<uint32_t> bindings_of(std::span<const uint32_t> program) {
  constexpr uint32_t kBinding = 33;
  return decorated(program, kBinding);
}

}  // namespace

size_t storage_buffers_in(std::span<const uint32_t> program) {
  constexpr uint32_t kOpVariable = 59, kStorageBuffer = 12;
  size_t n = 0;
  for_instructions(program, [&](std::span<const uint32_t> words) {
    n += (words[0] & 0xFFFF) == kOpVariable && words[3] == kStorageBuffer;
  });
  return n;
}

std::set<uint32_t> constants_of(std::span<const uint32_t> program) {
  constexpr uint32_t kSpecId = 1;
  return decorated(program, kSpecId);
}

Kernel::Kernel(const Device& device, std::span<const uint32_t> program,
               const std::vector<Memory>& memory, uint32_t push_bytes,
               const std::vector<uint32_t>& constants)
    : impl_(std::make_shared<Impl>(Impl{device, memory})) {
  const Device::Impl& d = *device.impl();
  std::vector<vk::DescriptorSetLayoutBinding> slots;
  std::vector<vk::DescriptorPoolSize> sizes;
  const std::set<uint32_t> named = bindings_of(program);
  for (uint32_t i = 0; i < memory.size(); ++i) {
    if (!named.contains(i)) continue;
    const vk::DescriptorType type = memory[i].impl().type;
    slots.emplace_back(i, type, 1, kCompute);
    sizes.emplace_back(type, 1);
  }
  // Every device allows what kernels have of all else.
  d.require_within(d.limits.maxPerStageDescriptorStorageBuffers, "buffers in a kernel",
                   storage_buffers_in(program));
  calling_vulkan("no kernel on " + d.info.name, [&] {
    Impl& k = *impl_;
    k.set_layout = {d.device, vk::DescriptorSetLayoutCreateInfo({}, slots)};
    const vk::PushConstantRange push(kCompute, 0, push_bytes);
    k.layout = {d.device, {{}, 1, &*k.set_layout, push_bytes > 0, &push}};
    k.pipeline = make_pipeline(d, program, k.layout, constants);
    k.pool = {d.device, {vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, sizes}};
    k.set = std::move(vk::raii::DescriptorSets(d.device, {*k.pool, *k.set_layout})[0]);
    for (const vk::DescriptorSetLayoutBinding& slot : slots) {
      const uint32_t i = slot.binding;
      const Memory::Impl& m = memory[i].impl();
      const vk::DescriptorBufferInfo buffer(m.whole(), m.offset, m.of ? m.bytes : VK_WHOLE_SIZE);
      const vk::DescriptorImageInfo image({}, *m.view, vk::ImageLayout::eGeneral);
      // The type selects which of them is read.
      d.device.updateDescriptorSets(
          vk::WriteDescriptorSet(*k.set, i, 0, 1, m.type, &image, &buffer, &*m.texels), {});
    }
  });
}

void Commands::Impl::bind(const Kernel::Impl& kernel, std::span<const std::byte> push) const {
  const auto size = static_cast<uint32_t>(push.size());
  vulkan.bindPipeline(vk::PipelineBindPoint::eCompute, *kernel.pipeline);
  vulkan.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *kernel.layout, 0, *kernel.set, {});
  if (size > 0) vulkan.pushConstants<std::byte>(*kernel.layout, kCompute, 0, {size, push.data()});
}

void Commands::Impl::barrier() const {
  using Stage = vk::PipelineStageFlagBits;
  using Access = vk::AccessFlagBits;
  const vk::MemoryBarrier all(Access::eMemoryWrite, Access::eMemoryRead | Access::eMemoryWrite);
  vulkan.pipelineBarrier(Stage::eAllCommands, Stage::eAllCommands | Stage::eHost, {}, all, {}, {});
}

void Commands::dispatch(const Kernel& kernel, std::span<const std::byte> push, uint32_t groups) {
  const Device::Impl& d = *kernel.impl().device.impl();
  d.require_within(d.limits.maxComputeWorkGroupCount[0], "work groups in a dispatch", groups);
  impl_.bind(kernel.impl(), push);
  impl_.vulkan.dispatch(groups, 1, 1);
  impl_.barrier();
}

void Commands::dispatch_indirect(const Kernel& kernel, std::span<const std::byte> push,
                                 const Buffer& groups, uint64_t offset) {
  impl_.bind(kernel.impl(), push);
  impl_.vulkan.dispatchIndirect(*groups.impl().buffer, offset);
  impl_.barrier();
}

void Commands::clear(const Image3D& image) {
  // Discards the old contents, so the image may be new and without a layout.
  const vk::ImageMemoryBarrier to_general({}, vk::AccessFlagBits::eTransferWrite,
                                          vk::ImageLayout::eUndefined, vk::ImageLayout::eGeneral, 0,
                                          0, *image.impl().image, kWholeImage);
  impl_.vulkan.pipelineBarrier(vk::PipelineStageFlagBits::eAllCommands,
                               vk::PipelineStageFlagBits::eTransfer, {}, {}, {}, to_general);
  impl_.vulkan.clearColorImage(*image.impl().image, vk::ImageLayout::eGeneral,
                               vk::ClearColorValue(), kWholeImage);
  impl_.barrier();
}

void Commands::clear(const Buffer& buffer) {
  impl_.vulkan.fillBuffer(*buffer.impl().buffer, 0, VK_WHOLE_SIZE, 0);
  impl_.barrier();
}

}  // namespace tdpt::gpu
