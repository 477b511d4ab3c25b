#include <algorithm>

#include "libcommon/gpu/device_impl.h"

namespace tdpt::gpu {
namespace {

vk::DescriptorType type_of(Binding b) {
  return b == Binding::buffer ? vk::DescriptorType::eStorageBuffer
                              : vk::DescriptorType::eStorageImage;
}
constexpr auto kCompute = vk::ShaderStageFlagBits::eCompute;

}  // namespace

Kernel::Kernel(const Device& device, std::span<const uint32_t> program,
               const std::vector<Binding>& bindings, uint32_t push_bytes,
               const std::vector<uint32_t>& constants) {
  const DeviceInfo& info = device.info();
  const Limits& limits = info.limits;
  const auto buffers =
      static_cast<size_t>(std::count(bindings.begin(), bindings.end(), Binding::buffer));
  require_within(info, limits.buffers, "buffers in a kernel", buffers);
  require_within(info, limits.images, "images in a kernel", bindings.size() - buffers);
  require_within(info, limits.push_constants, "bytes of push constants", push_bytes);
  calling_vulkan("no kernel on " + info.name, [&] {
    const vk::raii::Device& d = device.impl()->device;
    impl_ = std::make_shared<Impl>(Impl{device.impl(), bindings, push_bytes});
    std::vector<vk::DescriptorSetLayoutBinding> slots;
    for (uint32_t i = 0; i < bindings.size(); ++i)
      slots.emplace_back(i, type_of(bindings[i]), 1, kCompute);
    impl_->set_layout = {d, vk::DescriptorSetLayoutCreateInfo({}, slots)};
    const vk::PushConstantRange push(kCompute, 0, push_bytes);
    impl_->layout = {
        d, vk::PipelineLayoutCreateInfo({}, 1, &*impl_->set_layout, push_bytes > 0, &push)};
    const vk::raii::ShaderModule module(
        d, vk::ShaderModuleCreateInfo({}, program.size_bytes(), program.data()));
    std::vector<vk::SpecializationMapEntry> entries;
    for (uint32_t i = 0; i < constants.size(); ++i) entries.emplace_back(i, 4 * i, 4);
    const vk::SpecializationInfo specialization(static_cast<uint32_t>(entries.size()),
                                                entries.data(), 4 * constants.size(),
                                                constants.data());
    impl_->pipeline = {d, nullptr,
                       vk::ComputePipelineCreateInfo(
                           {}, {{}, kCompute, *module, "main", &specialization}, *impl_->layout)};
  });
}

void Commands::Impl::bind(const Kernel::Impl& kernel, const std::vector<Bound>& bound,
                          const Push& push) {
  bool right = bound.size() == kernel.bindings.size() && push.bytes.size() == kernel.push_bytes;
  for (size_t i = 0; right && i < bound.size(); ++i)
    right = (bound[i].buffer != nullptr) == (kernel.bindings[i] == Binding::buffer);
  if (!right) throw Error(Exit::internal, "a kernel is given other arguments than it declares");
  const vk::raii::CommandBuffer& commands = device.commands;
  commands.bindPipeline(vk::PipelineBindPoint::eCompute, *kernel.pipeline);
  if (!push.bytes.empty())
    commands.pushConstants<std::byte>(
        *kernel.layout, kCompute, 0, {static_cast<uint32_t>(push.bytes.size()), push.bytes.data()});
  if (bound.empty()) return;
  std::vector<vk::DescriptorPoolSize> sizes;
  for (const Binding b : kernel.bindings) sizes.emplace_back(type_of(b), 1);
  pools.emplace_back(
      device.device,
      vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, sizes));
  sets.push_back(
      std::move(vk::raii::DescriptorSets(device.device, {*pools.back(), *kernel.set_layout})[0]));
  for (uint32_t i = 0; i < bound.size(); ++i) {
    vk::DescriptorBufferInfo buffer;
    vk::DescriptorImageInfo image;
    vk::WriteDescriptorSet write(*sets.back(), i, 0, 1, type_of(kernel.bindings[i]));
    if (bound[i].buffer) {
      buffer.setBuffer(*bound[i].buffer->impl().block.buffer).setRange(VK_WHOLE_SIZE);
      write.pBufferInfo = &buffer;
    } else {
      image.setImageView(*bound[i].image->impl().view).setImageLayout(vk::ImageLayout::eGeneral);
      write.pImageInfo = &image;
    }
    device.device.updateDescriptorSets(write, {});
  }
  commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *kernel.layout, 0, *sets.back(), {});
}

void Commands::dispatch(const Kernel& kernel, const std::vector<Bound>& bound, Push push,
                        uint32_t groups) {
  const DeviceInfo& info = impl_.device.info;
  require_within(info, info.limits.groups, "work groups in a dispatch", groups);
  impl_.bind(kernel.impl(), bound, push);
  impl_.device.commands.dispatch(groups, 1, 1);
  impl_.device.barrier();
}

void Commands::dispatch_indirect(const Kernel& kernel, const std::vector<Bound>& bound, Push push,
                                 const Buffer& groups, uint64_t offset) {
  if (offset % 4 != 0 || groups.bytes() < 12 || offset > groups.bytes() - 12)
    throw Error(Exit::internal,
                fmt::format("work groups at byte {} of a buffer of {}", offset, groups.bytes()));
  impl_.bind(kernel.impl(), bound, push);
  impl_.device.commands.dispatchIndirect(*groups.impl().block.buffer, offset);
  impl_.device.barrier();
}

void Commands::fill(const Buffer& buffer, uint32_t word) {
  impl_.device.commands.fillBuffer(*buffer.impl().block.buffer, 0, VK_WHOLE_SIZE, word);
  impl_.device.barrier();
}

void Commands::clear(const Image3D& image, uint32_t texel) {
  const std::array<uint32_t, 4> colour{texel, 0, 0, 0};
  impl_.device.commands.clearColorImage(*image.impl().image, vk::ImageLayout::eGeneral,
                                        vk::ClearColorValue(colour), kWholeImage);
  impl_.device.barrier();
}

}  // namespace tdpt::gpu
