// Exclusive prefix sums of counts: sums[i] = counts[0] + ... + counts[i-1], modulo 2^32; the total
// is stored behind the totals of the blocks. Sums may overwrite counts. Kernels take the places of
// their results from these sums: no atomics are needed, and the order is always the same.
//
// Method: sums within blocks, then over the blocks' totals, then both added (Blelloch 1990); three
// phases.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/shared/path/scan_layout.h"

layout(local_size_x = SCAN_GROUP) in;

layout(std430, binding = SCAN_COUNTS) readonly buffer Counts { uint counts[]; };
layout(std430, binding = SCAN_SUMS) buffer Sums { uint sums[]; };
// One for each block, then the total of all.
layout(std430, binding = SCAN_TOTALS) buffer Totals { uint totals[]; };
layout(push_constant) uniform Parameters { ScanParameters scan; };

shared uint up_to[SCAN_GROUP];

// Sum over the invocations before this one; `all`: over the whole work group.
uint sum_before(uint own, out uint all) {
  uint i = gl_LocalInvocationIndex;
  up_to[i] = own;
  barrier();
  for (uint apart = 1u; apart < SCAN_GROUP; apart *= 2u) {
    uint before = i >= apart ? up_to[i - apart] : 0u;
    barrier();
    up_to[i] += before;
    barrier();
  }
  all = up_to[SCAN_GROUP - 1u];
  uint sum = up_to[i] - own;
  barrier();  // before up_to is written again
  return sum;
}

void scan_a_block() {
  uint first = gl_WorkGroupID.x * kScanBlock + gl_LocalInvocationIndex * kScanEach;
  uint end = min(first + kScanEach, scan.count);
  uint own = 0u;
  for (uint i = first; i < end; ++i) own += counts[i];
  uint all;
  uint sum = sum_before(own, all);
  for (uint i = first; i < end; ++i) {
    uint count = counts[i];
    sums[i] = sum;
    sum += count;
  }
  if (gl_LocalInvocationIndex == 0u) totals[gl_WorkGroupID.x] = all;
}

void scan_totals() {
  uint blocks = scan_blocks(scan.count);
  uint before = 0u;
  for (uint first = 0u; first < blocks; first += SCAN_GROUP) {
    uint i = first + gl_LocalInvocationIndex;
    uint own = i < blocks ? totals[i] : 0u;
    uint all;
    uint sum = before + sum_before(own, all);
    if (i < blocks) totals[i] = sum;
    before += all;
  }
  if (gl_LocalInvocationIndex == 0u) totals[blocks] = before;
}

void spread_totals() {
  uint before = totals[gl_WorkGroupID.x];
  uint first = gl_WorkGroupID.x * kScanBlock + gl_LocalInvocationIndex;
  uint end = min((gl_WorkGroupID.x + 1u) * kScanBlock, scan.count);
  for (uint i = first; i < end; i += SCAN_GROUP) sums[i] += before;
}

void main() {
  if (scan.phase == SCAN_BLOCKS)
    scan_a_block();
  else if (scan.phase == SCAN_OF_TOTALS)
    scan_totals();
  else
    spread_totals();
}
