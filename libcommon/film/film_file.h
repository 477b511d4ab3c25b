// A film on disk: an OpenEXR picture of the samples that there are, which any viewer shows, with
// the exact sums beside it and all that must agree before they are added to another film's.
// Checkpoints and shards are such files. film(5) tells the format.
#pragma once
#include <array>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libcommon/film/film.h"

namespace tdpt {

/// What shapes a picture beside its samples: names ("scene") with values ("1f3a..."). Films that
/// differ in one are of different pictures.
using Shape = std::vector<std::pair<std::string, std::string>>;

/// "another scene (1f3a, expected 77ab)", of the first that differs; "" where none does.
std::string difference(const Shape& found, const Shape& expected);

/// "samples 0 to 15 and 32 to 47", "no samples".
std::string words_of(const std::vector<SampleRange>& ranges);

/// The words of two lists "b, a", each once, by the alphabet: "a, b".
std::string merged_words(const std::string& a, const std::string& b);

/// Whole numbers that add up as samples do, by name.
using Counts = std::map<std::string, std::vector<Units>>;

/// In the place of a processor: a Vulkan device, whichever.
inline constexpr const char* kGpuCode = "gpu";
/// Why films rendered by these [FilmFacts::processor] differ from those of one machine.
std::string mixed_code_sentence(const std::string& processors);

/// What a film file says beside its sums.
struct FilmFacts {
  Shape shape;
  std::string plan;   ///< what was decided by measuring, as JSON: the same in all of its parts
  std::string state;  ///< how far the rendering is, as JSON; "": it does not go on
  /// Whose code was chosen [processor.h], or kGpuCode; of several "avx2, avx512".
  std::string processor;
  uint64_t spp = 0;  ///< samples of each pixel of the whole picture; 0: as many as time allows
  Counts counts;
  /// Channels of the whole picture that its sums tell: of kDerived.
  std::vector<std::string> derived;
  std::map<std::string, std::string> attributes;  ///< of the whole picture, but for `spp`
  friend bool operator==(const FilmFacts&, const FilmFacts&) = default;
};

/// Of a rendering to a given error, what its samples were when blocks of them ended.
struct FilmBlocks {
  std::vector<Picture> blocks;
  std::vector<Vec3d> before;  ///< sums when the last one ended; empty: none has
};

/// "variance": of the mean luminance, of a film that keeps errors; "samples": of each pixel.
inline constexpr std::array kDerived{"variance", "samples"};

struct FilmFile {
  Film film;
  FilmFacts facts;
  FilmBlocks blocks;
  Channels channels{};  ///< of the whole picture, that no sample changes

  /// Ranges of [0, spp) that are not there.
  std::vector<SampleRange> gaps() const;
  /// Adds a part of the same picture; state and blocks are of neither then. The same, whatever the
  /// order of parts. Throws InputError naming `name` for a part of another picture, of another
  /// plan, or with samples that are there already.
  void merge(const FilmFile& other, const std::string& name);
};

/// The file as bytes. No thread adds to the film meanwhile.
std::string film_bytes(Film& film, const FilmFacts& facts, const FilmBlocks& blocks = {},
                       const Channels& channels = {});
/// Throws InputError for what is no film, or not as it was written.
FilmFile parse_film(std::string_view bytes, const std::string& name);
FilmFile read_film(const std::string& path);
/// Whether a picture has the attribute that makes a film of it.
bool is_film(const ExrFile& file);

/// The whole picture, as the rendering that is not in parts writes it.
ExrFile finished_picture(const Film& film, const FilmFacts& facts, Channels channels = {});

}  // namespace tdpt
