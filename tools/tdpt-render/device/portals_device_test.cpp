// Portals and guiding on a device match the scalar build bit for bit.
#include <gtest/gtest.h>

#include "libcommon/gpu/kernel.h"
#include "shaders/portals_test.h"
#include "shaders/portals_test_unguided.h"
#include "tools/tdpt-render/testing/scalar_portals.h"

namespace tdpt::portals_device_test {

constexpr uint32_t kGroups = 96, kInvocations = 64 * kGroups;

template <class T>
std::vector<T> not_empty(std::vector<T> values) {
  if (values.empty()) values.emplace_back();
  return values;
}

std::vector<uint32_t> device_words(const PortalTables& tables,
                                   const shader::ScalarPortals& scalar) {
  gpu::Device device = gpu::Device::open();
  const gpu::Buffer facets(device, tables.facets), polygons(device, tables.polygons),
      corners(device, tables.corners), pairs(device, not_empty(tables.pairs)),
      guiding(device, std::vector{tables.guiding}),
      words(device, 4ull * kInvocations * shader::kTrialWords);
  const gpu::Kernel kernel(
      device, scalar.guide_active ? shader::portals_test_spv : shader::portals_test_unguided_spv,
      {facets, polygons, corners, pairs, guiding, words}, sizeof(shader::TrialParameters));
  device.run([&](gpu::Commands& c) { c.dispatch(kernel, gpu::push(scalar.render), kGroups); });
  return words.download<uint32_t>(size_t{kInvocations} * shader::kTrialWords);
}

// Number of words that differ from the scalar build.
size_t differences(const shader::ScalarPortals& scalar, const std::vector<uint32_t>& theirs) {
  size_t n = 0;
  for (uint32_t i = 0; i < kInvocations; ++i) {
    const shader::PortalTrial trial = scalar.try_portals(i);
    EXPECT_EQ(trial.told, shader::kTrialWords);
    for (size_t k = 0; k < shader::kTrialWords; ++k)
      n += trial.words[k] != theirs[i * shader::kTrialWords + k];
  }
  return n;
}

TEST(portals_device, has_the_bits_of_the_scalar_build) {
  for (const bool guided : {true, false})
    for (const auto& [name, set] : portals_to_try()) {
      const PortalTables tables(set);
      shader::ScalarPortals scalar(tables);
      scalar.guide_active = guided;
      EXPECT_EQ(differences(scalar, device_words(tables, scalar)), 0u) << name << " " << guided;
    }
}
TEST(portals_device, twin_one_wrong_bit_in_a_table_is_seen) {
  PortalTables tables(portals_to_try()[1].set);
  const shader::ScalarPortals scalar(tables);
  const std::vector<uint32_t> theirs = device_words(tables, scalar);
  float& x = tables.facets[1].normal.x;
  x = std::nextafter(x, 2.0f);
  EXPECT_GT(differences(scalar, theirs), 0u);
}

}  // namespace tdpt::portals_device_test
