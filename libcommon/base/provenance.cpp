#include "libcommon/base/provenance.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "tdpt_version.h"

namespace tdpt {

namespace {

// A name or a value may contain line breaks; a line of a text format must not.
std::string in_one_line(const std::string& text) {
  return shown(text, text.size());
}

}  // namespace

void Provenance::inherit(const Provenance& input) {
  for (const std::string& line : input.lines)
    if (line.starts_with("from ") || std::find(lines.begin(), lines.end(), line) == lines.end())
      lines.push_back(line);
}

void Provenance::made_by(const std::string& tool, const std::string& command) {
  lines.push_back("made by " + tool + " " + TDPT_VERSION + ": " + in_one_line(command));
}

void Provenance::from(const std::string& path, const std::string& hash) {
  const std::string name =
      path == "-" ? "(standard input)" : path.substr(path.find_last_of('/') + 1);
  lines.push_back("from " + in_one_line(name) + " " + hash);
}

namespace {

std::string words_of(const XXH128_hash_t& h) {
  return fmt::format("{:016x}{:016x}", h.high64, h.low64);
}

struct OpenFile {
  int fd;
  ~OpenFile() {
    if (fd >= 0) ::close(fd);
  }
};

}  // namespace

std::string content_hash(std::string_view bytes) {
  return words_of(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string content_hash_of_file(const std::string& path) {
  const auto fail = [&](const char* what) {
    throw InputError(path, "", std::string(what) + std::strerror(errno));
  };
  const OpenFile file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.fd < 0) fail("cannot be opened: ");
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  XXH3_128bits_reset(state.get());
  std::vector<char> part(size_t{1} << 20);
  for (;;) {
    const ssize_t n = ::read(file.fd, part.data(), part.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("cannot be read: ");
    if (n == 0) break;
    XXH3_128bits_update(state.get(), part.data(), static_cast<size_t>(n));
  }
  return words_of(XXH3_128bits_digest(state.get()));
}

std::string difference(const Fingerprint& found, const Fingerprint& expected) {
  const auto value_of = [](const Fingerprint& of, const std::string& name) {
    for (const auto& [key, value] : of)
      if (key == name) return value;
    return std::string();
  };
  const auto value_words = [](const std::string& value) {
    return value.empty() ? std::string("none") : shown(value, 80);
  };
  for (const Fingerprint* names : {&expected, &found})
    for (const auto& [name, unused] : *names) {
      const std::string is = value_of(found, name), should = value_of(expected, name);
      if (is != should)
        return fmt::format("another {} ({}, expected {})", shown(name, 40), value_words(is),
                           value_words(should));
    }
  return "";
}

std::string hash_of(const Fingerprint& fingerprint) {
  std::string text;  // with lengths, so that no other fingerprint gives the same bytes
  for (const auto& [name, value] : fingerprint)
    text += fmt::format("{}:{}{}:{}", name.size(), name, value.size(), value);
  return content_hash(text);
}

}  // namespace tdpt
