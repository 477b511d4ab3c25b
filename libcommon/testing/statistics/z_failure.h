// What a failed z-test leaves to be looked at: the two pictures of blocks, where they differ, and
// how likely that is by chance.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>

#include "libcommon/testing/statistics/z_test.h"

namespace tdpt::testing {

/// Where failures go: the environment's TDPT_FAILURES, else failures/ in the build tree; in it a
/// folder of the running test's name.
std::filesystem::path failures_folder();

/// Whether `agreement`, of these runs, holds. If not, the message tells it and names the folder
/// where these were left:
///   WHAT.first.exr, WHAT.second.exr   means of the blocks over the runs, `across` blocks a row
///   WHAT.z.png    z of the blocks: red where the first is brighter, blue where it is darker, full
///   at
///                 |z| = 5, white at 0; grey where the block was not asked
///   WHAT.txt      Agreement::text(), and z block by block
/// For what must agree; a twin that must not asks Agreement::holds(), which leaves nothing.
::testing::AssertionResult holds(const Agreement& agreement, const std::string& what,
                                 const BlockRuns& first, const BlockRuns& second, size_t across);

}  // namespace tdpt::testing
