#include "libcommon/film/film_file.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/format_version.h"

namespace tdpt {
namespace {

using Json = nlohmann::ordered_json;

constexpr uint64_t kMostSamples = uint64_t{1} << 33;
constexpr size_t kMostChannels = 64, kMostRanges = 1 << 20, kMostCounts = 1 << 16;
constexpr std::array kColours{"R", "G", "B"};

// ---- The film's numbers as channels ----

// Channels of `numbers`: "sum.R.0" holds the lowest 32 bits; of a layer "<layer>.sum.R.0".
void append_words(const Film::Numbers& numbers, std::vector<WordChannel>& words) {
  const size_t step = numbers.each * numbers.bytes;
  const bool single = numbers.each == 1;
  for (size_t c = 0; c < numbers.each; ++c)
    for (size_t w = 0; w < numbers.bytes / 4; ++w) {
      const std::string of =
          single ? numbers.name
                 : (numbers.name.empty() ? "" : numbers.name + ".") + "sum." + kColours[c];
      words.push_back({fmt::format("{}.{}", of, w), numbers.first + c * numbers.bytes + 4 * w, step,
                       WordChannel::whole});
    }
}

// As many channels of that many pixels as they fill, "state.0" first; made longer by zeros.
void append_words(StateWords& state, size_t pixels, std::vector<WordChannel>& words) {
  state.resize((state.size() + pixels - 1) / pixels * pixels);
  for (size_t at = 0; at < state.size(); at += pixels)
    words.push_back({fmt::format("state.{}", at / pixels),
                     reinterpret_cast<unsigned char*>(state.data() + at), sizeof(uint32_t),
                     WordChannel::whole});
}

void append_words(const std::string& name, std::vector<float>& values,
                  std::vector<WordChannel>& words) {
  words.push_back(
      {name, reinterpret_cast<unsigned char*>(values.data()), sizeof(float), WordChannel::real});
}

// Hash of everything in a film file, to detect damage. `facts`: as JSON.
std::string hash_of(const std::string& facts, const std::map<std::string, std::string>& attributes,
                    Film& film, const StateWords& words, const Channels& channels) {
  const size_t pixels = static_cast<size_t>(film.width()) * static_cast<size_t>(film.height());
  const auto view = [](const auto* first, size_t bytes) {
    return std::string_view(reinterpret_cast<const char*>(first), bytes);
  };
  std::string hashes = facts;
  for (const auto& [name, value] : attributes)
    hashes += fmt::format("{} {}{} {}", name.size(), name, value.size(), value);
  for (const Film::Numbers& n : film.numbers())
    hashes += content_hash(view(n.first, pixels * n.each * n.bytes));
  hashes += content_hash(view(words.data(), words.size() * sizeof(uint32_t)));
  for (const auto& [name, values] : channels)
    hashes += content_hash(view(values.data(), values.size() * sizeof(float)));
  return content_hash(hashes);
}

// ---- Facts as JSON ----

std::string hexadecimal(Units units) {
  return fmt::format("{:x}", units);
}

Json json_of(const Film& film, const FilmFacts& facts, const StateWords& words,
             const Channels& channels) {
  std::vector<std::string> names;
  for (const auto& [name, values] : channels) names.push_back(name);
  Json j{{"format", format_version::film},
         {"width", film.width()},
         {"height", film.height()},
         {"unit", std::ilogb(film.unit())},
         {"layers", film.options().layers},
         {"alpha", film.options().alpha},
         {"halves", film.options().halves},
         {"words", words.size()},
         {"channels", names},
         {"derived", facts.derived},
         {"spp", facts.spp},
         {"processor", facts.processor},
         {"plan", facts.plan},
         {"state", facts.state}};
  Json& ranges = j["ranges"] = Json::array();
  for (const SampleRange& r : film.ranges()) ranges.push_back({r.first, r.end()});
  Json& shape = j["shape"] = Json::object();
  for (const auto& [name, value] : facts.shape) shape[name] = value;
  Json& counts = j["counts"] = Json::object();
  for (const auto& [name, values] : facts.counts) {
    Json& list = counts[name] = Json::array();
    for (const Units v : values) list.push_back(hexadecimal(v));
  }
  return j;
}

// Reads the facts; every value is checked.
class FactsReader {
 public:
  FactsReader(const Json& from, const std::string& file) : from_(from), file_(file) {}

  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw InputError(file_, "film." + shown(key), what);
  }
  const Json& at(const char* key, Json::value_t type) const {
    const auto found = from_.find(key);
    if (found == from_.end()) fail(key, "is missing");
    const bool is_whole = type == Json::value_t::number_integer && found->is_number_integer();
    if (!is_whole && found->type() != type) fail(key, "is of another type");
    return *found;
  }
  int64_t whole(const char* key, int64_t lowest, int64_t highest) const {
    return whole(key, at(key, Json::value_t::number_integer), lowest, highest);
  }
  int64_t whole(const char* key, const Json& value, int64_t lowest, int64_t highest) const {
    if (!value.is_number_integer() ||
        (value.is_number_unsigned() && value.get<uint64_t>() > static_cast<uint64_t>(INT64_MAX)) ||
        value.get<int64_t>() < lowest || value.get<int64_t>() > highest)
      fail(key, "is out of range");
    return value.get<int64_t>();
  }
  std::vector<std::string> texts(const char* key, size_t most) const {
    std::vector<std::string> all;
    const Json& list = at(key, Json::value_t::array);
    if (list.size() > most) fail(key, "are too many");
    for (const Json& value : list) all.push_back(text(key, value));
    return all;
  }
  bool flag(const char* key) const { return at(key, Json::value_t::boolean).get<bool>(); }
  std::string text(const char* key) const { return text(key, at(key, Json::value_t::string)); }
  std::string text(const std::string& key, const Json& value) const {
    if (!value.is_string()) fail(key, "is no text");
    return value.get<std::string>();
  }
  Units units(const std::string& key, const Json& value) const {
    const std::string digits = text(key, value);
    Units all = 0;
    for (const char c : digits) {
      const int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
      if (digit < 0 || digits.size() > 32) fail(key, "is no number of 128 bits");
      all = all << 4 | static_cast<Units>(digit);
    }
    return all;
  }

