// Behaviour with other builds of Embree: its answers are replaced (--wrap in CMakeLists.txt).
#include <optional>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/trace/embree.h"
#include "libcommon/trace/tracer.h"

namespace tdpt::wrong_embree_test {

std::optional<RTCError> no_device;

// What the Tracer of an empty scene throws.
std::string error() {
  std::string what = "nothing";
  try {
    const Tracer tracer{Scene{}};
  } catch (const Error& e) {
    what = e.what();
  }
  no_device.reset();
  return what;
}

TEST(wrong_embree, no_device_is_one_sentence) {
  EXPECT_EQ(error(), "nothing");
  no_device = RTC_ERROR_UNSUPPORTED_CPU;
  EXPECT_EQ(error(), "this processor lacks the instructions that Embree needs");
  no_device = RTC_ERROR_UNKNOWN;
  EXPECT_EQ(error(), "Embree gives no device, perhaps for want of memory or threads");
}

}  // namespace tdpt::wrong_embree_test

extern "C" {
using namespace tdpt::wrong_embree_test;
RTCDevice __real_rtcNewDevice(const char* configuration);
RTCError __real_rtcGetDeviceError(RTCDevice device);

RTCDevice __wrap_rtcNewDevice(const char* configuration) {
  return no_device ? nullptr : __real_rtcNewDevice(configuration);
}
RTCError __wrap_rtcGetDeviceError(RTCDevice device) {
  return no_device ? *no_device : __real_rtcGetDeviceError(device);
}
}
