#include "libcommon/testing/statistics/z_failure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "libcommon/base/output_file.h"
#include "libcommon/formats/picture.h"
#include "libcommon/formats/png.h"

namespace tdpt::testing {
namespace {

/// Made suitable for a file name.
std::string plain(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-') c = '_';
  return name;
}

std::string exr_of(const BlockRuns& runs, size_t across) {
  ExrFile file;
  file.picture.width = static_cast<int>(across);
  file.picture.height = static_cast<int>(runs.blocks() / across);
  for (size_t b = 0; b < runs.blocks(); ++b)
    file.picture.pixels.emplace_back(static_cast<float>(runs.mean(b)));
  return exr_bytes(file);
}

std::array<uint8_t, 3> colour_of(double z) {
  if (std::isnan(z)) return {128, 128, 128};
  const auto rest = static_cast<uint8_t>(std::lround(255 * (1 - std::min(std::abs(z) / 5, 1.0))));
  return z > 0 ? std::array<uint8_t, 3>{255, rest, rest} : std::array<uint8_t, 3>{rest, rest, 255};
}

std::string z_map(const std::vector<double>& z, size_t across) {
  constexpr size_t kSide = 24;  // side of a block [pixels]
  const size_t width = across * kSide, height = z.size() / across * kSide;
  std::vector<uint8_t> rgb;
  for (size_t y = 0; y < height; ++y)
    for (size_t x = 0; x < width; ++x)
      for (uint8_t c : colour_of(z[y / kSide * across + x / kSide])) rgb.push_back(c);
  return png_of_rgb8(static_cast<int>(width), static_cast<int>(height), rgb, PngKind::drawing);
}

std::string table(const Agreement& agreement, size_t across) {
  std::string text = fmt::format("{}\n\nz of the blocks, from the top left:\n", agreement.text());
  for (size_t b = 0; b < agreement.z_of_block.size(); ++b)
    text += fmt::format("{:7.2f}{}", agreement.z_of_block[b], (b + 1) % across ? "" : "\n");
  return text;
}

}  // namespace

std::filesystem::path failures_folder() {
  const char* asked = std::getenv("TDPT_FAILURES");
  const std::filesystem::path root = asked && *asked ? asked : TDPT_FAILURES_FOLDER;
  const ::testing::TestInfo* test = ::testing::UnitTest::GetInstance()->current_test_info();
  return root / plain(test ? fmt::format("{}.{}", test->test_suite_name(), test->name()) : "none");
}

::testing::AssertionResult holds(const Agreement& agreement, const std::string& what,
                                 const BlockRuns& first, const BlockRuns& second, size_t across) {
  if (agreement.holds()) return ::testing::AssertionSuccess();
  const std::filesystem::path folder = failures_folder();
  std::filesystem::create_directories(folder);
  const std::string begin = (folder / plain(what)).string();
  write_outputs({{begin + ".first.exr", exr_of(first, across)},
                 {begin + ".second.exr", exr_of(second, across)},
                 {begin + ".z.png", z_map(agreement.z_of_block, across)},
                 {begin + ".txt", table(agreement, across)}});
  return ::testing::AssertionFailure()
         << what << ": " << agreement.text() << "\n  see " << begin << ".*\n";
}

}  // namespace tdpt::testing