 private:
  const Json& from_;
  const std::string& file_;
};

std::vector<SampleRange> ranges_of(const FactsReader& in) {
  std::vector<SampleRange> ranges;
  const Json& list = in.at("ranges", Json::value_t::array);
  if (list.size() > kMostRanges) in.fail("ranges", "are too many");
  for (const Json& pair : list) {
    if (!pair.is_array() || pair.size() != 2) in.fail("ranges", "has an entry that is no pair");
    const int64_t first = in.whole("ranges", pair[0], 0, kMostSamples);
    const int64_t end = in.whole("ranges", pair[1], first, kMostSamples);
    ranges.push_back({static_cast<uint64_t>(first), static_cast<uint64_t>(end - first)});
  }
  return ranges;
}

FilmFacts facts_of(const FactsReader& in) {
  FilmFacts facts;
  facts.spp = static_cast<uint64_t>(in.whole("spp", 0, kMostSamples));
  facts.processor = in.text("processor");
  facts.plan = in.text("plan");
  facts.state = in.text("state");
  facts.derived = in.texts("derived", kMostChannels);
  for (const auto& [name, value] : in.at("shape", Json::value_t::object).items())
    facts.shape.emplace_back(name, in.text(name, value));
  for (const auto& [name, values] : in.at("counts", Json::value_t::object).items()) {
    if (!values.is_array() || values.size() > kMostCounts) in.fail(name, "is no list of numbers");
    for (const Json& value : values) facts.counts[name].push_back(in.units(name, value));
  }
  return facts;
}

Film::Options options_of(const FactsReader& in) {
  Film::Options options;
  options.alpha = in.flag("alpha");
  options.halves = in.flag("halves");
  options.layers = in.texts("layers", Film::kMostLayers);
  return options;
}

// Before allocating sums: whether the file has all of them, and their memory.
void check_sums(const Film::Options& options, size_t state_channels, const ExrFile& exr,
                std::string_view bytes, const std::string& name) {
  Film pixel(1, 1, 1, options);
  StateWords state(state_channels);
  std::vector<WordChannel> words;
  for (const Film::Numbers& n : pixel.numbers()) append_words(n, words);
  append_words(state, 1, words);
  const std::vector<std::string> all = exr_channels(bytes, name);
  const std::set<std::string> there(all.begin(), all.end());
  for (const WordChannel& word : words)
    if (!there.contains(word.name))
      throw InputError(name, "channel " + shown(word.name, 80), "is missing");
  const size_t of_pictures = sizeof(Rgb) * (1 + exr.layers.size());
  const size_t of_pixel =
      options.bytes_of_pixel() + sizeof(uint32_t) * state_channels + of_pictures;
  expect_memory(
      name, "film",
      fmt::format("{} x {} pixels of {} bytes", exr.picture.width, exr.picture.height, of_pixel),
      of_pixel * exr.picture.pixels.size());
}

// The film of a file whose attribute is `json`. `exr`: its float channels, `bytes`: the file.
FilmFile film_of(const Json& json, ExrFile& exr, std::string_view bytes, const std::string& name) {
  const FactsReader in(json, name);
  check_version(name, "film.format", in.at("format", Json::value_t::number_integer).dump(),
                format_version::film);
  const int width = exr.picture.width, height = exr.picture.height;
  in.whole("width", width, width);
  in.whole("height", height, height);
  const auto unit = static_cast<int>(in.whole("unit", -1000, 900));
  const Film::Options options = options_of(in);
  const size_t pixels = exr.picture.pixels.size();
  const auto state_words =
      static_cast<size_t>(in.whole("words", 0, static_cast<int64_t>(kMostChannels * pixels)));
  check_sums(options, (state_words + pixels - 1) / pixels, exr, bytes, name);
  FilmFile file{Film(width, height, std::ldexp(1.0, unit + 64), options), facts_of(in)};
  file.words.resize(state_words);
  std::vector<WordChannel> words;
  for (const Film::Numbers& n : file.film.numbers()) append_words(n, words);
  append_words(file.words, pixels, words);
  for (const std::string& channel : in.texts("channels", kMostChannels)) {
    std::vector<float>& values = file.channels[channel];
    values.resize(exr.picture.pixels.size());
    append_words(channel, values, words);
  }
  parse_exr_words(bytes, name, width, height, words);
  file.words.resize(state_words);
  try {
    file.film.restore(ranges_of(in));
  } catch (const std::invalid_argument&) {
    in.fail("ranges", "overlap");
  }
  return file;
}

}  // namespace

