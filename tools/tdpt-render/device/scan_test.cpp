// Prefix sums on a device match the standard library's.
#include <gtest/gtest.h>

#include <numeric>

#include "libcommon/gpu/kernel.h"
#include "libcommon/math/rng.h"
#include "shaders/path_scan.h"
#include "shaders/shared/path/scan_layout.h"

namespace tdpt::scan_test {

struct Sums {
  std::vector<uint32_t> before;
  uint32_t all;
};
// `in_place`: the sums replace the counts.
Sums device_sums(gpu::Device& device, const std::vector<uint32_t>& counts, bool in_place = false) {
  const auto n = static_cast<uint32_t>(counts.size());
  const uint32_t blocks = shader::scan_blocks(n);
  std::vector<uint32_t> padded = counts;
  padded.push_back(~0u);  // must not be read
  const gpu::Buffer input(device, padded), sums(device, padded),
      totals(device, 4ull * (blocks + 1));
  const gpu::Kernel kernel(device, shader::path_scan_spv, {in_place ? sums : input, sums, totals},
                           sizeof(shader::ScanParameters));
  const auto phase = [&](gpu::Commands& c, uint32_t which, uint32_t groups) {
    if (groups > 0) c.dispatch(kernel, gpu::push(shader::ScanParameters{n, which}), groups);
  };
  device.run([&](gpu::Commands& c) {
    phase(c, shader::SCAN_BLOCKS, blocks);
    phase(c, shader::SCAN_OF_TOTALS, 1);
    phase(c, shader::SCAN_SPREAD, blocks);
  });
  Sums result{sums.download<uint32_t>(n + 1), totals.download<uint32_t>(blocks + 1).back()};
  EXPECT_EQ(result.before.back(), ~0u);  // nor written
  result.before.pop_back();
  return result;
}

std::vector<uint32_t> counts(uint32_t n, uint32_t most) {
  std::vector<uint32_t> all(n);
  for (uint32_t i = 0; i < n; ++i) all[i] = static_cast<uint32_t>(mix64(i) % (most + 1ull));
  return all;
}
void expect_sums(const std::vector<uint32_t>& counts, const Sums& sums) {
  std::vector<uint32_t> before(counts.size());
  std::exclusive_scan(counts.begin(), counts.end(), before.begin(), 0u);
  EXPECT_EQ(sums.before, before) << counts.size();
  EXPECT_EQ(sums.all, std::accumulate(counts.begin(), counts.end(), 0u)) << counts.size();
}

TEST(scan, is_that_of_the_standard_library) {
  gpu::Device device = gpu::Device::open();
  for (const uint32_t n : {0u, 1u, 63u, 64u, 65u, 1023u, 1024u, 1025u, 65536u, 65537u, 1000001u})
    for (const uint32_t most : {1u, 5u, ~0u}) {  // sums may wrap round as words do
      const std::vector<uint32_t> all = counts(n, most);
      expect_sums(all, device_sums(device, all, most == 5));
    }
}

}  // namespace tdpt::scan_test
