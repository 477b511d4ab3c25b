#include "libcommon/formats/picture.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/primaries.h"

namespace tdpt {
namespace {

constexpr std::string_view kMagic = "#?";
using Rgbe = std::array<uint8_t, 4>;

// One shared exponent: mantissa * 2^(e - 136), black for e = 0.
Rgb colour_of(const Rgbe& p) {
  if (p[3] == 0) return {};
  const float f = std::ldexp(1.0f, p[3] - 136);
  return {f * static_cast<float>(p[0]), f * static_cast<float>(p[1]), f * static_cast<float>(p[2])};
}

class HdrReader {
 public:
  HdrReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Picture picture(int most_width, int most_height) {
    header();
    Picture p;
    resolution(p, most_width, most_height);
    // No row takes less; so a truncated file fails before its picture is allocated.
    if (bytes_.size() - at_ >= size_t{4} * static_cast<size_t>(p.height))
      p.pixels.reserve(static_cast<size_t>(p.width) * static_cast<size_t>(p.height));
    std::vector<Rgbe> row(static_cast<size_t>(p.width));
    for (int y = 0; y < p.height; ++y) {
      row_ = y;
      scan_line(row);
      for (const Rgbe& texel : row) {
        const Rgb colour = colour_of(texel) * scale_;
        p.pixels.push_back(to_rec709_ ? within_gamut(Rgb(to_rec709_->vector(Vec3d(colour))))
                                      : colour);
      }
    }
    if (at_ < bytes_.size())
      fail("", fmt::format("{} after the last of {} x {} pixels",
                           counted(bytes_.size() - at_, "byte"), p.width, p.height));
    return p;
  }

 private:
  [[noreturn]] void fail(const std::string& place, const std::string& words) const {
    throw InputError(name_, place, words);
  }
  [[noreturn]] void fail_row(const std::string& words) const {
    fail(fmt::format("row {}", row_), words);
  }

  std::string_view line(const char* what) {
    const size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos)
      fail("header", fmt::format("ends before {}, expected text lines", what));
    const std::string_view text = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    return text;
  }

  // Lines up to the first blank one.
  void header() {
    line("its first line");
    for (std::string_view text; !(text = line("an empty line")).empty();) {
      if (text.starts_with("FORMAT=") && text != "FORMAT=32-bit_rle_rgbe")
        fail("header", fmt::format("\"{}\", expected FORMAT=32-bit_rle_rgbe", shown(text, 60)));
      if (text.starts_with("EXPOSURE=")) divide_by<1>(text.substr(9));
      if (text.starts_with("COLORCORR=")) divide_by<3>(text.substr(10));
      if (text.starts_with("PRIMARIES=")) primaries(text.substr(10));
    }
  }

  // Numbers at the beginning of a text, separated by blanks; false if there are too few.
  template <class T>
  static bool read_numbers(std::string_view text, T* to, int count) {
    const char* at = text.data();
    const char* const end = at + text.size();
    for (int i = 0; i < count; ++i) {
      while (at < end && *at == ' ') ++at;
      const auto [next, error] = std::from_chars(at, end, to[i]);
      if (error != std::errc() || !std::isfinite(to[i])) return false;
      at = next;
    }
    return true;
  }

  // White stays white, as in Radiance: the picture is balanced for its own. Photoshop writes zeros.
  void primaries(std::string_view numbers) {
    Primaries p{};
    try {
      if (!read_numbers(numbers, p.data(), 8)) throw std::invalid_argument("no eight numbers");
      if (p != Primaries{}) to_rec709_ = to_rec709(p);
    } catch (const std::invalid_argument& e) {
      fail("header", fmt::format("\"{}\" as primaries: {}", shown(numbers, 90), e.what()));
    }
    if (!to_rec709_) return;
    const Vec3d white = to_rec709_->x + to_rec709_->y + to_rec709_->z;
    for (Vec3d* column : {&to_rec709_->x, &to_rec709_->y, &to_rec709_->z})
      *column = {column->x / white.x, column->y / white.y, column->z / white.z};
  }

