// One Vulkan device with one compute queue; Vulkan itself stays in this folder.
//
// Anything that a machine cannot do (no loader, driver, device or queue, a version too old, a limit
// too low, too little memory, a lost device) throws Error with Exit::no_device and the reason;
// there is no fallback to another device. Everything here must be used by one thread at a time.
//
// TDPT_VULKAN_VALIDATION=1 in the environment turns on the Khronos validation layer with
// synchronisation checks. Its first message goes to stderr and ends the process with exit code 1;
// leaks are found when a device's last owner is destroyed.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tdpt::gpu {

/// Limits of a device.
struct Limits {
  uint64_t memory = 0;      ///< bytes of device-local memory
  uint64_t buffer = 0;      ///< bytes per buffer
  uint64_t image = 0;       ///< bytes per 3D image
  uint32_t image_side = 0;  ///< texels along each side of a 3D image
  uint64_t texels = 0;      ///< bytes of a buffer read as texels of four words
  uint32_t buffers = 0;     ///< storage buffers per kernel
  uint32_t groups = 0;      ///< work groups per dispatch
};

struct DeviceInfo {
  std::string name;   ///< as reported by the driver
  std::string kind;   ///< discrete, integrated, virtual, cpu, other
  std::string unfit;  ///< why it cannot be used; empty: it can
  Limits limits;      ///< only of usable devices
};

/// Every device, usable or not; throws if there is none.
std::vector<DeviceInfo> list_devices();

/// The best (discrete, integrated, virtual, cpu, other) usable device that matches `which`: "":
/// any; digits: an index; else a case-insensitive part of the name. Throws if there is none.
size_t pick_device(const std::vector<DeviceInfo>& devices, const std::string& which);

class Commands;

class Device {
 public:
  /// `which` as in pick_device.
  static Device open(const std::string& which = "");

  const DeviceInfo& info() const;
  const Limits& limits() const { return info().limits; }

  /// Submits what `record` records (kernel.h) and waits for it. Each command sees the writes of
  /// earlier ones. Returns the seconds from submission to completion. Keep them well below one:
  /// drivers kill longer work.
  double run(const std::function<void(Commands&)>& record);

  struct Impl;
  const std::shared_ptr<Impl>& impl() const { return impl_; }

 private:
  explicit Device(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<Impl> impl_;  // shared by everything made from the device
};

}  // namespace tdpt::gpu
