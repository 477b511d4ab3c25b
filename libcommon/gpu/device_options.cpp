#include "libcommon/gpu/device_options.h"

#include <fmt/format.h>

#include "libcommon/base/error.h"

namespace tdpt {
namespace {

std::string list_of_devices() {
  std::string text;
  const std::vector<gpu::DeviceInfo> devices = gpu::list_devices();
  for (size_t i = 0; i < devices.size(); ++i) {
    const gpu::DeviceInfo& d = devices[i];
    text += fmt::format("{}  {}  ({}{})\n", i, d.name, d.kind,
                        d.unfit.empty() ? "" : "; cannot be used: " + d.unfit);
  }
  return text;
}

}  // namespace

void declare_device_options(cli::Options& options, std::string& device, const std::string& what) {
  device = "cpu";
  options.part(cli::Part::effort);
  options.option("--device", device, "cpu|gpu[:WHICH]",
                 what +
                     "; default cpu. WHICH: number or part of the name of a Vulkan device; "
                     "else the best",
                 cli::Effect::samples);
  options.part(cli::Part::telling);
  options.instead("--list-devices", list_of_devices, "List the Vulkan devices and exit");
}

std::string words_of(const gpu::DeviceInfo& device) {
  if (device.kind != "cpu") return device.name;
  return device.name + ", which is no GPU but this processor, and slower than --device cpu";
}

std::optional<gpu::Device> device_asked(const std::string& device) {
  if (device == "cpu") return {};
  if (device != "gpu" && device.rfind("gpu:", 0) != 0)
    throw UsageError("--device: '" + device + "' given, expected cpu, gpu or gpu:WHICH");
  return gpu::Device::open(device == "gpu" ? "" : device.substr(4));
}

}  // namespace tdpt
