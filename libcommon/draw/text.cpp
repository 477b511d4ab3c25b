// A glyph is its width and its strokes. A stroke is a row of points, two digits each: x, then y;
// base line 2, small letters to 6, capitals to 8, descenders to 0. A stroke that starts with ~ is
// the control polygon of a quadratic B-spline, closed where it ends as it began.
#include "libcommon/draw/text.h"

#include <array>
#include <vector>

namespace tdpt::draw {
namespace {

struct Glyph {
  int width;
  const char* strokes;
};

constexpr double kBase = 2, kCapital = 6, kGap = 1.7;

// From '!' to '~'.
constexpr std::array<Glyph, 94> kGlyphs{{
    {0, "0804 0202"},                         // !
    {2, "0806 2826"},                         // "
    {4, "1218 3238 0444 0646"},               // #
    {4, "~4748080545420203 2921"},            // $
    {6, "~0608282606 ~4244646242 1258"},      // %
    {5, "~540202053727171752"},               // &
    {0, "0806"},                              // '
    {2, "~29060420"},                         // (
    {2, "~09262400"},                         // )
    {4, "2723 0644 0446"},                    // *
    {4, "0545 2723"},                         // +
    {1, "1200"},                              // ,
    {3, "0434"},                              // -
    {0, "0202"},                              // .
    {3, "0139"},                              // /
    {4, "~0208484202"},                       // 0
    {3, "0628 2822"},                         // 1
    {4, "~0708484502 0242"},                  // 2
    {4, "~0708484515 ~1545420203"},           // 3
    {4, "32380444"},                          // 4
    {4, "480805 ~0545420203"},                // 5
    {4, "~4748080242450504"},                 // 6
    {4, "084812"},                            // 7
    {4, "~0508484505 ~0205454202"},           // 8
    {4, "~0302424808054546"},                 // 9
    {0, "0202 0606"},                         // :
    {1, "1200 1616"},                         // ;
    {4, "470543"},                            // <
    {4, "0343 0545"},                         // =
    {4, "074503"},                            // >
    {4, "~070848452524 2222"},                // ?
    {6, "~4424264643646808025252"},           // @
    {4, "022842 1434"},                       // A
    {4, "0208 ~082848452505 ~052545422202"},  // B
    {4, "~474808024243"},                     // C
    {4, "0208 ~082848422202"},                // D
    {4, "48080242 0535"},                     // E
    {4, "480802 0535"},                       // F
    {4, "~474808024245 4525"},                // G
    {4, "0802 4842 0545"},                    // H
    {0, "0802"},                              // I
    {3, "~3834320204"},                       // J
    {4, "0208 4804 1542"},                    // K
    {4, "080242"},                            // L
    {4, "0208244842"},                        // M
    {4, "02084248"},                          // N
    {5, "~0208585202"},                       // O
    {4, "0208 ~082848442404"},                // P
    {5, "~0208585202 3451"},                  // Q
    {4, "0208 ~082848442404 2442"},           // R
    {4, "~4748080545420203"},                 // S
    {4, "0848 2822"},                         // T
    {4, "~080502424548"},                     // U
    {4, "082248"},                            // V
    {6, "0812375268"},                        // W
    {4, "0842 4802"},                         // X
    {4, "082548 2522"},                       // Y
    {4, "08480242"},                          // Z
    {2, "29090020"},                          // [
    {3, "0931"},                              // backslash
    {2, "09292000"},                          // ]
    {4, "062846"},                            // ^
    {4, "0040"},                              // _
    {1, "0817"},                              // `
    {4, "~0206464202 4642"},                  // a
    {4, "0802 ~0206464202"},                  // b
    {4, "~454606024243"},                     // c
    {4, "4842 ~0206464202"},                  // d
    {4, "0444 ~444606024243"},                // e
    {3, "~38181512 0636"},                    // f
    {4, "~0206464202 ~4641400001"},           // g
    {4, "0802 ~04064642"},                    // h
    {0, "0602 0808"},                         // i
    {1, "1818 ~161000"},                      // j
    {3, "0802 3603 1432"},                    // k
    {1, "0803 ~030212"},                      // l
    {6, "0602 ~04063632 ~34366662"},          // m
    {4, "0602 ~04064642"},                    // n
    {4, "~0206464202"},                       // o
    {4, "0600 ~0206464202"},                  // p
    {4, "4640 ~0206464202"},                  // q
    {3, "0602 ~040636"},                      // r
    {4, "~4546060444420203"},                 // s
    {3, "~181232 0636"},                      // t
    {4, "~06024244 4642"},                    // u
    {4, "062246"},                            // v
    {6, "0612355266"},                        // w
    {4, "0642 4602"},                         // x
    {4, "0622 4610"},                         // y
    {4, "06460242"},                          // z
    {2, "~291915051110"},                     // {
    {0, "0900"},                              // |
    {2, "~09191525111000"},                   // }
    {4, "~04062246"},                         // ~
}};
constexpr Glyph kBox{4, "0208484202"};

const Glyph& glyph(char c) {
  return c > ' ' && c <= '~' ? kGlyphs[static_cast<size_t>(c - '!')] : kBox;
}

// Chaikin's corner cutting: twice as many points on the way to the B-spline.
std::vector<Point> rounder(const std::vector<Point>& p, bool closed) {
  std::vector<Point> q;
  const size_t n = p.size(), edges = closed ? n : n - 1;
  if (!closed) q.push_back(p.front());
  for (size_t i = 0; i < edges; ++i) {
    const Point &a = p[i], &b = p[(i + 1) % n];
    // The end pieces of an open stroke start where it starts.
    if (closed || i > 0) q.push_back({0.75 * a.x + 0.25 * b.x, 0.75 * a.y + 0.25 * b.y});
    if (closed || i + 1 < edges) q.push_back({0.25 * a.x + 0.75 * b.x, 0.25 * a.y + 0.75 * b.y});
  }
  if (!closed) q.push_back(p.back());
  return q;
}

// Calls stroke(points) for each stroke of a glyph, in its own units.
template <class Stroke>
void strokes_of(const Glyph& g, Stroke&& stroke) {
  for (const char* at = g.strokes; *at;) {
    const bool smooth = *at == '~';
    if (smooth) ++at;
    std::vector<Point> p;
    for (; *at && *at != ' '; at += 2)
      p.push_back({static_cast<double>(at[0] - '0'), static_cast<double>(at[1] - '0')});
    if (*at == ' ') ++at;
    if (smooth && p.size() > 2) {
      const bool closed = p.front().x == p.back().x && p.front().y == p.back().y;
      if (closed) p.pop_back();
      for (int i = 0; i < 3; ++i) p = rounder(p, closed);
      if (closed) p.push_back(p.front());
    }
    stroke(p);
  }
}

template <class Place>
void write(Canvas& canvas, std::string_view words, double unit, double line_width, const Ink& c,
           Place&& place) {
  double x = 0;
  for (const char letter : words) {
    if ((static_cast<unsigned char>(letter) & 0xc0) == 0x80) continue;  // inside UTF-8
    if (letter == ' ') {
      x += 4 * unit;
      continue;
    }
    const Glyph& g = glyph(letter);
    strokes_of(g, [&](const std::vector<Point>& p) {
      for (size_t i = 0; i + 1 < p.size(); ++i)
        canvas.line(place(x + p[i].x * unit, (p[i].y - kBase) * unit),
                    place(x + p[i + 1].x * unit, (p[i + 1].y - kBase) * unit), line_width, c);
    });
    x += (g.width + kGap) * unit;
  }
}

double shift(std::string_view words, double size, Align align) {
  return align == Align::left ? 0 : text_width(words, size) * (align == Align::middle ? -0.5 : -1);
}

}  // namespace

double text_width(std::string_view words, double size) {
  double units = 0;
  for (const char letter : words) {
    if ((static_cast<unsigned char>(letter) & 0xc0) == 0x80) continue;
    units += letter == ' ' ? 4 : glyph(letter).width + kGap;
  }
  return units > 0 ? (units - kGap) * size / kCapital : 0;
}

void text(Canvas& canvas, Point base, std::string_view words, double size, const Ink& c,
          Align align, double weight) {
  const double from = base.x + shift(words, size, align);
  write(canvas, words, size / kCapital, weight * 0.13 * size, c, [&](double x, double y) {
    return Point{from + x, base.y - y};
  });
}

void text_up(Canvas& canvas, Point base, std::string_view words, double size, const Ink& c,
             Align align) {
  const double from = base.y - shift(words, size, align);
  write(canvas, words, size / kCapital, 0.13 * size, c, [&](double x, double y) {
    return Point{base.x - y, from - x};
  });
}

}  // namespace tdpt::draw
