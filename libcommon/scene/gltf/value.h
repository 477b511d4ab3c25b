// A value of a scene's JSON that knows its place in the file. Whoever reads a value says what it
// may be, and anything else is an InputError with that place: each value is checked once, where it
// is read.
#pragma once
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "libcommon/math/vec.h"

namespace tdpt::gltf {

using Json = nlohmann::json;

constexpr size_t kNone = ~size_t{0};  ///< no index
constexpr double kAny = 1.7e308, kMostInteger = 9007199254740992.0;

/// Parses the JSON of a glTF file. Throws InputError if it is malformed or nested too deeply.
Json parse_json(std::string_view text, const std::string& file);

/// "accessors[3]": place of an element in messages.
std::string place(std::string_view section, size_t index);

/// A value that the file may lack. An absent one has the value that the caller gives. All limits
/// are inclusive.
class Value {
 public:
  /// The whole JSON of `file`, its name in messages. Both must outlive the value.
  Value(const std::string& file, const Json& root) : file_(&file), root_(&root), json_(&root) {}

  explicit operator bool() const { return json_ != nullptr; }
  const Json& json() const;   ///< null if absent
  std::string place() const;  ///< searched for in the whole JSON: for messages only
  Value root() const { return {*file_, *root_}; }

  /// A member of this object, whose name must outlive the value; absent if the object is.
  Value operator[](const char* name) const;
  Value extension(const char* name) const { return (*this)["extensions"][name]; }
  /// The value itself, unless it is absent.
  const Value& needed(const std::string& why = "") const;
  std::vector<Value> items() const;                            ///< of an array
  size_t size() const;                                         ///< of an array
  std::vector<std::pair<std::string, Value>> members() const;  ///< of an object

  double number(double otherwise, double low = -kAny, double high = kAny) const;
  double number_above_0(double otherwise) const;
  size_t integer(size_t otherwise, double low = 0, double high = kMostInteger) const;
  /// An index into a section of the file, or among `n` of something; kNone if absent.
  size_t index(const char* section) const {
    return json_ ? index_below(root()[section].size(), section) : kNone;
  }
  size_t index_below(size_t n, const char* noun) const;
  std::vector<size_t> indices(const char* section) const;
  bool boolean(bool otherwise) const;
  std::string text(const std::string& otherwise = "") const;
  /// The position of a text among `words`.
  size_t one_of(std::initializer_list<const char*> words, size_t otherwise) const;
  /// `count` numbers, any number of them if 0; none if absent.
  std::vector<double> numbers(size_t count, double low = -kAny, double high = kAny) const;
  Vec3d triple(const Vec3d& otherwise, double low = -kAny, double high = kAny) const;

  /// Throws: "is 7, expected an object".
  [[noreturn]] void fail(const std::string& expected) const;
  /// Throws any other message about this place.
  [[noreturn]] void fail_because(const std::string& why) const;

 private:
  bool is_integer(double low, double high) const;

  const std::string* file_;
  const Json *root_, *json_;
  const Json* owner_ = nullptr;  // of an absent member
  const char* name_ = "";        // its name
};

}  // namespace tdpt::gltf
