// Words of pbrt's scene files, across the files that they include.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/tdpt-import/source.h"

namespace tdpt::foreign::pbrt {

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

}  // namespace tdpt::foreign::pbrt
