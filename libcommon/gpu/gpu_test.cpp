// Runs on lavapipe with validation (tdpt_software_vulkan in CMakeLists.txt), whose messages end the
// test.
#include <gtest/gtest.h>

#include <cstdlib>

#include "libcommon/gpu/device_impl.h"
#include "libcommon/gpu/kernel.h"
#include "libcommon/testing/files/temp_folder.h"
#include "shaders/gpu_test.h"
#include "shaders/inexact_kernel_test.h"
#include "shaders/special_kernel_test.h"

namespace tdpt::gpu::gpu_test {

struct TestPush {
  uint32_t n, step;
  float scale;
};

/// The message of the Error that `f` throws; its exit code must be `code`.
template <class F>
std::string error_of(F f, Exit code = Exit::no_device) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(e.code, code) << e.what();
    return e.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

/// Sets an environment variable during its lifetime.
class WithVariable {
 public:
  WithVariable(const char* name, const char* value) : name_(name) {
    const char* before = getenv(name);
    if (before) before_ = before;
    had_ = before != nullptr;
    setenv(name, value, 1);
  }
  ~WithVariable() {
    if (had_) setenv(name_, before_.c_str(), 1);
    if (!had_) unsetenv(name_);
  }

 private:
  const char* name_;
  std::string before_;
  bool had_;
};

class Gpu : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* on = getenv("TDPT_VULKAN_VALIDATION");
    ASSERT_TRUE(on && std::string(on) == "1") << "run it with ctest, or set what ctest sets";
    device = std::make_unique<Device>(Device::open());
  }
  const Device::Impl& vulkan() const { return *device->impl(); }
  /// `ask` is refused with both numbers.
  void refused(uint64_t limit, const std::string& what, uint64_t asked,
               const std::function<void()>& ask) const {
    const std::string said = error_of(ask), numbers = fmt::format("{} {}; {}", limit, what, asked);
    EXPECT_NE(said.find(numbers), std::string::npos) << said << ", expected " << numbers;
  }

  std::unique_ptr<Device> device;
};

std::vector<uint32_t> squares(uint32_t n) {
  std::vector<uint32_t> v(n);
  for (uint32_t i = 0; i < n; ++i) v[i] = i * i;
  return v;
}

TEST_F(Gpu, BuffersGiveBackWhatTheyWereGiven) {
  device->impl()->piece = 1000;
  const std::vector<uint32_t> values = squares(12345);
  Buffer buffer(*device, values);
  EXPECT_EQ(buffer.download<uint32_t>(values.size()), values);
  buffer.write(std::as_bytes(std::span<const uint8_t>({1, 2, 3, 4, 5})));
  EXPECT_EQ(buffer.download<uint32_t>(3), (std::vector<uint32_t>{0x04030201, 5, 4}));
  EXPECT_TRUE(buffer.download<uint32_t>(0).empty());
}

TEST_F(Gpu, BytesOutsideOfABufferAreRefused) {
  Buffer buffer(*device, 6);
  EXPECT_EQ(buffer.download<uint8_t>(6).size(), 6u);
  error_of([&] { buffer.download<uint32_t>(2); }, Exit::internal);
  error_of([&] { buffer.write(std::vector<std::byte>(7)); }, Exit::internal);
  error_of([&] { Buffer(*device, 0).download<uint8_t>(1); }, Exit::internal);
}

TEST_F(Gpu, KernelsAreMadeForTheirConstants) {
  const Buffer buffer(*device, std::vector<uint32_t>{0, 0});
  for (const std::vector<uint32_t>& constants : {std::vector<uint32_t>{}, {1, 70}, {0, 70}, {1}}) {
    const Kernel kernel(*device, shader::special_kernel_test_spv, {buffer}, 0, constants);
    device->run([&](Commands& c) { c.dispatch(kernel, {}, 1); });
    const uint32_t number = constants.size() > 1 ? constants[1] : 7;
    const bool adds = !constants.empty() && constants[0] != 0;
    EXPECT_EQ(buffer.download<uint32_t>(1)[0], adds ? number + 1 : number);
  }
}

