// Tells pbrt-v3 from pbrt-v4 and reads the scene.
#include "tools/tdpt-import/pbrt/pbrt.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

#include "tools/tdpt-import/pbrt/builder.h"
#include "tools/tdpt-import/pbrt/tokens.h"

namespace tdpt::foreign {
namespace {

using pbrt::Token;
using pbrt::Tokens;

// What only one of the two knows; a film or a material tells by its kind, a parameter by its type.
constexpr std::string_view kWordsV3[] = {"WorldEnd"};
constexpr std::string_view kWordsV4[] = {"Attribute", "ColorSpace", "Import",
                                         "Option",    "true",       "false"};
constexpr std::string_view kKindsV3[] = {"image",     "matte",       "plastic",      "uber",
                                         "substrate", "translucent", "glass",        "mirror",
                                         "metal",     "disney",      "kdsubsurface", "fourier"};
constexpr std::string_view kKindsV4[] = {
    "rgb",       "gbuffer",         "spectral",   "diffuse",        "coateddiffuse",
    "conductor", "coatedconductor", "dielectric", "thindielectric", "diffusetransmission",
    "measured",  "interface"};
constexpr std::string_view kTypesV3[] = {"point ", "vector ", "color ", "xyz "};

template <size_t n>
bool holds(const std::string_view (&list)[n], std::string_view word) {
  return std::find(std::begin(list), std::end(list), word) != std::end(list);
}
template <size_t n>
bool starts_with_any(const std::string_view (&list)[n], std::string_view word) {
  return std::any_of(std::begin(list), std::end(list),
                     [&](std::string_view s) { return word.starts_with(s); });
}

bool is_v4(const Source& source) {
  Tokens tokens(source.text(), source.path());
  size_t v3 = 0, v4 = 0;
  std::string before;  // of a token that may name a kind
  while (const std::optional<Token> token = tokens.next()) {
    const std::string& t = token->text;
    if (token->kind == Token::Kind::word) {
      v3 += holds(kWordsV3, t);
      v4 += holds(kWordsV4, t);
    } else if (token->kind == Token::Kind::quoted) {
      if (before == "Film" || before == "Material" || before == "string type") {
        v3 += holds(kKindsV3, t);
        v4 += holds(kKindsV4, t);
      }
      v3 += starts_with_any(kTypesV3, t);
    }
    if (token->kind != Token::Kind::open) before = t;
  }
  return v4 >= v3;
}

}  // namespace

Described read_pbrt(Source& source) {
  return pbrt::Builder(source, is_v4(source)).run();
}

}  // namespace tdpt::foreign
