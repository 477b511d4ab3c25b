// What determines a result, and whether two results are of the same.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace tdpt {

/// What determines a result: names ("scene", "--seed") with values. No name is there twice.
using Fingerprint = std::vector<std::pair<std::string, std::string>>;

/// The first difference: "another scene (1f3a, expected 77ab)"; "" if there is none.
std::string difference(const Fingerprint& found, const Fingerprint& expected);

/// Fingerprints with the same hash are equal.
std::string hash_of(const Fingerprint& fingerprint);

}  // namespace tdpt
