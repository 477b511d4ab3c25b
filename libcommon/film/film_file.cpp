#include "libcommon/film/film_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/format_version.h"

namespace tdpt {
namespace {

using Json = nlohmann::ordered_json;

constexpr uint64_t kMostSamples = uint64_t{1} << 33;
constexpr size_t kMostChannels = 64;
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
    for (const Units v : values) list.push_back(fmt::format("{:x}", v));
  }
  return j;
}

// The following read the facts. They throw std::invalid_argument, or an exception of the JSON
// library, for what cannot be.

int64_t whole(const Json& value, int64_t lowest, int64_t highest) {
  if (!value.is_number_integer() ||
      (value.is_number_unsigned() && value.get<uint64_t>() > static_cast<uint64_t>(INT64_MAX)) ||
      value.get<int64_t>() < lowest || value.get<int64_t>() > highest)
    throw std::invalid_argument("out of range");
  return value.get<int64_t>();
}

Units units_of(const std::string& digits) {
  Units all = 0;
  for (const char c : digits) {
    const int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
    if (digit < 0 || digits.size() > 32) throw std::invalid_argument("no number of 128 bits");
    all = all << 4 | static_cast<Units>(digit);
  }
  return all;
}

std::vector<SampleRange> ranges_of(const Json& list) {
  std::vector<SampleRange> ranges;
  for (const Json& pair : list) {
    const int64_t first = whole(pair.at(0), 0, kMostSamples);
    const int64_t end = whole(pair.at(1), first, kMostSamples);
    ranges.push_back({static_cast<uint64_t>(first), static_cast<uint64_t>(end - first)});
  }
  return ranges;
}

FilmFacts facts_of(const Json& j) {
  FilmFacts facts;
  facts.spp = static_cast<uint64_t>(whole(j.at("spp"), 0, kMostSamples));
  j.at("processor").get_to(facts.processor);
  j.at("plan").get_to(facts.plan);
  j.at("state").get_to(facts.state);
  j.at("derived").get_to(facts.derived);
  for (const auto& [name, value] : j.at("shape").items())
    facts.shape.emplace_back(name, value.get<std::string>());
  for (const auto& [name, values] : j.at("counts").items())
    for (const Json& value : values)
      facts.counts[name].push_back(units_of(value.get<std::string>()));
  return facts;
}

// The film of a file whose attribute is `j`. `exr`: its float channels, `bytes`: the file.
FilmFile film_of(const Json& j, const ExrFile& exr, std::string_view bytes,
                 const std::string& name) {
  check_version(name, "film.format", j.at("format").dump(), format_version::film);
  const int width = exr.picture.width, height = exr.picture.height;
  whole(j.at("width"), width, width);
  whole(j.at("height"), height, height);
  const auto unit = static_cast<int>(whole(j.at("unit"), -1000, 900));
  const Film::Options options{j.at("layers").get<std::vector<std::string>>(),
                              j.at("alpha").get<bool>(), j.at("halves").get<bool>()};
  const size_t pixels = exr.picture.pixels.size();
  const auto state_words =
      static_cast<size_t>(whole(j.at("words"), 0, static_cast<int64_t>(kMostChannels * pixels)));
  const auto channels = j.at("channels").get<std::vector<std::string>>();
  const size_t of_pixel = options.bytes_of_pixel() +
                          sizeof(uint32_t) * ((state_words + pixels - 1) / pixels) +
                          sizeof(float) * channels.size() + sizeof(Rgb) * (1 + exr.layers.size());
  expect_memory(name, "film", fmt::format("{} x {} pixels of {} bytes", width, height, of_pixel),
                of_pixel * pixels);
  FilmFile file{Film(width, height, std::ldexp(1.0, unit + 64), options), facts_of(j)};
  file.words.resize(state_words);
  std::vector<WordChannel> words;
  for (const Film::Numbers& n : file.film.numbers()) append_words(n, words);
  append_words(file.words, pixels, words);
  for (const std::string& channel : channels) {
    std::vector<float>& values = file.channels[channel];
    values.resize(pixels);
    append_words(channel, values, words);
  }
  parse_exr_words(bytes, name, width, height, words);
  file.words.resize(state_words);
  file.film.restore(ranges_of(j.at("ranges")));
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
  const auto parsed = [](const std::string& text) {
    return nested_too_deep(text) ? Json() : Json::parse(text);
  };
  try {
    const Json outer = parsed(found->second);
    const auto text = outer.at("facts").get<std::string>(),
               hash = outer.at("hash").get<std::string>();
    FilmFile file = film_of(parsed(text), exr, bytes, name);
    file.facts.attributes = std::move(exr.attributes);
    for (const char* own : {film_attribute, "spp", kPartAttribute})
      file.facts.attributes.erase(own);
    if (hash == hash_of(text, file.facts.attributes, file.film, file.words, file.channels))
      return file;
  } catch (const Json::exception&) {
  } catch (const std::invalid_argument&) {
  }
  throw InputError(name, "film", "is damaged");
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
