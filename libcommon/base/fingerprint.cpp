#include "libcommon/base/fingerprint.h"

#include <fmt/format.h>

#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"

namespace tdpt {

std::string difference(const Fingerprint& found, const Fingerprint& expected) {
  const auto value_of = [](const Fingerprint& of, const std::string& name) {
    for (const auto& [key, value] : of)
      if (key == name) return value;
    return std::string();
  };
  const auto told = [](const std::string& value) {
    return value.empty() ? std::string("none") : shown(value, 80);
  };
  for (const Fingerprint* names : {&expected, &found})
    for (const auto& [name, unused] : *names) {
      const std::string is = value_of(found, name), should = value_of(expected, name);
      if (is != should)
        return fmt::format("another {} ({}, expected {})", shown(name, 40), told(is), told(should));
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