TEST_F(Gpu, ViewsOfBuffersAreHeldToTheirLimits) {
  const Limits l = device->limits();
  EXPECT_LE(l.texels, uint64_t{16} * vulkan().limits.maxTexelBufferElements);
  EXPECT_LE(l.texels / 4, uint64_t{1} << 32);
  const uint64_t beyond = (l.texels / 256 + 1) * 256;
  Tables tables;
  tables.add_room(l.texels + 1);
  refused(l.texels, "bytes in a buffer of texels", beyond, [&] { tables.upload(*device); });
  const Buffer buffer(*device, 1000);
  error_of([&] { buffer.part(768, 233); }, Exit::internal);
  ASSERT_LT(l.buffer, l.texels) << "no part is too large here";
  const Buffer large = Buffer::of_parts(*device, l.buffer + 1);
  refused(l.buffer, "bytes in a buffer", l.buffer + 1, [&] { large.part(0, l.buffer + 1); });
}

TEST_F(Gpu, PiecesOfAnImageAreOneLayerOrMore) {
  const uint32_t n = 300 * 4 * 3;  // layers of 4800 bytes
  const Buffer words(*device, 4 * (n + 1));
  for (uint64_t piece : {1, 4800, 5000, 10000, 100000}) {
    device->impl()->piece = piece;
    const Image3D image(*device, {300, 4, 3});
    const Kernel kernel(*device, shader::gpu_test_spv, {image, words}, sizeof(TestPush));
    std::vector<uint32_t> expected(n);
    device->run([&](Commands& c) {
      for (uint32_t k : {1u, 2u, 1199u, 1200u, 1201u, 3000u, n}) {
        c.dispatch(kernel, push(TestPush{k, k, 0}), (n + 63) / 64);
        for (uint32_t i = 0; i < k; ++i) expected[i] += k;
      }
    });
    EXPECT_EQ(image.download(), expected) << piece;
  }
}

TEST_F(Gpu, CommandsSeeWhatTheOnesBeforeThemWrote) {
  const Image3D image(*device, {4, 1, 1});
  Buffer words(*device, std::vector<uint32_t>(300));
  const Buffer groups(*device, std::vector<uint32_t>{9, 9, 0, 1, 1});
  const Kernel kernel(*device, shader::gpu_test_spv, {image, words}, sizeof(TestPush));
  const TestPush one{1, 2, 4}, many{1000, 2, 1}, others{65, 2, 1};
  device->run([&](Commands& c) {
    c.dispatch(kernel, push(one), 1);
    c.clear(image);
    c.dispatch(kernel, push(one), 1);
    c.dispatch(kernel, push(one), 1);
    c.dispatch(kernel, push(one), 0);                          // nothing
    c.dispatch_indirect(kernel, push(many), groups, 0);        // nothing: 9 x 9 x 0
    c.dispatch_indirect(kernel, push(others), groups, 4 * 2);  // nothing: 0 x 1 x 1
  });
  EXPECT_EQ(words.download<uint32_t>(3), (std::vector<uint32_t>{6, 0, 0}));
  EXPECT_EQ(image.download(), (std::vector<uint32_t>{4, 0, 0, 0}));

  // A kernel writes the work groups of the next dispatch: words[0] = 2, words[1..2] = 1.
  words.write(std::as_bytes(std::span<const uint32_t>({0, 1, 1})));
  device->run([&](Commands& c) {
    c.dispatch(kernel, push(TestPush{2, 1, 1}), 1);
    c.dispatch_indirect(kernel, push(TestPush{200, 1, 1}), words);
    c.clear(image);
  });
  EXPECT_EQ(words.download<uint32_t>(1)[0], 2u + 128u);
  EXPECT_EQ(image.download(), std::vector<uint32_t>(4));
}

