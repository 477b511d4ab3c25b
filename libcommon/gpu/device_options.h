// The options that select a program's compute device: --device and --list-devices.
#pragma once
#include <optional>
#include <string>

#include "libcommon/cli/cli.h"
#include "libcommon/gpu/device.h"

namespace tdpt {

/// `device` defaults to "cpu". `what`: a clause for --help, "What traces the lines".
void declare_device_options(cli::Options& options, std::string& device, const std::string& what);

/// Opens a GPU at once, so that a missing one is reported before work begins. Empty: the CPU.
/// Throws UsageError for anything else.
std::optional<gpu::Device> device_asked(const std::string& device);

/// "NAME", with a remark if it is not a GPU: software drivers step in if there is no other.
std::string words_of(const gpu::DeviceInfo& device);

}  // namespace tdpt
