#include <algorithm>
#include <cstring>

#include "libcommon/gpu/device_impl.h"

namespace tdpt::gpu {
namespace {

using Memory = vk::MemoryPropertyFlagBits;
constexpr vk::MemoryPropertyFlags kHost = Memory::eHostVisible | Memory::eHostCoherent;

}  // namespace

vk::raii::DeviceMemory Device::Impl::allocate(
    const vk::MemoryRequirements& need,
    std::initializer_list<vk::MemoryPropertyFlags> wishes) const {
  require_within(info, info.limits.allocation, "bytes in a piece of memory", need.size);
  const vk::PhysicalDeviceMemoryProperties types = physical.getMemoryProperties();
  for (const vk::MemoryPropertyFlags wish : wishes)
    for (uint32_t i = 0; i < types.memoryTypeCount; ++i)
      if ((need.memoryTypeBits >> i & 1) && (types.memoryTypes[i].propertyFlags & wish) == wish)
        return {device, vk::MemoryAllocateInfo(need.size, i)};
  throw Error(Exit::no_device, info.name + " has no memory of the kind that is needed");
}

Block Device::Impl::make_block(uint64_t bytes, vk::BufferUsageFlags usage, bool mapped) const {
  Block b;
  b.bytes = bytes;
  b.buffer = {device, vk::BufferCreateInfo({}, bytes, usage)};
  const vk::MemoryRequirements need = b.buffer.getMemoryRequirements();
  b.memory = mapped ? allocate(need, {kHost | Memory::eHostCached, kHost})
                    : allocate(need, {Memory::eDeviceLocal, {}});
  b.buffer.bindMemory(*b.memory, 0);
  if (mapped) b.mapped = static_cast<std::byte*>(b.memory.mapMemory(0, VK_WHOLE_SIZE));
  return b;
}

const Block& Device::Impl::staging() {
  using Usage = vk::BufferUsageFlagBits;
  if (staging_block.bytes != piece)
    staging_block = make_block(piece, Usage::eTransferSrc | Usage::eTransferDst, true);
  return staging_block;
}

Buffer::Buffer(const Device& device, uint64_t bytes) {
  const DeviceInfo& info = device.info();
  require_within(info, info.limits.buffer, "bytes in a buffer", bytes);
  impl_ = calling_vulkan(fmt::format("no buffer of {} bytes on {}", bytes, info.name), [&] {
    using Usage = vk::BufferUsageFlagBits;
    const vk::BufferUsageFlags usage =
        Usage::eStorageBuffer | Usage::eIndirectBuffer | Usage::eTransferSrc | Usage::eTransferDst;
    const Device::Impl& d = *device.impl();
    const uint64_t rounded = std::max<uint64_t>(4, (bytes + 3) / 4 * 4);
    return std::make_shared<Impl>(Impl{device.impl(), d.make_block(rounded, usage, d.host_sees)});
  });
}

uint64_t Buffer::bytes() const {
  return impl_->block.bytes;
}

namespace {
// Calls move(at, n) for the bytes at .. at + n - 1 of a transfer, piece by piece.
template <class Move>
void in_pieces(const Buffer::Impl& b, uint64_t offset, uint64_t size, Move move) {
  b.device->require_idle();
  if (offset > b.block.bytes || size > b.block.bytes - offset)
    throw Error(Exit::internal, fmt::format("bytes {} to {} of a buffer of {}", offset,
                                            offset + size, b.block.bytes));
  const uint64_t piece = b.block.mapped ? std::max<uint64_t>(size, 1) : b.device->piece;
  calling_vulkan("cannot copy on " + b.device->info.name, [&] {
    for (uint64_t at = 0; at < size; at += piece) move(at, std::min(piece, size - at));
  });
}
}  // namespace

void Buffer::write(uint64_t offset, std::span<const std::byte> from) {
  Device::Impl& d = *impl_->device;
  in_pieces(*impl_, offset, from.size(), [&](uint64_t at, uint64_t n) {
    const Block& to = impl_->block;
    std::memcpy(to.mapped ? to.mapped + offset : d.staging().mapped, &from[at], n);
    if (!to.mapped)
      d.run([&] {
        d.commands.copyBuffer(*d.staging().buffer, *to.buffer, vk::BufferCopy(0, offset + at, n));
      });
  });
}

void Buffer::read(uint64_t offset, std::span<std::byte> to) const {
  Device::Impl& d = *impl_->device;
  in_pieces(*impl_, offset, to.size(), [&](uint64_t at, uint64_t n) {
    const Block& from = impl_->block;
    if (!from.mapped)
      d.run([&] {
        d.commands.copyBuffer(*from.buffer, *d.staging().buffer, vk::BufferCopy(offset + at, 0, n));
        d.barrier();
      });
    std::memcpy(&to[at], from.mapped ? from.mapped + offset : d.staging().mapped, n);
  });
}

Image3D::Image3D(const Device& device, const std::array<uint32_t, 3>& size, Texel texel) {
  const DeviceInfo& info = device.info();
  const Limits& limits = info.limits;
  for (uint32_t side : size) {
    require_within(info, limits.image_side, "texels along a side of a 3D image", side);
    if (side == 0) throw Error(Exit::internal, "a 3D image has a side of 0 texels");
  }
  const uint64_t bytes = uint64_t{4} * size[0] * size[1] * size[2];
  require_within(info, limits.image, "bytes in a 3D image", bytes);
  const std::string what =
      fmt::format("no 3D image of {} x {} x {} texels on {}", size[0], size[1], size[2], info.name);
  calling_vulkan(what, [&] {
    Device::Impl& d = *device.impl();
    impl_ = std::make_shared<Impl>(Impl{device.impl(), size});
    using Usage = vk::ImageUsageFlagBits;
    const auto format = texel == Texel::r32ui ? vk::Format::eR32Uint : vk::Format::eR32Sint;
    impl_->image = {
        d.device, vk::ImageCreateInfo({}, vk::ImageType::e3D, format, {size[0], size[1], size[2]},
                                      1, 1, vk::SampleCountFlagBits::e1, vk::ImageTiling::eOptimal,
                                      Usage::eStorage | Usage::eTransferSrc | Usage::eTransferDst)};
    impl_->memory = d.allocate(impl_->image.getMemoryRequirements(), {Memory::eDeviceLocal, {}});
    impl_->image.bindMemory(*impl_->memory, 0);
    impl_->view = {d.device, vk::ImageViewCreateInfo({}, *impl_->image, vk::ImageViewType::e3D,
                                                     format, {}, kWholeImage)};
    d.run([&] {
      vk::ImageMemoryBarrier to_general({}, vk::AccessFlagBits::eTransferWrite);
      to_general.setNewLayout(vk::ImageLayout::eGeneral).setImage(*impl_->image);
      to_general.setSubresourceRange(kWholeImage);
      d.commands.pipelineBarrier(vk::PipelineStageFlagBits::eTopOfPipe,
                                 vk::PipelineStageFlagBits::eTransfer, {}, {}, {}, to_general);
      d.commands.clearColorImage(*impl_->image, vk::ImageLayout::eGeneral, vk::ClearColorValue(),
                                 kWholeImage);
    });
  });
}

const std::array<uint32_t, 3>& Image3D::size() const {
  return impl_->size;
}

std::vector<uint32_t> Image3D::download() const {
  Device::Impl& d = *impl_->device;
  const auto [nx, ny, nz] = impl_->size;
  std::vector<uint32_t> texels(size_t{nx} * ny * nz);
  d.require_idle();
  return calling_vulkan("cannot copy an image on " + d.info.name, [&, nx = nx, ny = ny, nz = nz] {
    const uint64_t most = std::max<uint64_t>(1, d.piece / (4 * uint64_t{nx}));  // rows in a piece
    for (uint64_t row = 0; row < uint64_t{ny} * nz;) {
      const auto y = static_cast<uint32_t>(row % ny), z = static_cast<uint32_t>(row / ny);
      // Whole layers, or rows of one.
      const auto layers = static_cast<uint32_t>(std::clamp<uint64_t>(most / ny, 1, nz - z));
      const auto rows = static_cast<uint32_t>(std::min<uint64_t>(most, ny - y));
      const vk::BufferImageCopy region(0, 0, 0, {vk::ImageAspectFlagBits::eColor, 0, 0, 1},
                                       {0, static_cast<int32_t>(y), static_cast<int32_t>(z)},
                                       {nx, rows, layers});
      d.run([&] {
        d.commands.copyImageToBuffer(*impl_->image, vk::ImageLayout::eGeneral, *d.staging().buffer,
                                     region);
        d.barrier();
      });
      std::memcpy(&texels[row * nx], d.staging().mapped, size_t{4} * nx * rows * layers);
      row += uint64_t{rows} * layers;
    }
    return texels;
  });
}

}  // namespace tdpt::gpu
