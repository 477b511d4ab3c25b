// Filters a picture by the buffers beside it, of a file (tdpt-render(1), CHANNELS BESIDE THE LIGHT)
// or of a film.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>

#include "libcommon/denoise/buffers.h"
#include "libcommon/film/film_file.h"

namespace tdpt::denoise {

/// Channel with about the relative error that is left, if that is known.
inline constexpr const char* kErrorChannel = "error.Y";

/// Ours [denoise.h], the guest [oidn.h], or both as far as the guest is installed.
enum class Kind { automatic, regression, oidn };
/// As --denoiser has them.
inline constexpr std::array kKinds{"auto", "regression", "oidn"};
Kind kind_of(const std::string& name);
/// Memory that filtering takes at most besides the channels [bytes per pixel].
inline constexpr size_t kBytesOfPixel = 400;
/// The words of FilmFacts::derived that ask for them.
inline constexpr std::array kDenoised{"denoise", "denoise-regression", "denoise-oidn"};

struct Filtered {
  std::string denoiser;             ///< "regression", "oidn 2.5.1", "regression + oidn 2.5.1"
  size_t outliers = 0;              ///< as in Result
  double left_out = 0;              ///< likewise
  std::optional<ErrorLeft> left{};  ///< likewise; nothing of `oidn`
  double seen_elsewhere = 0;        ///< share of the picture that other frames show
  bool has_features = false;        ///< whether there was any
  double share_a = 0.5;             ///< of the samples that halfA has
};
/// A frame of a moving picture.
struct NamedPicture {
  ExrFile file;
  std::string name;
};

/// "relMSE 0.0031, 0.0016 to 0.0062", or that it cannot be told.
std::string words_of(const std::optional<ErrorLeft>& left);
/// One line: "filtered, no longer unbiased: relMSE 0.0031, 0.0016 to 0.0062; 12 outliers dimmed
/// (0.3 % of the light is left out)".
std::string sentence_of(const Filtered& filtered);

/// Reads a file with all its channels. Throws InputError, also if filtering it needs too much
/// memory [file.h].
ExrFile parse_with_channels(std::string_view bytes, const std::string& name);

/// Replaces R G B by the filtered picture, sets denoiser_attribute and keeps what was there as the
/// layer kNoisyLayer. Adds kErrorChannel (not `oidn`). Needs layers halfA and halfB, of which the
/// picture is a weighted mean (not `oidn`); uses albedo, normal and depth. A picture that is
/// filtered already is filtered again from its noisy layer. `frames`: before and after this one,
/// fewer than kMostSources, of any size, to which camera and depth lead; `regression` alone takes
/// them. Throws InputError, `name` in its place, if buffers are missing or no numbers.
Filtered filter_picture(ExrFile& file, const std::string& name, Kind kind = Kind::automatic,
                        std::span<const NamedPicture> frames = {});

/// A film's finished picture, filtered as its facts ask. Sets what the filter did; nothing if none
/// is asked for, or a half that it needs has no samples.
ExrFile filtered_picture(const Film& film, const FilmFacts& facts, Channels channels,
                         std::optional<Filtered>& filtered);

}  // namespace tdpt::denoise
