// Which device a program computes on, as its command line says: --device and --list-devices.
#pragma once
#include <optional>
#include <string>

#include "libcommon/cli/cli.h"
#include "libcommon/gpu/device.h"

namespace tdpt {

/// `device` is "cpu" where nothing is given. `what`: a clause, "What traces the lines".
void declare_device_options(cli::Options& options, std::string& device, const std::string& what);

/// Opens a GPU at once: that there is none is told before work begins. None: the CPU. Throws
/// UsageError for what is neither.
std::optional<gpu::Device> device_asked(const std::string& device);

/// "NAME", and that it is no GPU where that is so: drivers of the CPU step in where no other is.
std::string words_of(const gpu::DeviceInfo& device);

}  // namespace tdpt