  template <int n>
  void divide_by(std::string_view numbers) {
    std::array<float, n> values{};
    if (!read_numbers(numbers, values.data(), n) ||
        !std::all_of(values.begin(), values.end(), [](float v) { return v > 0; }))
      fail("header", fmt::format("\"{}\" as exposure, expected {} above 0", shown(numbers, 60),
                                 n == 1 ? "a number" : "three numbers"));
    for (int c = 0; c < 3; ++c) scale_[c] /= values[n == 1 ? 0 : static_cast<size_t>(c)];
  }

  void resolution(Picture& p, int most_width, int most_height) {
    const std::string text(line("the size of the picture"));
    int64_t height = 0, width = 0;
    int used = 0;
    if (text.size() > 60 ||
        std::sscanf(text.c_str(), "-Y %ld +X %ld%n", &height, &width, &used) != 2 ||
        static_cast<size_t>(used) != text.size())
      fail("header", fmt::format("\"{}\", expected \"-Y HEIGHT +X WIDTH\"", shown(text, 60)));
    if (width < 1 || height < 1 || width > most_width || height > most_height)
      fail("header", fmt::format("{} x {} pixels, expected at most {} x {}", width, height,
                                 most_width, most_height));
    expect_memory(name_, "header", fmt::format("{} x {} pixels", width, height),
                  sizeof(Rgb) * static_cast<size_t>(width) * static_cast<size_t>(height));
    p.width = static_cast<int>(width);
    p.height = static_cast<int>(height);
  }

  uint8_t byte() {
    if (at_ == bytes_.size()) fail_row("the file ends");
    return static_cast<uint8_t>(bytes_[at_++]);
  }
  Rgbe texel() {
    Rgbe p{};
    for (uint8_t& b : p) b = byte();
    return p;
  }

  void scan_line(std::vector<Rgbe>& row) {
    const Rgbe first = texel();
    const size_t width = row.size();
    const bool planes =
        width >= 8 && width <= 0x7fff && first[0] == 2 && first[1] == 2 && first[2] < 128;
    if (!planes) return pixels(row, first);
    const size_t declared = static_cast<size_t>(first[2]) << 8 | first[3];
    if (declared != width)
      fail_row(fmt::format("declares {} pixels, the header {}", declared, width));
    for (size_t c = 0; c < 4; ++c) plane(row, c);
  }

  // One component of all pixels in a row: runs (128 + length, value) and literals (length, values).
  void plane(std::vector<Rgbe>& row, size_t c) {
    for (size_t x = 0; x < row.size();) {
      const uint8_t code = byte();
      const size_t length = code > 128 ? code - 128u : code;
      if (length == 0 || length > row.size() - x) fail_row("a run that does not fit the row");
      const uint8_t value = code > 128 ? byte() : uint8_t{0};
      for (size_t k = 0; k < length; ++k) row[x++][c] = code > 128 ? value : byte();
    }
  }

  // Whole pixels; (1, 1, 1, n) repeats the previous one n times, the i-th in succession n << 8 i
  // times.
  void pixels(std::vector<Rgbe>& row, Rgbe p) {
    int shift = 0;
    for (size_t x = 0;;) {
      if (p[0] == 1 && p[1] == 1 && p[2] == 1) {
        const size_t length = shift > 16 ? 0 : static_cast<size_t>(p[3]) << shift;
        if (x == 0 || shift > 16 || length > row.size() - x)
          fail_row("a run that does not fit the row");
        for (size_t k = 0; k < length; ++k, ++x) row[x] = row[x - 1];
        shift += 8;
      } else {
        row[x++] = p;
        shift = 0;
      }
      if (x == row.size()) return;
      p = texel();
    }
  }

  std::string_view bytes_;
  const std::string& name_;
  size_t at_ = 0;
  int row_ = 0;
  Rgb scale_{1.0f};
  std::optional<Affine> to_rec709_;  // nothing: the colours are that
};

}  // namespace

bool is_radiance_hdr(std::string_view bytes) {
  return bytes.starts_with(kMagic);
}

Picture parse_radiance_hdr(std::string_view bytes, const std::string& name, int most_width,
                           int most_height) {
  return HdrReader(bytes, name).picture(most_width, most_height);
}

}  // namespace tdpt