TEST_F(Gpu, RunsWithinARunAreDoneFirst) {
  const Image3D image(*device, {1, 1, 1});
  const Buffer words(*device, 8);
  const Kernel kernel(*device, shader::gpu_test_spv, {image, words}, sizeof(TestPush));
  const TestPush p{1, 2, 1};
  device->run([&](Commands& c) {
    c.dispatch(kernel, push(p), 1);
    EXPECT_EQ(image.download(), std::vector<uint32_t>{0});
  });
  EXPECT_EQ(image.download(), std::vector<uint32_t>{2});
}

TEST_F(Gpu, WhatIsAboveALimitIsRefusedWithBothNumbers) {
  const Limits l = device->limits();
  for (uint64_t bytes : {l.buffer + 1, UINT64_MAX})
    refused(l.buffer, "bytes in a buffer", bytes, [&] { Buffer(*device, bytes); });
  const uint32_t side = l.image_side;
  refused(side, "texels along a side of a 3D image", side + 1, [&] {
    Image3D(*device, {1, side + 1, 1});
  });
  refused(l.image, "bytes in a 3D image", uint64_t{4} * side * side * side, [&] {
    Image3D(*device, {side, side, side});
  });
  const auto most = vulkan().limits;
  const Buffer buffer(*device, 16);
  const Image3D image(*device, {1, 1, 1});
  EXPECT_EQ(storage_buffers_in(shader::gpu_test_spv), 1u);
  device->impl()->limits.maxPerStageDescriptorStorageBuffers = 0;
  refused(0, "buffers in a kernel", 1, [&] {
    Kernel(*device, shader::gpu_test_spv, {image, buffer}, sizeof(TestPush));
  });
  device->impl()->limits.maxPerStageDescriptorStorageBuffers = 1;
  // Bindings that a program does not name are not bound.
  const Kernel k(*device, shader::inexact_kernel_test_spv, {buffer, buffer, buffer});
  const uint32_t groups = most.maxComputeWorkGroupCount[0];
  refused(groups, "work groups in a dispatch", uint64_t{groups} + 1,
          [&] { device->run([&](Commands& c) { c.dispatch(k, {}, groups + 1); }); });
  device->run([&](Commands& c) { c.dispatch(k, {}, groups); });
}

TEST_F(Gpu, AFailureNamesTheCallAndItsResult) {
  const std::vector<const char*> extensions = {"VK_NONE_none"};
  const std::string said = error_of([&] {
    calling_vulkan("no second device", [&] {
      const float priority = 1;
      const vk::DeviceQueueCreateInfo queues({}, 0, 1, &priority);
      vk::raii::Device(vulkan().physical, vk::DeviceCreateInfo({}, queues, {}, extensions));
    });
  });
  EXPECT_TRUE(said.starts_with("no second device: ")) << said;
  EXPECT_TRUE(said.ends_with("reateDevice: ErrorExtensionNotPresent")) << said;
}

TEST_F(Gpu, WhatIsMadeOfADeviceKeepsItAlive) {
  Buffer buffer(*device, std::vector<uint32_t>{1, 2});
  device.reset();
  EXPECT_EQ(buffer.download<uint32_t>(2), (std::vector<uint32_t>{1, 2}));
}

TEST_F(Gpu, DevicesAreOpenedByIndexAndByName) {
  const std::vector<DeviceInfo> all = list_devices();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].kind, "cpu");
  EXPECT_EQ(all[0].unfit, "");
  EXPECT_GE(all[0].limits.image_side, 256u);
  EXPECT_EQ(Device::open("0").info().name, all[0].name);
  EXPECT_EQ(Device::open("LLVMpipe").info().name, all[0].name);
  EXPECT_NE(error_of([] { Device::open("geforce"); }).find("there are: 0: " + all[0].name),
            std::string::npos);
  error_of([] { Device::open("1"); });
  error_of([] { Device::open("00"); });
}

DeviceInfo named(const std::string& name, const std::string& kind, const std::string& unfit = "") {
  return {name, kind, unfit, {}};
}

