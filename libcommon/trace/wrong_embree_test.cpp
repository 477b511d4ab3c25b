// Behaviour with other builds of Embree: its answers are replaced (--wrap in CMakeLists.txt).
#include <optional>
#include <utility>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/trace/embree.h"
#include "libcommon/trace/tracer.h"

namespace tdpt::wrong_embree_test {

std::optional<RTCError> no_device;
std::optional<std::pair<RTCDeviceProperty, ssize_t>> property;

// What the Tracer of an empty scene throws.
std::string error() {
  std::string what = "nothing";
  try {
    const Tracer tracer{Scene{}};
  } catch (const Error& e) {
    what = e.what();
  }
  no_device.reset();
  property.reset();
  return what;
}

TEST(wrong_embree, no_device_is_one_sentence) {
  EXPECT_EQ(error(), "nothing");
  no_device = RTC_ERROR_UNSUPPORTED_CPU;
  EXPECT_EQ(error(), "this processor lacks the instructions that Embree needs");
  no_device = RTC_ERROR_UNKNOWN;
  EXPECT_EQ(error(), "Embree gives no device, perhaps for want of memory or threads");
}

TEST(wrong_embree, one_that_cannot_do_what_is_asked_is_refused) {
  property = {RTC_DEVICE_PROPERTY_BACKFACE_CULLING_ENABLED, 1};
  EXPECT_EQ(error(), "this Embree was built with back-face culling; another is needed");
  property = {RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED, 0};
  EXPECT_EQ(error(), "this Embree was built without filter functions; another is needed");
  property = {RTC_DEVICE_PROPERTY_TRIANGLE_GEOMETRY_SUPPORTED, 0};
  EXPECT_EQ(error(), "this Embree was built without triangles; another is needed");
  EXPECT_EQ(error(), "nothing");
}

}  // namespace tdpt::wrong_embree_test

extern "C" {
using namespace tdpt::wrong_embree_test;
RTCDevice __real_rtcNewDevice(const char* configuration);
RTCError __real_rtcGetDeviceError(RTCDevice device);
ssize_t __real_rtcGetDeviceProperty(RTCDevice device, RTCDeviceProperty which);

RTCDevice __wrap_rtcNewDevice(const char* configuration) {
  return no_device ? nullptr : __real_rtcNewDevice(configuration);
}
RTCError __wrap_rtcGetDeviceError(RTCDevice device) {
  return no_device ? *no_device : __real_rtcGetDeviceError(device);
}
ssize_t __wrap_rtcGetDeviceProperty(RTCDevice device, RTCDeviceProperty which) {
  return property && property->first == which ? property->second
                                              : __real_rtcGetDeviceProperty(device, which);
}
}
