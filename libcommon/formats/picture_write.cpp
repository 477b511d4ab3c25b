// Writes pictures: OpenEXR and PNG.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <stdexcept>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <half.h>

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

Imf::Compression compression_of(const Storage& storage) {
  switch (storage.compression) {
    case Storage::dwaa:
      return Imf::DWAA_COMPRESSION;
    case Storage::dwab:
      return Imf::DWAB_COMPRESSION;
    case Storage::zip:
      break;
  }
  return Imf::ZIP_COMPRESSION;
}

// "R", "noisy.B", "A": by the last letter of the name.
bool is_colour(const std::string& channel) {
  const std::string last = channel.substr(channel.rfind('.') + 1);
  return last == "R" || last == "G" || last == "B" || last == "A";
}

// Channels of one part of a file, and where their numbers are.
class Part {
 public:
  Part(int width, int height, Imf::Compression compression)
      : header(width, height), width_(static_cast<size_t>(width)), height_(height) {
    header.compression() = compression;
  }

  // Consecutive pixels are `step` bytes apart.
  void add(const std::string& channel, Imf::PixelType type, const void* first, size_t step) {
    header.channels().insert(channel, Imf::Channel(type));
    // The library's interface lacks const; it only reads.
    buffer_.insert(channel, Imf::Slice(type, const_cast<char*>(static_cast<const char*>(first)),
                                       step, step * width_));
  }
  void add_as_half(const std::string& channel, const float* first, size_t step, float largest) {
    std::vector<Imath::half>& halves = halves_.emplace_back();
    halves.reserve(width_ * static_cast<size_t>(height_));
    for (size_t i = 0; i < halves.capacity(); ++i) {
      float value;
      std::memcpy(&value, reinterpret_cast<const char*>(first) + i * step, sizeof value);
      halves.emplace_back(std::clamp(value, -largest, largest));
    }
    add(channel, Imf::HALF, halves.data(), sizeof(Imath::half));
  }
  bool empty() const { return header.channels().begin() == header.channels().end(); }

  template <class Output>
  void write(Output& output) const {
    output.setFrameBuffer(buffer_);
    output.writePixels(height_);
  }

  Imf::Header header;

 private:
  size_t width_;
  int height_;
  Imf::FrameBuffer buffer_;
  std::deque<std::vector<Imath::half>> halves_;
};

// The parts of a file: of colours, and of all else that DWA must not blur.
struct Parts {
  Part colours, data;
  Storage storage;

  Parts(int width, int height, const Storage& s)
      : colours(width, height, compression_of(s)),
        data(width, height, Imf::ZIP_COMPRESSION),
        storage(s) {}

  Part& of_data() { return storage.compression == Storage::zip ? colours : data; }
  void add(const std::string& channel, const float* first, size_t step) {
    if (!is_colour(channel))
      of_data().add(channel, Imf::FLOAT, first, step);
    else if (storage.rounds())
      colours.add_as_half(channel, first, step, storage.largest());
    else
      colours.add(channel, Imf::FLOAT, first, step);
  }
  void add(const std::string& prefix, const Picture& p) {
    add(prefix + "R", &p.pixels[0].x, sizeof(Rgb));
    add(prefix + "G", &p.pixels[0].y, sizeof(Rgb));
    add(prefix + "B", &p.pixels[0].z, sizeof(Rgb));
  }
  void add(const WordChannel& word) {
    of_data().add(word.name, word.type == WordChannel::real ? Imf::FLOAT : Imf::UINT, word.first,
                  word.step);
  }
};

void write_one(Imf::OStream& stream, const Part& part) {
  Imf::OutputFile output(stream, part.header, 0);
  part.write(output);
}  // the destructor writes the table of offsets

void write_both(Imf::OStream& stream, Parts& parts) {
  parts.colours.header.setName("colours");
  parts.data.header.setName("data");
  for (Part* part : {&parts.colours, &parts.data}) part->header.setType(Imf::SCANLINEIMAGE);
  const Imf::Header headers[]{parts.colours.header, parts.data.header};
  Imf::MultiPartOutputFile output(stream, headers, 2, false, 0);
  Imf::OutputPart colours(output, 0), data(output, 1);
  parts.colours.write(colours);
  parts.data.write(data);
}

}  // namespace

std::string exr_bytes(const ExrFile& file, const Storage& storage) {
  const int width = file.picture.width, height = file.picture.height;
  check_size(file.picture, width, height);
  Parts parts(width, height, storage);
  Imf::Header& header = parts.colours.header;
  header.insert(kVersionAttribute, Imf::StringAttribute(std::to_string(format_version::picture)));
  for (const auto& [name, text] : file.attributes)
    header.insert(name.c_str(), Imf::StringAttribute(text));
  parts.add("", file.picture);
  if (const std::vector<float>& alpha = file.picture.alpha; !alpha.empty())
    parts.add("A", alpha.data(), sizeof(float));
  for (const auto& [name, picture] : file.layers) {
    check_size(picture, width, height);
    parts.add(name + ".", picture);
  }
  for (const auto& [name, values] : file.channels) {
    if (values.size() != file.picture.pixels.size())
      throw std::invalid_argument("a channel must be as large as the picture");
    parts.add(name, values.data(), sizeof(float));
  }
  for (const WordChannel& word : file.words) parts.add(word);
  MemoryOutput stream;
  if (parts.data.empty())
    write_one(stream, parts.colours);
  else
    write_both(stream, parts);
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
