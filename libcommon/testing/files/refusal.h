// What is said of inputs that are refused, for tests.
#pragma once
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"

namespace tdpt::testing {

/// The message of the `Kind` of Error that `call` throws; "" if it throws none.
template <class Kind = Error, class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const Kind& e) {
    return e.what();
  }
  return "";
}

/// Whether a refusal names the place, as "line 6" ("": none is asked for), and the word.
inline ::testing::AssertionResult names(const std::string& said, const std::string& place,
                                        const std::string& word) {
  const bool placed = place.empty() || said.find(":" + place + ": ") != said.npos;
  if (!said.empty() && placed && said.find(word) != said.npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure()
         << "'" << said << "', expected " << place << " and '" << word << "'";
}

/// An input, and what its refusal must name.
struct Refused {
  std::string input, place, word;
};

template <class Read>
void expect_refused(const std::vector<Refused>& cases, const Read& read) {
  for (const auto& [input, place, word] : cases)
    EXPECT_TRUE(names(refusal<InputError>([&] { read(input); }), place, word)) << " of\n" << input;
}

}  // namespace tdpt::testing
