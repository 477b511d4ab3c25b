#include "libcommon/denoise/filter_picture.h"

#include <algorithm>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/denoise/oidn.h"
#include "libcommon/denoise/planes.h"

namespace tdpt::denoise {
namespace {

constexpr size_t kBytesOfFramesPixel = 200;  // of each frame beside it

// A frame before or after, as a neighbour; `halves` is this one, without outliers.
Neighbour neighbour_of(const NamedPicture& frame, const NoisyHalves& halves, const View& view) {
  const Buffers buffers(frame.file, frame.name);
  bool any = false;
  NoisyHalves there = buffers.halves(any);
  cut_outliers(buffers.size(), there.a, there.b);
  return reproject(there, buffers.view(), halves, view);
}

// The share of the pixels that any of them shows.
double share_present(const std::vector<Neighbour>& neighbours) {
  size_t pixels = 0;
  const size_t all = neighbours[0].present.size();
  for (size_t i = 0; i < all; ++i)
    pixels += std::any_of(neighbours.begin(), neighbours.end(),
                          [&](const Neighbour& n) { return n.present[i] > 0; });
  return static_cast<double>(pixels) / static_cast<double>(all);
}

// Three channels; empty if one is missing.
std::vector<Rgb> triples(const Buffers& buffers, size_t first) {
  std::array<Plane, 3> planes;
  for (size_t c = 0; c < 3; ++c) planes[c] = buffers.channel(kFeatureChannels[first + c]);
  std::vector<Rgb> all;
  for (size_t i = 0; i < std::min({planes[0].size(), planes[1].size(), planes[2].size()}); ++i)
    all.emplace_back(planes[0][i], planes[1][i], planes[2][i]);
  return all;
}

// What the guest makes of all samples and of the halves; nothing where it is not installed or does
// not run.
std::optional<Guest> guest_of(const Buffers& buffers, const NoisyHalves& halves,
                              std::string& name) try {
  OpenImageDenoise oidn;
  const std::vector<Rgb> albedo = triples(buffers, 0), normal = triples(buffers, 3);
  const auto filtered = [&](const Colour& noisy) {
    Picture picture{buffers.size().width, buffers.size().height, {}};
    for (size_t i = 0; i < noisy[0].size(); ++i)
      picture.pixels.emplace_back(noisy[0][i], noisy[1][i], noisy[2][i]);
    Colour planes;
    for (const Rgb& p : oidn.filter(picture, albedo, normal))
      for (size_t c = 0; c < 3; ++c) planes[c].push_back(p[static_cast<int>(c)]);
    return planes;
  };
  Guest guest{filtered(halves.a), filtered(halves.b), filtered(buffers.light())};
  name = fmt::format("{} {}", kKinds[2], oidn.version());
  return guest;
} catch (const Error&) {
  return {};
}

// Replaces the pixels of `picture`, by the halves, and returns the errors.
Plane filter_by_regression(const Buffers& buffers, Kind kind, std::span<const NamedPicture> frames,
                           Picture& picture, Filtered& filtered) {
  Input input{buffers.size(), buffers.halves(filtered.has_features)};
  filtered.denoiser = kKinds[1];
  filtered.share_a = input.halves.share_a;
  if (!frames.empty()) {
    NoisyHalves calm = input.halves;
    cut_outliers(buffers.size(), calm.a, calm.b);
    const View view = buffers.view();
    for (const NamedPicture& frame : frames)
      input.neighbours.push_back(neighbour_of(frame, calm, view));
    filtered.seen_elsewhere = share_present(input.neighbours);
  } else if (kind == Kind::automatic) {
    std::string guest;
    input.guest = guest_of(buffers, input.halves, guest);
    if (input.guest) filtered.denoiser += " + " + guest;
  }
  Result result = denoise(std::move(input));
  for (size_t i = 0; i < picture.pixels.size(); ++i)
    picture.pixels[i] = {result.picture[0][i], result.picture[1][i], result.picture[2][i]};
  filtered.outliers = result.outliers;
  filtered.left_out = result.left_out;
  filtered.left = result.left;
  return std::move(result.error);
}

void filter_by_oidn(const Buffers& buffers, Picture& picture, Filtered& filtered) {
  buffers.light();  // throws for what is none
  OpenImageDenoise oidn;
  filtered.denoiser = fmt::format("{} {}", kKinds[2], oidn.version());
  const std::vector<Rgb> albedo = triples(buffers, 0);
  filtered.has_features = !albedo.empty();
  picture.pixels = oidn.filter(picture, albedo, triples(buffers, 3));
}

}  // namespace

ExrFile parse_with_channels(std::string_view bytes, const std::string& name) {
  ExrFile file = parse_exr(bytes, name);
  if (file.attributes.contains(film_attribute))
    throw InputError(name, fmt::format("attribute {}", film_attribute),
                     "says that it is a film; exrmerge makes a picture of it, filtered if it was "
                     "rendered with --denoise");
  const auto pixels = file.picture.pixels.size();
  const std::vector<std::string> names = exr_channels(bytes, name);
  expect_memory(name, "",
                fmt::format("{} channels of {} pixels, to be filtered,", names.size(), pixels),
                (names.size() * sizeof(float) + kBytesOfPixel) * pixels);
  std::vector<WordChannel> words;
  const auto read = [&](const std::string& channel, std::vector<float>& values) {
    values.resize(pixels);
    words.push_back({channel, reinterpret_cast<unsigned char*>(values.data()), sizeof(float),
                     WordChannel::real});
  };
  for (const std::string& channel : names) {
    const size_t dot = channel.rfind('.');
    const bool in_layer =
        dot != std::string::npos && file.layers.contains(channel.substr(0, dot)) &&
        (channel.ends_with(".R") || channel.ends_with(".G") || channel.ends_with(".B"));
    const bool in_picture = channel == "R" || channel == "G" || channel == "B" ||
                            (channel == "A" && !file.picture.alpha.empty());
    if (!in_layer && !in_picture) read(channel, file.channels[channel]);
  }
  if (!words.empty()) parse_exr_words(bytes, name, file.picture.width, file.picture.height, words);
  return file;
}

Kind kind_of(const std::string& name) {
  const auto found = std::find(kKinds.begin(), kKinds.end(), name);
  return static_cast<Kind>(found == kKinds.end() ? 0 : found - kKinds.begin());
}

std::string words_of(const std::optional<ErrorLeft>& left) {
  if (!left) return "how far it is from the truth cannot be told from so few samples";
  return fmt::format("relMSE {}, {} to {}", number_words(left->relmse, 2),
                     number_words(left->low, 2), number_words(left->high, 2));
}

std::string sentence_of(const Filtered& filtered) {
  const size_t oidn = filtered.denoiser.find(kKinds[2]);
  const std::string guest =
      oidn == std::string::npos
          ? ""
          : " Open Image Denoise" +
                filtered.denoiser.substr(oidn + std::string_view(kKinds[2]).size());
  if (oidn == 0) return fmt::format("filtered by{}, no longer unbiased", guest);
  std::string words =
      fmt::format("filtered{}, no longer unbiased: {}",
                  guest.empty() ? "" : ", with the help of" + guest, words_of(filtered.left));
  if (filtered.seen_elsewhere > 0)
    words += fmt::format("; other frames show {} % of it",
                         number_words(100 * filtered.seen_elsewhere, 2));
  if (filtered.outliers > 0)
    words += fmt::format("; {} dimmed ({} % of the light is left out)",
                         counted(filtered.outliers, "outlier"),
                         number_words(100 * filtered.left_out, 2));
  return words;
}

Filtered filter_picture(ExrFile& file, const std::string& name, Kind kind,
                        std::span<const NamedPicture> frames) {
  const Buffers buffers(file, name);
  if (!frames.empty())
    expect_memory(name, "",
                  fmt::format("{}, to be filtered together,", counted(frames.size() + 1, "frame")),
                  (kBytesOfPixel + kBytesOfFramesPixel * frames.size()) * buffers.size().pixels());
  Picture noisy = buffers.noisy(), picture = noisy;
  Plane error;
  Filtered filtered;
  if (kind == Kind::oidn)
    filter_by_oidn(buffers, picture, filtered);
  else
    error = filter_by_regression(buffers, kind, frames, picture, filtered);
  file.channels.erase(kErrorChannel);
  if (!error.empty()) file.channels[kErrorChannel] = std::move(error);
  noisy.alpha.clear();
  file.layers[kNoisyLayer] = std::move(noisy);
  file.picture.pixels = std::move(picture.pixels);
  file.attributes[denoiser_attribute] = filtered.denoiser;
  return filtered;
}

ExrFile filtered_picture(const Film& film, const FilmFacts& facts, Channels channels,
                         std::optional<Filtered>& filtered) {
  const auto asks = [&](const char* word) {
    return std::find(facts.derived.begin(), facts.derived.end(), word) != facts.derived.end();
  };
  ExrFile picture = finished_picture(film, facts, std::move(channels));
  const auto word = std::find_if(kDenoised.begin(), kDenoised.end(), asks);
  const bool by_halves = word != &kDenoised.back();
  if (word == kDenoised.end() || (by_halves && !film.has_both_halves())) return picture;
  for (const uint64_t half : {0, 1})
    if (by_halves) picture.layers[kHalves[half]] = film.half(half);
  filtered = filter_picture(picture, "picture", static_cast<Kind>(word - kDenoised.begin()));
  if (!asks("halves"))
    for (const char* half : kHalves) picture.layers.erase(half);
  return picture;
}

}  // namespace tdpt::denoise