TEST(PickDevice, TakesTheBestOrTheOneThatIsMeant) {
  const std::vector<DeviceInfo> all = {named("pipe", "cpu"), named("Radeon old", "discrete", "old"),
                                       named("Iris", "integrated"), named("Radeon new", "discrete"),
                                       named("Radeon 2", "discrete")};
  EXPECT_EQ(pick_device(all, ""), 3u);
  EXPECT_EQ(pick_device({all[0], all[2]}, ""), 1u);
  EXPECT_EQ(pick_device({all[0], named("v", "virtual")}, ""), 1u);
  EXPECT_EQ(pick_device({named("x", "other"), all[0]}, ""), 1u);
  EXPECT_EQ(pick_device(all, "0"), 0u);
  EXPECT_EQ(pick_device(all, "2"), 2u);
  EXPECT_EQ(pick_device(all, "rAdEoN N"), 3u);
  EXPECT_EQ(pick_device(all, "r"), 3u);  // the best of all except pipe
  const std::string unfit = error_of([&] { pick_device({all[0], all[1]}, "1"); });
  EXPECT_NE(unfit.find("'1' can be used; there are: 0: pipe (cpu), 1: Radeon old (old)"),
            std::string::npos);
  error_of([&] { pick_device({all[1]}, ""); });
  error_of([&] { pick_device(all, "5"); });
  error_of([&] { pick_device(all, "99999999999999999999"); });
}

TEST(NoDevice, WithoutADriverThereIsNoDevice) {
  const WithVariable old_loader("VK_ICD_FILENAMES", "/nonexistent"),
      new_loader("VK_DRIVER_FILES", "/nonexistent");
  for (const std::string& said :
       {error_of([] { list_devices(); }), error_of([] { Device::open(); })})
    EXPECT_NE(said.find("no Vulkan driver"), std::string::npos) << said;
}

TEST(NoDevice, WithoutALoaderThereIsNoDevice) {
  if (getenv("TDPT_TEST_WITHOUT_LOADER")) {  // this process must find no loader
    EXPECT_NE(error_of([] { list_devices(); }).find("no Vulkan loader"), std::string::npos);
    return;
  }
  const testing::TempFolder folder;
  folder.write("libvulkan.so", "no library");
  folder.write("libvulkan.so.1", "no library");
  const std::string self = std::filesystem::read_symlink("/proc/self/exe");
  const std::string again = "'" + self + "' --gtest_filter=NoDevice.WithoutALoader*";
  const WithVariable that("TDPT_TEST_WITHOUT_LOADER", "1");
  EXPECT_NE(std::system(again.c_str()), 0);  // it finds one
  const WithVariable path("LD_LIBRARY_PATH", folder.path.c_str());
  EXPECT_EQ(std::system(again.c_str()), 0);
}

TEST(NoDevice, ValidationThatIsAskedForIsNeeded) {
  const WithVariable paths("VK_LAYER_PATH", "/nonexistent");
  EXPECT_NE(error_of([] { Device::open(); }).find("layer is not installed"), std::string::npos);
  const WithVariable off("TDPT_VULKAN_VALIDATION", "0");
  Device::open();
}

// Twins: validation finds planted errors, and ends the process.

class MisuseDeathTest : public Gpu {
 protected:
  MisuseDeathTest() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }  // drivers have threads
  void expect_message(const std::function<void()>& misuse, const char* part) {
    EXPECT_EXIT(misuse(), ::testing::ExitedWithCode(1), part);
  }
};

TEST_F(MisuseDeathTest, AMissingBarrierAfterAKernelIsTold) {
  expect_message(
      [&] {
        Buffer buffer(*device, 64);
        const Kernel kernel(*device, shader::inexact_kernel_test_spv, {buffer});
        device->run([&](Commands& c) {
          c.dispatch(kernel, {}, 1);
          c.impl().vulkan.dispatch(1, 1, 1);
          c.impl().vulkan.fillBuffer(*buffer.impl().buffer, 0, 64, 2);
        });
      },
      "SYNC-HAZARD-WRITE-AFTER-WRITE");
}

TEST_F(MisuseDeathTest, ALeakIsTold) {
  expect_message(
      [&] {
        vulkan().device.createFence({}).release();
        device.reset();
      },
      "VkFence");
}

}  // namespace tdpt::gpu::gpu_test
