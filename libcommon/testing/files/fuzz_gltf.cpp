// libFuzzer mutator for glTF files: changes the JSON as a tree, its text or the buffer and repacks
// them with correct lengths, or changes the file as bytes.
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libcommon/math/rng.h"
#include "libcommon/testing/files/glb_builder.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t most);

namespace {

using Json = nlohmann::ordered_json;

struct Parts {
  std::string json, bin;
  bool is_glb = false;
};

uint32_t u32_at(const std::string& bytes, size_t at) {
  uint32_t value;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

// Trusts no length in the file.
Parts parts_of(const std::string& bytes) {
  if (!bytes.starts_with("glTF") || bytes.size() < 20) return {bytes, "", false};
  const size_t length = std::min<size_t>(u32_at(bytes, 12), bytes.size() - 20);
  const size_t bin = std::min(20 + length + 8, bytes.size());
  return {bytes.substr(20, length), bytes.substr(bin), true};
}

std::string mutated(std::string bytes, size_t most) {
  const size_t size = bytes.size();
  bytes.resize(std::max(most, size + 1));
  bytes.resize(LLVMFuzzerMutate(reinterpret_cast<uint8_t*>(bytes.data()), size, bytes.size()));
  return bytes;
}

// Every value below the root.
void collect(Json& value, std::vector<Json*>& all) {
  if (value.is_structured())
    for (Json& v : value) {
      all.push_back(&v);
      collect(v, all);
    }
}

Json extreme(tdpt::Rng& rng) {
  static const Json kValues = Json::parse(R"([-1, 0, 1, 2, 3, 4, 5, 7, 255, 256, 65535, 5120, 5121,
    5123, 5125, 5126, 2147483647, -2147483648, 4294967296, 1e15, 0.5, 1e30, 1e300, -1e300, 1e-300,
    true, false, null, "", "VEC3", "MASK", "BLEND", "data:;base64,AAAA", "part.bin", [], {}])");
  return kValues[rng.below(static_cast<uint32_t>(kValues.size()))];
}

void change(Json& root, tdpt::Rng& rng) {
  std::vector<Json*> all;
  collect(root, all);
  if (all.empty()) return;
  const auto any = [&]() -> Json& { return *all[rng.below(static_cast<uint32_t>(all.size()))]; };
  Json& at = any();
  switch (rng.below(6)) {
    case 0:
      at = extreme(rng);
      break;
    case 1:
      at = Json(any());
      break;
    case 2: {  // usually of the same kind
      Json other = any();
      for (int k = 0; k < 8 && other.type() != at.type(); ++k) other = any();
      at = std::move(other);
      break;
    }
    case 3:
      if (at.is_number()) at = at.get<double>() + (rng.below(2) ? 1 : -1);
      break;
    case 4:
      if (at.is_array()) at.push_back(at.empty() ? extreme(rng) : Json(at[0]));
      if (at.is_object()) at.update(any().is_object() ? Json(any()) : Json::object());
      break;
    default:
      if (at.is_structured() && !at.empty()) {
        auto last = at.begin();
        std::advance(last, rng.below(static_cast<uint32_t>(at.size())));
        at.erase(last);
      }
  }
}

}  // namespace

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t most, unsigned seed) {
  tdpt::Rng rng(seed, 0, 0);
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  Parts parts = parts_of(bytes);
  const uint32_t what = rng.below(8);
  if (what == 0) return LLVMFuzzerMutate(data, size, most);
  if (what == 1 && !parts.bin.empty()) {
    parts.bin = mutated(parts.bin, parts.bin.size() + 64);
  } else if (what == 2) {
    parts.json = mutated(parts.json, parts.json.size() + 256);
  } else {
    Json root = Json::parse(parts.json, nullptr, false);
    if (root.is_discarded()) return LLVMFuzzerMutate(data, size, most);
    try {
      for (uint32_t n = 1 + rng.below(3); n > 0; --n) change(root, rng);
    } catch (const Json::exception&) {  // then nothing is changed
    }
    parts.json = root.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  const std::string out = parts.is_glb ? tdpt::testing::glb_of(parts.json, parts.bin) : parts.json;
  if (out.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, out.data(), out.size());
  return out.size();
}
