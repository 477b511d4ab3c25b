#include "libcommon/formats/picture.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <stdexcept>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/format_version.h"
#include "libcommon/formats/picture_bounds.h"
#include "libcommon/formats/png.h"
#include "libcommon/formats/primaries.h"

namespace tdpt {
namespace {

class MemoryInput : public Imf::IStream {
 public:
  MemoryInput(std::string_view bytes, const std::string& name)
      : IStream(name.c_str()), bytes_(bytes) {}

  bool read(char to[], int n) override {
    if (n < 0 || place_ > bytes_.size() || static_cast<uint64_t>(n) > bytes_.size() - place_)
      throw std::runtime_error("the file ends too early");
    std::memcpy(to, bytes_.data() + place_, static_cast<size_t>(n));
    place_ += static_cast<uint64_t>(n);
    return place_ < bytes_.size();
  }
  uint64_t tellg() override { return place_; }
  void seekg(uint64_t place) override { place_ = place; }

 private:
  std::string_view bytes_;
  uint64_t place_ = 0;
};

// Prefixes X for which X + "R", X + "G" and X + "B" are channels: "" and "<layer>.".
std::vector<std::string> colour_prefixes(const Imf::ChannelList& channels) {
  std::vector<std::string> prefixes;
  for (auto c = channels.begin(); c != channels.end(); ++c) {
    const std::string name = c.name();
    const std::string prefix = name.substr(0, name.size() - 1);
    if (name.empty() || name.back() != 'R' || (!prefix.empty() && prefix.back() != '.')) continue;
    if (prefix == ".") continue;
    if (channels.findChannel(prefix + "G") && channels.findChannel(prefix + "B"))
      prefixes.push_back(prefix);
  }
  return prefixes;
}

std::string channel_names(const Imf::ChannelList& channels) {
  std::string names;
  int n = 0;
  for (auto c = channels.begin(); c != channels.end(); ++c, ++n)
    if (n < 8) names += fmt::format("{}{}", n ? " " : "", shown(c.name()));
  if (n > 8) names += " ...";
  return n ? names : "none";
}

// Refuses subsampled channels.
void check_channels(const Imf::Header& header, const std::vector<std::string>& prefixes,
                    const std::string& name) {
  for (const std::string& prefix : prefixes)
    for (const char* c : {"R", "G", "B"}) {
      const Imf::Channel& channel = header.channels()[prefix + c];
      if (channel.xSampling != 1 || channel.ySampling != 1)
        throw InputError(name, "channel " + tdpt::shown(prefix) + c,
                         "has fewer samples than pixels, expected one a pixel");
    }
}

// From the file's colours to Rec.709; nothing if they are that.
std::optional<Affine> map_to_rec709(const Imf::Header& header, const std::string& name) {
  const auto* a = header.findTypedAttribute<Imf::ChromaticitiesAttribute>("chromaticities");
  if (!a) return {};
  const Imf::Chromaticities& c = a->value();
  Primaries p{};
  size_t i = 0;
  for (const Imath::V2f& v : {c.red, c.green, c.blue, c.white})
    for (const float x : {v.x, v.y}) p[i++] = static_cast<double>(x);
  try {
    return tdpt::to_rec709(p);
  } catch (const std::invalid_argument& e) {
    throw InputError(name, "chromaticities",
                     fmt::format("{:.4g}: {}", fmt::join(p, " "), e.what()));
  }
}

// Data window, display window and their intersection.
struct Windows {
  Imath::Box2i data, shown, both;
  size_t width, height;  // of the display window
  size_t columns;        // of both

