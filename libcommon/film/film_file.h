// A film on disk: an OpenEXR picture of the samples so far, which any viewer shows, with the exact
// sums and everything that must match before they are added to another film. Checkpoints and shards
// are such files. Format: film(5).
#pragma once
#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "libcommon/base/provenance.h"
#include "libcommon/film/film.h"

namespace tdpt {

/// Films with different shapes belong to different pictures.
using Shape = Fingerprint;

/// "samples 0 to 15 and 32 to 47", "no samples".
std::string words_of(const std::vector<SampleRange>& ranges);

/// The union of two lists of words "b, a", in alphabetical order: "a, b".
std::string merged_words(const std::string& a, const std::string& b);

/// Integers that add up as samples do, by name.
using Counts = std::map<std::string, std::vector<Units>>;

/// Used in place of a processor's code for any Vulkan device.
inline constexpr const char* kGpuCode = "gpu";
/// Explains why films rendered by these [FilmFacts::processor] differ from those of one machine.
std::string mixed_code_sentence(const std::string& processors);

/// Metadata of a film file.
struct FilmFacts {
  Shape shape;
  std::string plan;   ///< decisions made by measuring, as JSON: the same in all parts
  std::string state;  ///< progress of the rendering, as JSON; "": not resumable
  /// Instruction set in use [process.h], or kGpuCode; if mixed "avx2, avx512".
  std::string processor;
  uint64_t spp = 0;  ///< samples per pixel of the whole picture; 0: limited by time
  Counts counts;
  /// What is made of the sums at the end: channels of kDerived, and words that others understand
  /// [filter_picture.h].
  std::vector<std::string> derived;
  std::map<std::string, std::string> attributes;  ///< of the finished picture, except `spp`
  friend bool operator==(const FilmFacts&, const FilmFacts&) = default;
};

/// More of a rendering's state than its facts hold, as its program understands it.
using StateWords = std::vector<uint32_t>;

/// "variance": of the mean luminance, "halves": kHalves, both of a film that keeps halves;
/// "samples": number per pixel.
inline constexpr std::array kDerived{"variance", "halves", "samples"};

struct FilmFile {
  Film film;
  FilmFacts facts;
  StateWords words{};
  Channels channels{};  ///< of the finished picture, independent of samples

  /// Ranges of [0, spp) that are missing.
  std::vector<SampleRange> gaps() const;
  /// Adds another part of the same picture; its state is then dropped. The result does not
  /// depend on the order of parts. Throws InputError naming `name` for a part of another picture or
  /// plan, and for samples that are present already.
  void merge(const FilmFile& other, const std::string& name);
};

/// The file as bytes. No thread may add to the film meanwhile.
std::string film_bytes(Film& film, const FilmFacts& facts, const StateWords& words = {},
                       const Channels& channels = {});
/// Throws InputError if it is no film or has been changed.
FilmFile parse_film(std::string_view bytes, const std::string& name);
FilmFile read_film(const std::string& path);
/// Name of the attribute that tells which frame of a shot a picture is, and that it is complete.
inline constexpr const char* kFrameAttribute = "frame";

/// Name of the attribute of a film file that tells its samples, and of how many: "samples 0 to 15
/// of 64". So a file's header tells which part it is.
inline constexpr const char* kPartAttribute = "part";
std::string part_words(const std::vector<SampleRange>& ranges, uint64_t of);

/// Whether a picture has the attribute that marks films.
bool is_film(const ExrFile& file);

/// The finished picture, identical to that of a rendering that was not split.
ExrFile finished_picture(const Film& film, const FilmFacts& facts, Channels channels = {});

}  // namespace tdpt