std::string words_of(const std::vector<SampleRange>& ranges) {
  constexpr size_t kMost = 8;
  std::vector<std::string> all;
  for (const SampleRange& r : ranges)
    all.push_back(r.count == 1 ? std::to_string(r.first)
                               : fmt::format("{} to {}", r.first, r.end() - 1));
  if (all.empty()) return "no samples";
  if (all.size() > kMost) {
    const size_t more = all.size() - kMost;
    all.resize(kMost);
    all.push_back(fmt::format("{} more runs", more));
  }
  const std::string last = all.back();
  all.pop_back();
  return fmt::format("samples {}{}{}", fmt::join(all, ", "), all.empty() ? "" : " and ", last);
}

std::string part_words(const std::vector<SampleRange>& ranges, uint64_t of) {
  return fmt::format("{} of {}", words_of(ranges), of);
}

std::string merged_words(const std::string& a, const std::string& b) {
  std::vector<std::string> words;
  for (const std::string& list : {a, b})
    for (size_t at = 0; at < list.size();) {
      const size_t end = std::min(list.find(", ", at), list.size());
      words.push_back(list.substr(at, end - at));
      at = end + 2;
    }
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string mixed_code_sentence(const std::string& processors) {
  if (merged_words(processors, kGpuCode) == processors)
    return fmt::format(
        "rendered by code for {}: CPU and GPU agree in the mean, but not in the last "
        "digits of each sample",
        processors);
  return fmt::format(
      "rendered by code for {}: the last digits may differ from those of one machine; "
      "tdpt-render --set isa=sse2 is alike on all",
      processors);
}

std::vector<SampleRange> FilmFile::gaps() const {
  std::vector<SampleRange> gaps;
  uint64_t at = 0;
  for (const SampleRange& r : film.ranges()) {
    if (r.first > at) gaps.push_back({at, r.first - at});
    at = r.end();
  }
  if (at < facts.spp) gaps.push_back({at, facts.spp - at});
  return gaps;
}

void FilmFile::merge(const FilmFile& other, const std::string& name) {
  const auto refuse = [&](const std::string& what) { throw InputError(name, "", what); };
  if (const std::string other_shape = difference(other.facts.shape, facts.shape);
      !other_shape.empty())
    refuse("is of " + other_shape);
  if (other.facts.plan != facts.plan)
    refuse(
        "was rendered by another plan: give all parts the same options, and name the integrator "
        "(--integrator NAME) or use --set isa=sse2, so that all machines decide alike");
  if (other.film.options() != film.options() || other.film.unit() != film.unit() ||
      other.film.width() != film.width() || other.film.height() != film.height())
    refuse("keeps other sums");
  try {
    film.merge(other.film);
  } catch (const std::invalid_argument&) {
    refuse("holds " + words_of(other.film.ranges()) +
           ", some of which are there already: " + words_of(film.ranges()));
  } catch (const std::overflow_error&) {
    refuse("holds sums too large to be added");
  }
  for (const auto& [key, values] : other.facts.counts) {
    std::vector<Units>& sums = facts.counts[key];
    sums.resize(std::max(sums.size(), values.size()));
    for (size_t i = 0; i < values.size(); ++i) sums[i] += values[i];
  }
  facts.spp = std::max(facts.spp, other.facts.spp);
  facts.attributes = std::min(facts.attributes, other.facts.attributes);
  facts.processor = merged_words(facts.processor, other.facts.processor);
  facts.state.clear();
  words.clear();
  if (channels.empty()) channels = other.channels;
}

std::string film_bytes(Film& film, const FilmFacts& facts, const StateWords& words,
                       const Channels& channels) {
  ExrFile exr;
  exr.picture = film.picture();
  exr.attributes = facts.attributes;
  exr.attributes["spp"] = std::to_string(film.samples());
  exr.channels = channels;
  const std::string text =
      json_of(film, facts, words, channels).dump(-1, ' ', false, Json::error_handler_t::replace);
  exr.attributes[kPartAttribute] = part_words(film.ranges(), facts.spp);
  exr.attributes[film_attribute] = Json{
      {"hash", hash_of(text, facts.attributes, film, words, channels)},
      {"facts", text}}.dump();
  StateWords state = words;
  for (const Film::Numbers& n : film.numbers()) append_words(n, exr.words);
  append_words(state, exr.picture.pixels.size(), exr.words);
  return exr_bytes(exr);
}

FilmFile parse_film(std::string_view bytes, const std::string& name) {
  ExrFile exr = parse_exr(bytes, name);
  const auto found = exr.attributes.find(film_attribute);
  if (found == exr.attributes.end())
    throw InputError(name, "", "is a picture without the sums of a film");
  const auto parsed = [&](const std::string& text) {
    Json json = nested_too_deep(text) ? Json() : Json::parse(text, nullptr, false);
    if (!json.is_object()) throw InputError(name, "film", "is damaged");
    return json;
  };
  const Json outer = parsed(found->second);
  const auto string_of = [&](const char* key) {
    const auto value = outer.find(key);
    return value != outer.end() && value->is_string() ? value->get<std::string>() : "";
  };
  const std::string text = string_of("facts"), hash = string_of("hash");
  const Json facts = parsed(text);
  FilmFile file = film_of(facts, exr, bytes, name);
  file.facts.attributes = std::move(exr.attributes);
  file.facts.attributes.erase(film_attribute);
  file.facts.attributes.erase("spp");
  file.facts.attributes.erase(kPartAttribute);
  if (hash != hash_of(text, file.facts.attributes, file.film, file.words, file.channels))
    throw InputError(name, "film", "is damaged");
  return file;
}

FilmFile read_film(const std::string& path) {
  return parse_film(read_file(path), display_name(path));
}

bool is_film(const ExrFile& file) {
  return file.attributes.count(film_attribute) > 0;
}

ExrFile finished_picture(const Film& film, const FilmFacts& facts, Channels channels) {
  ExrFile exr;
  exr.channels = std::move(channels);
  const size_t pixels = static_cast<size_t>(film.width()) * static_cast<size_t>(film.height());
  for (const std::string& name : facts.derived) {
    if (name == "samples")
      exr.channels["samples.Y"].assign(pixels, static_cast<float>(film.samples()));
    if (name == "halves")
      for (const uint64_t half : {0, 1}) exr.layers[kHalves[half]] = film.half(half);
    if (name != "variance") continue;
    // Pictures must not contain infinities.
    constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
    std::vector<float>& values = exr.channels["variance.Y"];
    for (const double v : film.variance()) values.push_back(static_cast<float>(std::min(v, most)));
  }
  exr.picture = film.picture();
  const std::vector<std::string>& layers = film.options().layers;
  for (size_t i = 0; i < layers.size(); ++i)
    if (!layers[i].empty()) exr.layers[layers[i]] = film.layer(i);
  exr.attributes = facts.attributes;
  if (film.samples() < facts.spp) exr.attributes.erase(kFrameAttribute);
  exr.attributes["spp"] = std::to_string(film.samples());
  return exr;
}

}  // namespace tdpt
