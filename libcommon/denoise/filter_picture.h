// Filters a picture file by the buffers in it: tdpt-render(1), CHANNELS BESIDE THE LIGHT.
#pragma once
#include <array>
#include <span>
#include <string>

#include "libcommon/denoise/buffers.h"

namespace tdpt::denoise {

/// Channel with about the relative error that is left.
inline constexpr const char* kErrorChannel = "error.Y";

/// Ours [denoise.h], or the guest [oidn.h].
enum class Kind { regression, oidn };
/// As --denoiser has them.
inline constexpr std::array kKinds{"regression", "oidn"};
Kind kind_of(const std::string& name);

struct Filtered {
  std::string denoiser;       ///< "regression", "oidn 2.5.1"
  size_t outliers = 0;        ///< as in Result
  double outlier_energy = 0;  ///< likewise
  double relmse = 0;          ///< likewise; 0 of `oidn`
  double seen_elsewhere = 0;  ///< share of the picture that other frames show
  bool has_features = false;  ///< whether there was any
  double share_a = 0.5;       ///< of the samples that halfA has
};
/// A frame of a moving picture.
struct NamedPicture {
  ExrFile file;
  std::string name;
};

/// One line: "filtered, no longer unbiased, relMSE about 0.0031; the light of 12 outliers (0.3 % of
/// all) was spread".
std::string sentence_of(const Filtered& filtered);

/// Reads a file with all its channels. Throws InputError, also if filtering it needs too much
/// memory [memory_limit.h].
ExrFile parse_with_channels(std::string_view bytes, const std::string& name);

/// Replaces R G B by the filtered picture, sets denoiser_attribute and keeps what was there as the
/// layer kNoisyLayer. Adds kErrorChannel (not `oidn`). Needs layers halfA and halfB, of which the
/// picture is a weighted mean (not `oidn`); uses albedo, normal and depth (not `oidn`). A picture
/// that is filtered already is filtered again from its noisy layer. `frames`: before and after this
/// one, fewer than kMostSources, of any size, to which camera and depth lead (not `oidn`). Throws
/// InputError, `name` in its place, if buffers are missing or no numbers.
Filtered filter_picture(ExrFile& file, const std::string& name, Kind kind = Kind::regression,
                        std::span<const NamedPicture> frames = {});

}  // namespace tdpt::denoise