  Windows(const Imf::Header& header, const std::string& name)
      : data(header.dataWindow()),
        shown(header.displayWindow()),
        both({std::max(data.min.x, shown.min.x), std::max(data.min.y, shown.min.y)},
             {std::min(data.max.x, shown.max.x), std::min(data.max.y, shown.max.y)}),
        width(static_cast<size_t>(exr::extent(shown).x)),
        height(static_cast<size_t>(exr::extent(shown).y)),
        columns(static_cast<size_t>(both.max.x - both.min.x + 1)) {
    if (both.isEmpty())
      throw InputError(name, "data window", "lies outside the display window, expected an overlap");
  }
};

// Appends the rows that are in both windows, padded to the display window's width, to each picture.
// pictures: one per prefix. alpha: of channel A; null: there is none.
void read_rows(Imf::InputPart& part, const Windows& w, const std::vector<std::string>& prefixes,
               const std::vector<Picture*>& pictures, std::vector<float>* alpha) {
  const auto data_width = static_cast<size_t>(exr::extent(w.data).x);
  const auto from = static_cast<size_t>(w.both.min.x - w.data.min.x);
  const auto to = static_cast<size_t>(w.both.min.x - w.shown.min.x);
  std::vector<std::vector<Rgb>> blocks(prefixes.size());
  std::vector<float> block_of_alpha;
  const int rows_in_block = exr::rows_at_once(part.header(), prefixes.size());
  for (int y = w.both.min.y; y <= w.both.max.y; y += rows_in_block) {
    const int last = std::min(w.both.max.y, y + rows_in_block - 1);
    const auto rows = static_cast<size_t>(last - y + 1);
    const Imath::Box2i window({w.data.min.x, y}, {w.data.max.x, last});
    Imf::FrameBuffer buffer;
    for (size_t k = 0; k < prefixes.size(); ++k) {
      blocks[k].assign(rows * data_width, Rgb{});
      const char* const channel[3] = {"R", "G", "B"};
      float* const first[3] = {&blocks[k][0].x, &blocks[k][0].y, &blocks[k][0].z};
      for (int c = 0; c < 3; ++c)
        buffer.insert(
            prefixes[k] + channel[c],
            Imf::Slice::Make(Imf::FLOAT, first[c], window, sizeof(Rgb), sizeof(Rgb) * data_width));
    }
    if (alpha) {
      block_of_alpha.assign(rows * data_width, 0);
      buffer.insert("A", Imf::Slice::Make(Imf::FLOAT, block_of_alpha.data(), window));
    }
    part.setFrameBuffer(buffer);
    part.readPixels(y, last);
    const auto append = [&](auto& pixels, const auto& block) {
      for (size_t row = 0; row < rows; ++row) {
        pixels.resize(pixels.size() + to);
        const auto* source = block.data() + row * data_width + from;
        pixels.insert(pixels.end(), source, source + w.columns);
        pixels.resize(pixels.size() + (w.width - to - w.columns));
      }
    };
    for (size_t k = 0; k < prefixes.size(); ++k) append(pictures[k]->pixels, blocks[k]);
    if (alpha) append(*alpha, block_of_alpha);
  }
}

ExrFile read_part(Imf::MultiPartInputFile& file, int index,
                  const std::vector<std::string>& prefixes, std::string_view bytes,
                  const std::string& name) {
  const Imf::Header& header = file.header(index);
  exr::check_size(header, prefixes.size(), bytes, name);
  check_channels(header, prefixes, name);
  exr::check_chunks(file, index, bytes, name);
  const Windows w(header, name);
  ExrFile result;
  std::vector<Picture*> pictures;
  for (const std::string& prefix : prefixes) {
    Picture& p =
        prefix.empty() ? result.picture : result.layers[prefix.substr(0, prefix.size() - 1)];
    p.width = static_cast<int>(w.width);
    p.height = static_cast<int>(w.height);
    p.pixels.resize(w.width * static_cast<size_t>(w.both.min.y - w.shown.min.y));
    pictures.push_back(&p);
  }
  const Imf::Channel* const covers = header.channels().findChannel("A");
  std::vector<float>* const alpha =
      covers && covers->type != Imf::UINT && covers->xSampling == 1 && covers->ySampling == 1
          ? &result.picture.alpha
          : nullptr;
  if (alpha) alpha->resize(result.picture.pixels.size());
  const std::optional<Affine> to = map_to_rec709(header, name);
  Imf::InputPart part(file, index);
  read_rows(part, w, prefixes, pictures, alpha);
  for (Picture* p : pictures) {
    p->pixels.resize(w.width * w.height);
    if (!to) continue;
    for (Rgb& pixel : p->pixels) pixel = Rgb(to->vector(Vec3d(pixel)));
  }
  if (alpha) alpha->resize(w.width * w.height);
  const auto covered = w.columns * static_cast<size_t>(w.both.max.y - w.both.min.y + 1);
  result.pixels_without_data = static_cast<int64_t>(w.width * w.height - covered);
  for (auto a = header.begin(); a != header.end(); ++a) {
    const std::string key = a.name();
    if (key == "type" || key == "name" || key == kVersionAttribute) continue;  // not of the picture
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
      result.attributes[key] = text->value();
  }
  return result;
}

// Refuses what the library must not see, and names what OpenEXR has gained since: that is no
// damage.
void check_headers(std::string_view bytes, const std::string& name) {
  constexpr int version = 2, flags = 0x1e;  // tiles, long names, deep pixels, parts
  constexpr std::array later{"HTJ2K256", "HTJ2K32", "LJ2K", "ZSTD"};  // after DWAB
  const auto byte = [&](size_t i) { return static_cast<unsigned char>(bytes[i]); };
  const char magic[4] = {0x76, 0x2f, 0x31, 0x01};
  if (bytes.size() < 4 || std::memcmp(bytes.data(), magic, 4) != 0)
    throw InputError(name, "", "is not an OpenEXR file");
  if (bytes.size() >= 8 && byte(4) != version)
    throw InputError(name, "version", fmt::format("{}, expected {}", byte(4), version));
  if (bytes.size() >= 8 && ((byte(5) & ~flags) != 0 || byte(6) != 0 || byte(7) != 0))
    throw InputError(name, "version", "has flags of features that this program does not know");
  const exr::Headers headers = exr::headers_of(bytes);
  if (!headers.fault.empty()) throw InputError(name, "", "is damaged: " + headers.fault);
  for (const char c : headers.compressions) {
    const int compression = static_cast<unsigned char>(c),
              more = compression - Imf::DWAB_COMPRESSION;
    if (more > 0)
      throw InputError(
          name, "compression",
          fmt::format("{}, which this program does not support, expected none, RLE, ZIPS, ZIP, "
                      "PIZ, PXR24, B44, B44A, DWAA or DWAB",
                      more <= static_cast<int>(later.size())
                          ? later[static_cast<size_t>(more - 1)]
                          : fmt::format("number {}", compression)));
  }
}

// Opens a file and passes the first part that has R, G and B to `read`.
template <class Read>
auto parse(std::string_view bytes, const std::string& name, const Read& read) {
  check_headers(bytes, name);
  try {
    Imf::Header::setMaxImageSize(exr::largest_side, exr::largest_side);
    MemoryInput stream(bytes, name);
    Imf::MultiPartInputFile file(stream, 0, false);
    for (int part = 0; part < file.parts(); ++part) {
      const std::vector<std::string> prefixes = colour_prefixes(file.header(part).channels());
      if (std::find(prefixes.begin(), prefixes.end(), "") == prefixes.end()) continue;
      const Imf::Header& header = file.header(part);
      if (header.hasType() && Imf::isDeepData(header.type()))
        throw InputError(name, "type", "deep pixels, expected one sample of R, G and B a pixel");
      if (const auto* version = header.findTypedAttribute<Imf::StringAttribute>(kVersionAttribute))
        check_version(name, kVersionAttribute, version->value(), format_version::picture);
      return read(file, part);
    }
    throw InputError(name, "channels",
                     fmt::format("{}, expected R, G and B",
                                 file.parts() ? channel_names(file.header(0).channels()) : "none"));
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw InputError(name, "", "asks for more memory than there is");
  } catch (const std::exception& e) {  // all errors of the library
    throw InputError(name, "", "is damaged: " + shown(e.what(), 300));
  }
}

Imf::PixelType pixel_type(const WordChannel& channel) {
  return channel.type == WordChannel::real ? Imf::FLOAT : Imf::UINT;
}

// Half floats are read as floats.
bool can_be_read_as(const WordChannel& word, const Imf::Channel& channel) {
  return (channel.type == Imf::UINT) == (word.type == WordChannel::whole) &&
         channel.xSampling == 1 && channel.ySampling == 1;
}

}  // namespace

Provenance provenance_of(const ExrFile& file) {
  Provenance p;
  const auto found = file.attributes.find(provenance_attribute);
  if (found == file.attributes.end()) return p;
  const std::string& text = found->second;
  for (size_t start = 0; start < text.size();) {
    const size_t end = std::min(text.find('\n', start), text.size());
    if (end > start) p.lines.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return p;
}

void set_provenance(ExrFile& file, const Provenance& provenance) {
  file.attributes.erase(provenance_attribute);
  if (provenance.empty()) return;
  file.attributes[provenance_attribute] = fmt::format("{}", fmt::join(provenance.lines, "\n"));
}

ExrFile read_exr(const std::string& path) {
  return parse_exr(read_file(path), display_name(path));
}

ExrFile parse_exr(std::string_view bytes, const std::string& name) {
  return parse(bytes, name, [&](Imf::MultiPartInputFile& file, int part) {
    return read_part(file, part, colour_prefixes(file.header(part).channels()), bytes, name);
  });
}

Picture parse_exr_picture(std::string_view bytes, const std::string& name, int most_width,
                          int most_height) {
  ExrFile file = parse(bytes, name, [&](Imf::MultiPartInputFile& input, int part) {
    const auto size = exr::extent(input.header(part).displayWindow());
    if (size.x > most_width || size.y > most_height)
      throw InputError(name, "header",
                       fmt::format("{} x {} pixels, expected at most {} x {}", size.x, size.y,
                                   most_width, most_height));
    ExrFile read = read_part(input, part, {""}, bytes, name);
    if (map_to_rec709(input.header(part), name))
      for (Rgb& pixel : read.picture.pixels) pixel = within_gamut(pixel);
    return read;
  });
  if (file.pixels_without_data > 0)
    throw InputError(name, "data window",
                     fmt::format("holds {} pixels less than the display window, expected all",
                                 file.pixels_without_data));
  return std::move(file.picture);
}

std::vector<std::string> exr_channels(std::string_view bytes, const std::string& name) {
  return parse(bytes, name, [&](Imf::MultiPartInputFile& file, int index) {
    std::vector<std::string> names;
    const Imf::ChannelList& channels = file.header(index).channels();
    for (auto c = channels.begin(); c != channels.end(); ++c) names.emplace_back(c.name());
    return names;
  });
}

void parse_exr_words(std::string_view bytes, const std::string& name, int width, int height,
                     const std::vector<WordChannel>& words) {
  parse(bytes, name, [&](Imf::MultiPartInputFile& file, int index) {
    const Imf::Header& header = file.header(index);
    exr::check_size(header, 0, bytes, name);
    const Imath::Box2i& window = header.dataWindow();
    const auto size = exr::extent(window);
    if (size.x != width || size.y != height || window != header.displayWindow())
      throw InputError(name, "data window",
                       fmt::format("is {} x {} pixels, expected {} x {} and no other display "
                                   "window",
                                   size.x, size.y, width, height));
    Imf::FrameBuffer buffer;
    for (const WordChannel& word : words) {
      const Imf::Channel* channel = header.channels().findChannel(word.name);
      if (!channel || !can_be_read_as(word, *channel))
        throw InputError(name, "channel " + word.name,
                         channel ? "is of another type" : "is missing");
      buffer.insert(word.name, Imf::Slice::Make(pixel_type(word), word.first, window, word.step,
                                                word.step * static_cast<size_t>(width)));
    }
    exr::check_chunks(file, index, bytes, name);
    Imf::InputPart part(file, index);
    part.setFrameBuffer(buffer);
    part.readPixels(window.min.y, window.max.y);
  });
}

}  // namespace tdpt
