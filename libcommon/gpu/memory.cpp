#include <algorithm>
#include <cstring>

#include "libcommon/gpu/device_impl.h"
#include "libcommon/gpu/kernel.h"

namespace tdpt::gpu {
namespace {

using Kind = vk::MemoryPropertyFlagBits;
using Kinds = std::vector<vk::MemoryPropertyFlags>;  // in order of preference
const vk::MemoryPropertyFlags kSeen = Kind::eHostVisible | Kind::eHostCoherent;
const Kinds kHost{kSeen | Kind::eHostCached, kSeen}, kDevice{Kind::eDeviceLocal};
constexpr uint64_t kTexel = 16;
constexpr auto kCopied =
    vk::BufferUsageFlagBits::eTransferSrc | vk::BufferUsageFlagBits::eTransferDst;

/// Allocates memory for a buffer or an image. Every device has some of the last kind in the list.
template <class Resource>
vk::raii::DeviceMemory allocate(const Device::Impl& d, const Resource& resource,
                                const Kinds& kinds) {
  const vk::MemoryRequirements need = resource.getMemoryRequirements();
  const vk::PhysicalDeviceMemoryProperties all = d.physical.getMemoryProperties();
  for (const vk::MemoryPropertyFlags kind : kinds)
    for (uint32_t i = 0; i < all.memoryTypeCount; ++i) {
      const vk::MemoryType& type = all.memoryTypes[i];
      const bool large_enough = need.size <= all.memoryHeaps[type.heapIndex].size;
      if (!(need.memoryTypeBits >> i & 1) || (type.propertyFlags & kind) != kind || !large_enough)
        continue;
      vk::raii::DeviceMemory memory(d.device, {need.size, i});
      resource.bindMemory(*memory, 0);
      return memory;
    }
  throw Error(Exit::no_device, fmt::format("{} has no memory for {} bytes that is {}", d.info.name,
                                           need.size, vk::to_string(kinds.back())));
}

Staging make_staging(const Device::Impl& d, uint64_t size) {
  Staging s;
  s.buffer = {d.device, {{}, size, kCopied}};
  s.memory = allocate(d, s.buffer, kHost);
  s.bytes = static_cast<std::byte*>(s.memory.mapMemory(0, VK_WHOLE_SIZE));
  s.size = size;
  return s;
}

/// Copies between host and device in pieces; one of `from` and `to` is empty. record(commands,
/// staging, at, n) records the copy of bytes at .. at + n - 1. The total and each piece are
/// multiples of `unit`.
template <class Record>
void copy(Device device, std::span<const std::byte> from, std::span<std::byte> to, uint64_t unit,
          Record record) {
  const uint64_t size = from.size() + to.size();
  if (size == 0) return;
  calling_vulkan("cannot copy on " + device.info().name, [&] {
    Device::Impl& d = *device.impl();
    const uint64_t most = std::max<uint64_t>(d.piece / unit, 1) * unit;
    if (d.staging.size < std::min(size, most)) d.staging = make_staging(d, std::min(size, most));
    const Staging& staging = d.staging;
    for (uint64_t at = 0; at < size; at += most) {
      const uint64_t n = std::min(most, size - at);
      if (!from.empty()) std::memcpy(staging.bytes, &from[at], n);
      device.run([&](Commands& c) { record(c.impl().vulkan, *staging.buffer, at, n); });
      if (!to.empty()) std::memcpy(&to[at], staging.bytes, n);
    }
  });
}

void require_inside(uint64_t at, uint64_t asked, uint64_t bytes) {
  if (asked > bytes || at > bytes - asked)
    throw Error(Exit::internal,
                fmt::format("{} bytes from byte {} of a buffer of {}", asked, at, bytes));
}

std::shared_ptr<Memory::Impl> view_of(const std::shared_ptr<Memory::Impl>& whole,
                                      vk::DescriptorType type) {
  auto view = std::make_shared<Memory::Impl>(whole->device, type, whole->bytes);
  view->of = whole;
  return view;
}

}  // namespace

Buffer::Buffer(const Device& device, uint64_t bytes)
    : Buffer(device, bytes, device.limits().buffer, "bytes in a buffer") {}

Buffer Buffer::of_parts(const Device& device, uint64_t bytes) {
  return {device, bytes, device.limits().texels, "bytes in a buffer of texels"};
}

Buffer::Buffer(const Device& device, uint64_t bytes, uint64_t most, const char* what) {
  const Device::Impl& d = *device.impl();
  d.require_within(most, what, bytes);
  calling_vulkan(fmt::format("no buffer of {} bytes on {}", bytes, d.info.name), [&] {
    using Usage = vk::BufferUsageFlagBits;
    const vk::BufferUsageFlags usage = kCopied | Usage::eStorageBuffer | Usage::eIndirectBuffer |
                                       Usage::eUniformTexelBuffer | Usage::eUniformBuffer;
    impl_ = std::make_shared<Impl>(device, vk::DescriptorType::eStorageBuffer, bytes);
    impl_->buffer = {d.device, {{}, std::max<uint64_t>(bytes, 16), usage}};
    impl_->memory = allocate(d, impl_->buffer, kDevice);
  });
}

uint64_t Buffer::bytes() const {
  return impl_->bytes;
}

void Buffer::write(std::span<const std::byte> from, uint64_t at) {
  require_inside(at, from.size(), impl_->bytes);
  copy(impl_->device, from, {}, 1,
       [&](auto& commands, vk::Buffer staging, uint64_t piece, uint64_t n) {
         commands.copyBuffer(staging, *impl_->buffer, vk::BufferCopy(0, at + piece, n));
       });
}

void Buffer::read(std::span<std::byte> to, uint64_t at) const {
  require_inside(at, to.size(), impl_->bytes);
  copy(impl_->device, {}, to, 1,
       [&](auto& commands, vk::Buffer staging, uint64_t piece, uint64_t n) {
         commands.copyBuffer(*impl_->buffer, staging, vk::BufferCopy(at + piece, 0, n));
       });
}

Memory Buffer::part(uint64_t offset, uint64_t bytes) const {
  require_inside(offset, bytes, impl_->bytes);
  const Device::Impl& d = *impl_->device.impl();
  d.require_within(d.info.limits.buffer, "bytes in a buffer", bytes);
  const auto part = view_of(impl_, vk::DescriptorType::eStorageBuffer);
  part->offset = offset;
  part->bytes = bytes;
  return Memory(part);
}

Memory Buffer::texels() const {
  const Device::Impl& d = *impl_->device.impl();
  d.require_within(d.info.limits.texels, "bytes in a buffer of texels", impl_->bytes);
  return calling_vulkan("no texels of a buffer on " + d.info.name, [&] {
    const auto texels = view_of(impl_, vk::DescriptorType::eUniformTexelBuffer);
    const auto format = vk::Format::eR32G32B32A32Uint;
    texels->texels = {d.device, {{}, *impl_->buffer, format, 0, VK_WHOLE_SIZE}};
    return Memory(texels);
  });
}

Memory Buffer::uniforms() const {
  return Memory(view_of(impl_, vk::DescriptorType::eUniformBuffer));
}

Image3D::Image3D(const Device& device, const std::array<uint32_t, 3>& size, Texel texel) {
  const Device::Impl& d = *device.impl();
  for (const uint32_t side : size)
    d.require_within(d.info.limits.image_side, "texels along a side of a 3D image", side);
  const uint64_t bytes = uint64_t{4} * size[0] * size[1] * size[2];
  d.require_within(d.info.limits.image, "bytes in a 3D image", bytes);
  calling_vulkan(fmt::format("no 3D image of {} bytes on {}", bytes, d.info.name), [&] {
    using Usage = vk::ImageUsageFlagBits;
    const auto format = texel == Texel::r32ui ? vk::Format::eR32Uint : vk::Format::eR32Sint;
    const vk::Extent3D extent(size[0], size[1], size[2]);
    impl_ = std::make_shared<Impl>(device, vk::DescriptorType::eStorageImage, bytes);
    impl_->size = extent;
    vk::ImageCreateInfo how({}, vk::ImageType::e3D, format, extent, 1, 1);
    how.usage = Usage::eStorage | Usage::eTransferSrc | Usage::eTransferDst;
    impl_->image = {d.device, how};
    impl_->memory = allocate(d, impl_->image, kDevice);
    impl_->view = {d.device, {{}, *impl_->image, vk::ImageViewType::e3D, format, {}, kWholeImage}};
    impl_->device.run([&](Commands& c) { c.clear(*this); });
  });
}

std::vector<uint32_t> Image3D::download() const {
  const uint64_t layer = impl_->bytes / impl_->size.depth;
  std::vector<uint32_t> texels(impl_->bytes / 4);
  copy(impl_->device, {}, std::as_writable_bytes(std::span(texels)), layer,
       [&](auto& commands, vk::Buffer staging, uint64_t at, uint64_t n) {
         vk::BufferImageCopy layers(0, 0, 0, {vk::ImageAspectFlagBits::eColor, 0, 0, 1});
         layers.imageOffset.z = static_cast<int32_t>(at / layer);
         layers.imageExtent = impl_->size;
         layers.imageExtent.depth = static_cast<uint32_t>(n / layer);
         commands.copyImageToBuffer(*impl_->image, vk::ImageLayout::eGeneral, staging, layers);
       });
  return texels;
}

void Tables::add(std::span<const std::byte> values, uint64_t bytes) {
  constexpr uint64_t kUnit = Buffer::kPartAlignment;
  tables_.push_back({values, end_, std::max(bytes, kTexel)});
  end_ += (tables_.back().bytes + kUnit - 1) / kUnit * kUnit;
}

std::vector<uint32_t> Tables::first_texels() const {
  std::vector<uint32_t> firsts;
  for (const Table& t : tables_) firsts.push_back(static_cast<uint32_t>(t.begin / kTexel));
  return firsts;
}

void Tables::upload(const Device& device) {
  buffer_ = Buffer::of_parts(device, end_);
  for (Table& t : tables_) {
    buffer_->write(t.values, t.begin);
    t.values = {};
  }
}

}  // namespace tdpt::gpu
