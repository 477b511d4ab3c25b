// One Vulkan device with one compute queue; Vulkan itself stays in this folder.
//
// What a machine cannot do (no loader, driver, device or queue, too old a version, a limit too low,
// too little memory, a device that is lost) throws Error with Exit::no_device and the reason; no
// other device steps in. All of this is used by one thread at a time.
//
// TDPT_VULKAN_VALIDATION=1 in the environment turns on the Khronos validation layer, its
// synchronisation checks included. Its warnings and errors go to stderr as they come, and a process
// in which nobody took them (below) ends with exit code 1.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tdpt::gpu {

/// What a device allows.
struct Limits {
  uint64_t memory = 0;      ///< bytes, the device's own
  uint64_t buffer = 0;      ///< bytes of one buffer
  uint64_t image = 0;       ///< bytes of one 3D image
  uint32_t image_side = 0;  ///< texels along each side of a 3D image
  uint64_t texels = 0;      ///< bytes of a buffer that kernels read as texels of four words
  uint32_t buffers = 0;     ///< that a kernel may bind
  uint32_t groups = 0;      ///< work groups of a dispatch
};

struct DeviceInfo {
  std::string name;   ///< as its driver calls it
  std::string kind;   ///< discrete, integrated, virtual, cpu, other
  std::string unfit;  ///< why it cannot be used here; empty: it can
  Limits limits;      ///< of devices that can be used
};

/// Every device there is, fit or not; throws when there is none.
std::vector<DeviceInfo> list_devices();

/// The best (discrete, integrated, virtual, cpu, other) of the fit ones that `which` means: "":
/// any; digits: the one of that index; else those with it in their name, in whichever case. Throws
/// when there is none.
size_t pick_device(const std::vector<DeviceInfo>& devices, const std::string& which);

class Commands;

class Device {
 public:
  /// `which` as in pick_device.
  /// `told`: for statistics_of() (kernel.h); throws where the driver has none.
  static Device open(const std::string& which = "", bool told = false);

  const DeviceInfo& info() const;
  const Limits& limits() const { return info().limits; }

  /// Submits what `record` records (kernel.h) and waits until it is done. Each command sees what
  /// those before it wrote. Returns the seconds from the submission to its end. Keep them well
  /// below one: drivers kill what takes longer.
  double run(const std::function<void(Commands&)>& record);

  struct Impl;
  const std::shared_ptr<Impl>& impl() const { return impl_; }

 private:
  explicit Device(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<Impl> impl_;  // everything made of the device holds it too
};

/// What validation has said in this process since the last call; forgets it. Complaints about what
/// is left over come when a device's last owner goes.
std::vector<std::string> take_validation_messages();

}  // namespace tdpt::gpu
