// Twin of the fuzz targets: a reader with planted faults, each of which fuzz_replay and libFuzzer
// must detect.
#include <stdexcept>

#include "libcommon/testing/files/fuzz.h"

using namespace tdpt;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text = testing::text_of(data, size);
  testing::reads([&] {
    if (text == "throws\n") throw std::runtime_error("an exception that is no InputError");
    if (text == "two lines\n") throw InputError("input", "", "one\ntwo");
    testing::require(text != "breaks\n", "this one");
    if (text == "refuses\n") throw InputError("input", "", "is refused, expected better");
  });
  return 0;
}
