// Writes pictures: OpenEXR and PNG.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "libcommon/formats/format_version.h"
#include "libcommon/formats/picture.h"
#include "libcommon/formats/picture_bounds.h"
#include "libcommon/formats/png.h"

namespace tdpt {
namespace {

class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : OStream("picture") {}

  void write(const char from[], int n) override {
    const auto count = static_cast<size_t>(n);
    if (place_ + count > bytes.size()) bytes.resize(place_ + count);
    std::memcpy(bytes.data() + place_, from, count);
    place_ += count;
  }
  uint64_t tellp() override { return place_; }
  void seekp(uint64_t place) override { place_ = place; }

  std::string bytes;

 private:
  uint64_t place_ = 0;
};

void check_size(const Picture& p, int width, int height) {
  const size_t n = static_cast<size_t>(width) * static_cast<size_t>(height);
  if (p.width != width || p.height != height || width < 1 || height < 1 || p.pixels.size() != n ||
      (!p.alpha.empty() && p.alpha.size() != n))
    throw std::invalid_argument("picture and layers must have one size and no fewer pixels");
}

// The channels of a file, and where their numbers are.
class ExrChannels {
 public:
  ExrChannels(int width, int height) : header(width, height), width_(static_cast<size_t>(width)) {
    header.compression() = Imf::ZIP_COMPRESSION;
  }

  // Consecutive pixels are `step` bytes apart.
  void add(const std::string& channel, Imf::PixelType type, const void* first, size_t step) {
    header.channels().insert(channel, Imf::Channel(type));
    // The library's interface lacks const; it only reads.
    buffer_.insert(channel, Imf::Slice(type, const_cast<char*>(static_cast<const char*>(first)),
                                       step, step * width_));
  }
  void add(const std::string& prefix, const Picture& p) {
    add(prefix + "R", Imf::FLOAT, &p.pixels[0].x, sizeof(Rgb));
    add(prefix + "G", Imf::FLOAT, &p.pixels[0].y, sizeof(Rgb));
    add(prefix + "B", Imf::FLOAT, &p.pixels[0].z, sizeof(Rgb));
  }
  void write(Imf::OStream& stream, int height) const {
    Imf::OutputFile output(stream, header, 0);
    output.setFrameBuffer(buffer_);
    output.writePixels(height);
  }  // the destructor writes the table of offsets

  Imf::Header header;

 private:
  size_t width_;
  Imf::FrameBuffer buffer_;
};

}  // namespace

std::string exr_bytes(const ExrFile& file) {
  const int width = file.picture.width, height = file.picture.height;
  check_size(file.picture, width, height);
  ExrChannels channels(width, height);
  Imf::Header& header = channels.header;
  header.insert(kVersionAttribute, Imf::StringAttribute(std::to_string(format_version::picture)));
  for (const auto& [name, text] : file.attributes)
    header.insert(name.c_str(), Imf::StringAttribute(text));
  channels.add("", file.picture);
  if (const std::vector<float>& alpha = file.picture.alpha; !alpha.empty())
    channels.add("A", Imf::FLOAT, alpha.data(), sizeof(float));
  for (const auto& [name, picture] : file.layers) {
    check_size(picture, width, height);
    channels.add(name + ".", picture);
  }
  for (const auto& [name, values] : file.channels) {
    if (values.size() != file.picture.pixels.size())
      throw std::invalid_argument("a channel must be as large as the picture");
    channels.add(name, Imf::FLOAT, values.data(), sizeof(float));
  }
  for (const WordChannel& word : file.words)
    channels.add(word.name, word.type == WordChannel::real ? Imf::FLOAT : Imf::UINT, word.first,
                 word.step);
  MemoryOutput stream;
  channels.write(stream, height);
  return std::move(stream.bytes);
}

std::string png_bytes(const Picture& picture) {
  check_size(picture, picture.width, picture.height);
  const auto encode = [](float value) {  // IEC 61966-2-1
    const auto v = static_cast<double>(value);
    if (!(v > 0)) return static_cast<uint8_t>(0);
    const double s =
        v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(std::min(v, 1.0), 1 / 2.4) - 0.055;
    return static_cast<uint8_t>(std::lround(255 * std::min(s, 1.0)));
  };
  std::vector<uint8_t> pixels;
  const bool covers = picture.alpha.empty();
  pixels.reserve(picture.pixels.size() * (covers ? 3 : 4));
  for (size_t i = 0; i < picture.pixels.size(); ++i) {
    const float alpha = covers ? 1 : picture.alpha[i];
    for (int c = 0; c < 3; ++c)
      pixels.push_back(alpha > 0 ? encode(picture.pixels[i][c] / alpha) : uint8_t{0});
    if (!covers)
      pixels.push_back(static_cast<uint8_t>(std::lround(255 * std::clamp(alpha, 0.0f, 1.0f))));
  }
  return png_of_rgb8(picture.width, picture.height, pixels);
}

}  // namespace tdpt
