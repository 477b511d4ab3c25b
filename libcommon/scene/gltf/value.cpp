#include "libcommon/scene/gltf/value.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "libcommon/base/error.h"

namespace tdpt::gltf {
namespace {

// glTF needs no deeper nesting, and recursive readers would overflow the stack.
constexpr int kDeepest = 64;

/// Maximum number of brackets open at once. Counted before parsing: nlohmann's parser callback
/// could report it, but takes quadratic time in the length of arrays.
int depth_of(std::string_view text) {
  int depth = 0, deepest = 0;
  bool in_text = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_text && c == '\\')
      ++i;
    else if (c == '"')
      in_text = !in_text;
    else if (in_text)
      continue;
    else if (c == '[' || c == '{')
      deepest = std::max(deepest, ++depth);
    else if (c == ']' || c == '}')
      --depth;
  }
  return deepest;
}

std::string brief(const Json& value) {
  if (value.is_array()) return fmt::format("an array of {}", value.size());
  if (value.is_object()) return "an object";
  std::string out = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  return out.size() > 40 ? out.substr(0, 40) + "..." : out;
}

/// Extends `place`, that of `in`, to that of `target`, if it lies there.
bool find_place(const Json& in, const Json* target, std::string& place) {
  if (&in == target) return true;
  const size_t length = place.size();
  if (in.is_object())
    for (const auto& [name, value] : in.items()) {
      place += (length == 0 ? "" : ".") + name.substr(0, 60);
      if (find_place(value, target, place)) return true;
      place.resize(length);
    }
  if (in.is_array())
    for (size_t i = 0; i < in.size(); ++i) {
      place += fmt::format("[{}]", i);
      if (find_place(in[i], target, place)) return true;
      place.resize(length);
    }
  return false;
}

}  // namespace

Json parse_json(std::string_view text, const std::string& file) {
  if (depth_of(text) > kDeepest)
    throw InputError(file, "JSON", fmt::format("is nested more than {} levels deep", kDeepest));
  try {
    return Json::parse(text.begin(), text.end());
  } catch (const Json::parse_error& e) {
    throw InputError(file, fmt::format("JSON byte {}", e.byte), "is not valid JSON");
  } catch (const Json::exception&) {
    throw InputError(file, "JSON", "holds a number beyond the range of double precision");
  }
}

std::string place(std::string_view section, size_t index) {
  return fmt::format("{}[{}]", section, index);
}

const Json& Value::json() const {
  static const Json kNull;
  return json_ ? *json_ : kNull;
}

std::string Value::place() const {
  std::string out;
  find_place(*root_, json_ ? json_ : owner_, out);
  return json_ ? out : out + (out.empty() ? "" : ".") + name_;
}

Value Value::operator[](const char* name) const {
  Value out = *this;
  if (!json_) return out;
  if (!json_->is_object()) fail("an object");
  const auto found = json_->find(name);
  if (found != json_->end()) {
    out.json_ = &*found;
  } else {
    out.json_ = nullptr;
    out.owner_ = json_;
    out.name_ = name;
  }
  return out;
}

const Value& Value::needed(const std::string& why) const {
  if (!json_) fail_because("is missing" + (why.empty() ? "" : ", " + why));
  return *this;
}

size_t Value::size() const {
  if (json_ && !json_->is_array()) fail("an array");
  return json_ ? json_->size() : 0;
}

std::vector<Value> Value::items() const {
  std::vector<Value> out(size(), *this);
  for (size_t i = 0; i < out.size(); ++i) out[i].json_ = &(*json_)[i];
  return out;
}

std::vector<std::pair<std::string, Value>> Value::members() const {
  std::vector<std::pair<std::string, Value>> out;
  if (!json_) return out;
  if (!json_->is_object()) fail("an object");
  for (const auto& [name, value] : json_->items()) {
    out.emplace_back(name, *this);
    out.back().second.json_ = &value;
  }
  return out;
}

double Value::number(double otherwise, double low, double high) const {
  if (!json_) return otherwise;
  if (!json_->is_number()) fail("a number");
  const double x = json_->get<double>();
  if (!(std::isfinite(x) && x >= low && x <= high))
    fail(high == kAny ? fmt::format("a number of at least {}", low)
                      : fmt::format("a number from {} to {}", low, high));
  return x;
}

double Value::number_above_0(double otherwise) const {
  const double x = number(otherwise);
  if (!(x > 0)) fail("more than 0");
  return x;
}

// JSON has only one kind of number: 3.0 and 3e0 are integers, too.
bool Value::is_integer(double low, double high) const {
  if (!json_->is_number()) return false;
  const double x = json_->get<double>();
  return x >= low && x <= high && x == std::floor(x);
}

size_t Value::integer(size_t otherwise, double low, double high) const {
  if (!json_) return otherwise;
  if (!json_->is_number()) fail("an integer");
  if (!is_integer(low, high)) fail(fmt::format("an integer from {:.0f} to {:.0f}", low, high));
  return static_cast<size_t>(json_->get<double>());
}

size_t Value::index_below(size_t n, const char* noun) const {
  if (!json_) return kNone;
  if (!is_integer(0, static_cast<double>(n) - 1))
    fail(fmt::format("an index into the {} {}", n, noun));
  return static_cast<size_t>(json_->get<double>());
}

std::vector<size_t> Value::indices(const char* section) const {
  std::vector<size_t> out;
  if (!json_) return out;
  if (!json_->is_array()) fail("an array of indices");
  for (const Value& v : items()) out.push_back(v.index(section));
  return out;
}

bool Value::boolean(bool otherwise) const {
  if (!json_) return otherwise;
  if (!json_->is_boolean()) fail("true or false");
  return json_->get<bool>();
}

std::string Value::text(const std::string& otherwise) const {
  if (!json_) return otherwise;
  if (!json_->is_string()) fail("a string");
  return json_->get<std::string>();
}

size_t Value::one_of(std::initializer_list<const char*> words, size_t otherwise) const {
  if (!json_) return otherwise;
  const std::string found = text();
  size_t i = 0;
  std::string expected;
  for (const char* word : words) {
    if (found == word) return i;
    expected += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + std::string(word);
    ++i;
  }
  fail(expected);
}

std::vector<double> Value::numbers(size_t count, double low, double high) const {
  std::vector<double> out;
  if (!json_) return out;
  if (!json_->is_array() || (count > 0 && json_->size() != count))
    fail(count > 0 ? fmt::format("an array of {} numbers", count) : "an array of numbers");
  for (const Value& v : items()) out.push_back(v.number(0, low, high));
  return out;
}

Vec3d Value::triple(const Vec3d& otherwise, double low, double high) const {
  const std::vector<double> v = numbers(3, low, high);
  return v.empty() ? otherwise : Vec3d(v[0], v[1], v[2]);
}

void Value::fail(const std::string& expected) const {
  fail_because(fmt::format("is {}, expected {}", brief(json()), expected));
}

void Value::fail_because(const std::string& why) const {
  throw InputError(*file_, place(), why);
}

}  // namespace tdpt::gltf
