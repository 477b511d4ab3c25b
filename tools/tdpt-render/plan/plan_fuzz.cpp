// Reads any bytes as a plan; an accepted plan must survive writing and reading again.
#include "libcommon/testing/files/fuzz.h"
#include "tools/tdpt-render/plan/plan.h"

using namespace tdpt;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Plan a;
  if (testing::reads([&] { a = read_plan(std::string(testing::text_of(data, size)), "input"); }))
    testing::require(read_plan(plan_text(a), "output") == a, "a plan comes back");
  return 0;
}
