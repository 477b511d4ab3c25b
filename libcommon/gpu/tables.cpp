#include "libcommon/gpu/tables.h"

#include <algorithm>

namespace tdpt::gpu {

namespace {

constexpr uint64_t kTexel = 16;

}  // namespace

void Tables::add(std::span<const std::byte> values, uint64_t bytes) {
  constexpr uint64_t kUnit = Part::kPartAlignment;
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
