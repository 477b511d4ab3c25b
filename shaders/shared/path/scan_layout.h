// Sizes and parameters of shaders/path_scan.comp.
#ifndef TDPT_SHADERS_SHARED_PATH_SCAN_LAYOUT_H
#define TDPT_SHADERS_SHARED_PATH_SCAN_LAYOUT_H

#include "shaders/shared/language.h"

#define SCAN_COUNTS 0
#define SCAN_SUMS 1
#define SCAN_TOTALS 2

#define SCAN_GROUP 64  // invocations of a work group

SHARED_BEGIN

const uint kScanEach = 16u;     // numbers per invocation
const uint kScanBlock = 1024u;  // numbers per work group

// Phases, in this order.
const uint SCAN_BLOCKS = 0u;  ///< sums within each block, and its total; one work group per block
const uint SCAN_OF_TOTALS = 1u;  ///< sums of the totals; one work group
const uint SCAN_SPREAD = 2u;     ///< adds them to their blocks; one work group per block

/// Push constants.
struct ScanParameters {
  uint count;
  uint phase;
};

SHARED uint scan_blocks(uint count) {
  return count / kScanBlock + (count % kScanBlock > 0u ? 1u : 0u);
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
