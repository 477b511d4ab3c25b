// Words of pbrt's scene files, across the files that they include, and the parameter lists that
// they make: "type name" [values] after a directive.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/tdpt-import/described.h"

namespace tdpt::foreign::pbrt {

/// Whether a file is compressed by gzip.
bool is_gzip(std::string_view bytes);
/// Throws InputError with `name` for broken streams and for more than 1 GiB.
std::string inflated(std::string_view bytes, const std::string& name);

struct Token {
  enum class Kind { word, quoted, open, close } kind = Kind::word;
  std::string text;  ///< without quotes
  size_t line = 0;
};

class Tokens {
 public:
  /// `text` must outlive this.
  Tokens(std::string_view text, std::string shown_name);

  /// The next token; none at the end of the last file. Throws InputError.
  std::optional<Token> next();
  /// Gives `token`, which next() returned last, back.
  void back(Token&& token) { again_ = std::move(token); }
  /// Where the last token was.
  Place place() const;

  /// Goes on with the file `given`, and then with the rest of this one. Files are at most 15 deep.
  void include(Source& source, const std::string& given);
  /// How many files are open.
  size_t depth() const { return open_.size(); }

 private:
  struct File {
    std::string name, shown;
    std::string bytes;      // of an included file
    std::string_view text;  // all of it
    size_t at = 0, line = 1;
  };
  std::string quoted(File& file);

  std::vector<std::unique_ptr<File>> open_;
  std::optional<Token> again_;
  Place last_;
  size_t files_ = 0, bytes_ = 0;  // included so far
};

// Parameter lists: "type name" [values] after a directive.

struct Parameter {
  std::string type, name;
  std::vector<double> numbers{};
  std::vector<std::string> strings{};
  std::vector<char> flags{};
  Place place;
  Key key{};
};

/// Finite number of a token; throws InputError at `place`.
double number_of(const Token& token, const Place& place);

/// A list with its directive. A parameter is found by name and type, as in pbrt: one of another
/// type counts as absent, and stays unread.
class Parameters {
 public:
  Parameters() = default;
  explicit Parameters(Place directive) : place(std::move(directive)) {}
  /// Reads the list that stands next in `tokens`, of `whose`: "Material "matte"". While nobody
  /// takes `holder`, nobody misses its parameters.
  static Parameters read(Tokens& tokens, Source& source, const Key& holder,
                         const std::string& whose);

  /// Appends those of pbrt-v4's Attribute, the last of a name first.
  void defaults(const std::vector<Parameter>& of_attribute);

  const Parameter* find(const std::string& name, std::initializer_list<const char*> types) const;
  /// The first of that name with any type.
  const Parameter* find(const std::string& name) const;

  double number(const std::string& name, double absent) const;
  int integer(const std::string& name, int absent) const;
  bool flag(const std::string& name, bool absent) const;
  std::string text(const std::string& name, const std::string& absent = "") const;
  std::string texture(const std::string& name) const;  ///< name of a texture; empty: none
  Vec3d point(const std::string& name, const Vec3d& absent) const;
  const std::vector<double>* floats(const std::string& name) const;
  /// Points, vectors or normals of `size` numbers each.
  const std::vector<double>* tuples(const std::string& name, size_t size) const;
  const std::vector<double>* integers(const std::string& name) const;
  const std::vector<std::string>* texts(const std::string& name) const;

  /// Takes parameters that do not change the picture, or whose loss is named otherwise.
  void ignore(std::initializer_list<const char*> names) const;
  void ignore_all() const;

  Place place;
  std::vector<Parameter> all{};

 private:
  size_t own_ = SIZE_MAX;  // of these, the others are defaults
  const Parameter* one(const std::string& name, std::initializer_list<const char*> types,
                       size_t values) const;
};

}  // namespace tdpt::foreign::pbrt
