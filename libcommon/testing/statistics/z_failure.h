// What a failed z-test leaves for inspection: the two pictures of blocks, where they differ, and
// the p-values.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>

#include "libcommon/testing/statistics/z_test.h"

namespace tdpt::testing {

/// Where failures are stored: TDPT_FAILURES in the environment, else failures/ in the build tree;
/// in it a folder named after the running test.
std::filesystem::path failures_folder();

/// Whether `agreement`, of these runs, holds. If not, the message reports it and names the folder
/// with these files:
///   WHAT.first.exr, WHAT.second.exr   means of the blocks over the runs, `across` blocks per row
///   WHAT.z.png    z of the blocks: red if the first is brighter, blue if darker, white at 0,
///                 saturated at |z| = 5; grey if the block was not tested
///   WHAT.txt      Agreement::text(), and z block by block
/// For estimators that must agree; twins call Agreement::holds(), which leaves no files.
::testing::AssertionResult holds(const Agreement& agreement, const std::string& what,
                                 const BlockRuns& first, const BlockRuns& second, size_t across);

}  // namespace tdpt::testing
