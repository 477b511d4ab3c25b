// The drawing is recorded on a cairo recording surface, which is replayed for each file format.
#include "libcommon/draw/canvas.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <pango/pangocairo.h>

#include "libcommon/base/child_process.h"
#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/png.h"

namespace tdpt::draw {
namespace {

template <auto release>
struct Release {
  template <class T>
  void operator()(T* object) const {
    release(object);
  }
};
using Surface = std::unique_ptr<cairo_surface_t, Release<cairo_surface_destroy>>;
using Context = std::unique_ptr<cairo_t, Release<cairo_destroy>>;

void check(cairo_status_t status) {
  if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
  if (status != CAIRO_STATUS_SUCCESS)
    throw std::runtime_error(std::string("drawing: ") + cairo_status_to_string(status));
}

// Cairo uses fixed-point coordinates up to 2^23.
bool can_draw(std::initializer_list<double> coordinates) {
  return std::all_of(coordinates.begin(), coordinates.end(),
                     [](double v) { return std::abs(v) < 1e6; });
}

uint8_t byte_of(float v) {
  return static_cast<uint8_t>(std::lround(255 * std::clamp(v, 0.0f, 1.0f)));
}

Surface surface_of(const Raster& texels) {
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, texels.width(), texels.height()));
  check(cairo_surface_status(surface.get()));
  unsigned char* row = cairo_image_surface_get_data(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  for (int y = 0; y < texels.height(); ++y, row += stride)
    for (int x = 0; x < texels.width(); ++x) {
      const Ink& c = texels.at(x, y);
      reinterpret_cast<uint32_t*>(row)[x] =
          uint32_t{byte_of(c.x)} << 16 | uint32_t{byte_of(c.y)} << 8 | byte_of(c.z);
    }
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

// On a system without fonts, uses those packaged with the program, if any [cmake/tarball.sh].
void find_fonts() {
  namespace fs = std::filesystem;
  std::error_code unreadable;
  if (std::getenv("FONTCONFIG_FILE") || std::getenv("FONTCONFIG_PATH") ||
      fs::exists("/etc/fonts/fonts.conf", unreadable))
    return;
  const fs::path packed = fs::path(program_folder()) / "../share/tdpt/fonts/fonts.conf";
  if (fs::exists(packed, unreadable)) ::setenv("FONTCONFIG_FILE", packed.c_str(), 1);
}

// A shaped line of text, with glyphs from other fonts where the first has none.
class Line {
 public:
  Line(const std::string& words, double size, bool bold, double room) {
    // Height of capitals as a share of DejaVu Sans' font size.
    constexpr double kCapital = 0.729;
    PangoFontMap* fonts = pango_cairo_font_map_get_default();
    const std::unique_ptr<PangoContext, Release<g_object_unref>> context(
        pango_font_map_create_context(fonts));
    // Ignores the settings of desktop and locale.
    const std::unique_ptr<cairo_font_options_t, Release<cairo_font_options_destroy>> options(
        cairo_font_options_create());
    cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
    cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_SLIGHT);
    cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_ON);
    pango_cairo_context_set_font_options(context.get(), options.get());
    pango_context_set_language(context.get(), pango_language_from_string("en"));

    const std::unique_ptr<PangoFontDescription, Release<pango_font_description_free>> font(
        pango_font_description_from_string("DejaVu Sans, Sans"));
    pango_font_description_set_absolute_size(font.get(), size / kCapital * PANGO_SCALE);
    if (bold) pango_font_description_set_weight(font.get(), PANGO_WEIGHT_BOLD);
    if (!std::unique_ptr<PangoFont, Release<g_object_unref>>(
            pango_font_map_load_font(fonts, context.get(), font.get())))
      throw Error(Exit::output, "no font is installed, and a picture needs one for its words");
    layout_.reset(pango_layout_new(context.get()));
    pango_layout_set_font_description(layout_.get(), font.get());
    pango_layout_set_single_paragraph_mode(layout_.get(), TRUE);
    if (room > 0) {
      pango_layout_set_width(layout_.get(), static_cast<int>(room * PANGO_SCALE));
      pango_layout_set_ellipsize(layout_.get(), PANGO_ELLIPSIZE_END);
    }
    // File names may contain any bytes.
    const std::unique_ptr<char, Release<g_free>> valid(
        g_utf8_make_valid(words.data(), static_cast<gssize>(words.size())));
    pango_layout_set_text(layout_.get(), valid.get(), -1);
  }

  double width() const {
    PangoRectangle extents;
    pango_layout_get_extents(layout_.get(), nullptr, &extents);
    return static_cast<double>(extents.width) / PANGO_SCALE;
  }
  void show(cairo_t* to) const {
    pango_cairo_show_layout_line(to, pango_layout_get_line_readonly(layout_.get(), 0));
  }

 private:
  std::unique_ptr<PangoLayout, Release<g_object_unref>> layout_;
};

}  // namespace

struct Canvas::Recording {
  Surface surface;
  Context cairo;

  void source(const Ink& c, double alpha) {
    cairo_set_source_rgba(cairo.get(), static_cast<double>(c.x), static_cast<double>(c.y),
                          static_cast<double>(c.z), alpha);
  }
  void fill(const Ink& c, double alpha) {
    source(c, alpha);
    cairo_fill(cairo.get());
  }
  void stroke(double line_width, const Ink& c, double alpha) {
    source(c, alpha);
    cairo_set_line_width(cairo.get(), line_width);
    cairo_stroke(cairo.get());
  }
  void play(cairo_surface_t* target) const {
    const Context to(cairo_create(target));
    cairo_set_source_surface(to.get(), surface.get(), 0, 0);
    cairo_paint(to.get());
    cairo_surface_flush(surface.get());  // releases the copy that an SVG surface takes
    check(cairo_status(cairo.get()));
    check(cairo_status(to.get()));
  }
};

Canvas::Canvas(int width, int height, const Ink& paper)
    : recording_(std::make_unique<Recording>()), width_(width), height_(height) {
  const cairo_rectangle_t all{0, 0, static_cast<double>(width), static_cast<double>(height)};
  recording_->surface.reset(cairo_recording_surface_create(CAIRO_CONTENT_COLOR, &all));
  recording_->cairo.reset(cairo_create(recording_->surface.get()));
  check(cairo_status(recording_->cairo.get()));
  cairo_set_line_cap(recording_->cairo.get(), CAIRO_LINE_CAP_ROUND);
  cairo_set_antialias(recording_->cairo.get(), CAIRO_ANTIALIAS_BEST);
  fill({0, 0, all.width, all.height}, paper);
}

Canvas::~Canvas() = default;
Canvas::Canvas(Canvas&&) noexcept = default;

void Canvas::clip(const Rectangle& r) {
  unclip();
  const double x = std::round(r.x), y = std::round(r.y);
  cairo_rectangle(recording_->cairo.get(), x, y, std::round(r.right()) - x,
                  std::round(r.bottom()) - y);
  cairo_clip(recording_->cairo.get());
}

void Canvas::unclip() {
  cairo_reset_clip(recording_->cairo.get());
}

void Canvas::line(Pixel a, Pixel b, double line_width, const Ink& c, double alpha) {
  if (!can_draw({a.x, a.y, b.x, b.y})) return;
  cairo_move_to(recording_->cairo.get(), a.x, a.y);
  cairo_line_to(recording_->cairo.get(), b.x, b.y);
  recording_->stroke(line_width, c, alpha);
}

void Canvas::disc(Pixel centre, double radius, const Ink& c, double alpha) {
  line(centre, centre, 2 * radius, c, alpha);
}

void Canvas::polygon(const std::vector<Pixel>& corners, const Ink& c, double alpha) {
  if (corners.size() < 3) return;
  for (const Pixel& p : corners)
    if (!can_draw({p.x, p.y})) return;
  for (const Pixel& p : corners) cairo_line_to(recording_->cairo.get(), p.x, p.y);
  cairo_close_path(recording_->cairo.get());
  recording_->fill(c, alpha);
}

void Canvas::fill(const Rectangle& r, const Ink& c, double alpha) {
  if (!can_draw({r.x, r.y, r.width, r.height})) return;
  cairo_rectangle(recording_->cairo.get(), r.x, r.y, r.width, r.height);
  recording_->fill(c, alpha);
}

void Canvas::frame(const Rectangle& r, double w, const Ink& c, double alpha) {
  if (!can_draw({r.x, r.y, r.width, r.height})) return;
  cairo_rectangle(recording_->cairo.get(), r.x + 0.5 * w, r.y + 0.5 * w, r.width - w, r.height - w);
  recording_->stroke(w, c, alpha);
}

void Canvas::raster(Pixel top_left, double texel, const Raster& texels) {
  if (!can_draw({top_left.x, top_left.y, texel})) return;
  const Surface surface = surface_of(texels);
  cairo_t* cairo = recording_->cairo.get();
  cairo_save(cairo);
  cairo_translate(cairo, top_left.x, top_left.y);
  cairo_scale(cairo, texel, texel);
  cairo_set_source_surface(cairo, surface.get(), 0, 0);
  cairo_pattern_set_filter(cairo_get_source(cairo), CAIRO_FILTER_NEAREST);
  cairo_rectangle(cairo, 0, 0, texels.width(), texels.height());
  cairo_fill(cairo);
  cairo_restore(cairo);
}

void check_fonts() {
  find_fonts();
  text_width("", 1);
}

double text_width(const std::string& words, double size) {
  return Line(words, size, false, 0).width();
}

void Canvas::text(Pixel base, const std::string& words, const Lettering& how) {
  if (!can_draw({base.x, base.y})) return;
  const Line line(words, how.size, how.bold, how.room);
  const double before =
      how.align == Align::left ? 0 : line.width() * (how.align == Align::middle ? 0.5 : 1);
  recording_->source(how.ink, 1);
  cairo_move_to(recording_->cairo.get(), base.x - before, base.y);
  line.show(recording_->cairo.get());
  cairo_new_path(recording_->cairo.get());
}

Raster Canvas::pixels() const {
  Raster result(width_, height_);
  const Surface image = surface_of(result);
  recording_->play(image.get());
  cairo_surface_flush(image.get());
  const unsigned char* row = cairo_image_surface_get_data(image.get());
  const int stride = cairo_image_surface_get_stride(image.get());
  for (int y = 0; y < height_; ++y, row += stride)
    for (int x = 0; x < width_; ++x)
      result.at(x, y) = ink(reinterpret_cast<const uint32_t*>(row)[x] & 0xffffff);
  return result;
}

std::string Canvas::png() const {
  const Raster drawn = pixels();
  std::vector<uint8_t> rgb;
  rgb.reserve(size_t{3} * static_cast<size_t>(width_) * static_cast<size_t>(height_));
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x)
      for (int c = 0; c < 3; ++c) rgb.push_back(byte_of(drawn.at(x, y)[c]));
  return png_of_rgb8(width_, height_, rgb, PngKind::drawing);
}

namespace {
cairo_status_t append(void* to, const unsigned char* data, unsigned int n) {
  static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), n);
  return CAIRO_STATUS_SUCCESS;
}
}  // namespace

std::string Canvas::svg() const {
  std::string bytes;
  const Surface surface(cairo_svg_surface_create_for_stream(append, &bytes, width_, height_));
  check(cairo_surface_status(surface.get()));
  cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
  recording_->play(surface.get());
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()));
  return bytes;
}

std::string Canvas::pdf() const {
  std::string bytes;
  const Surface surface(cairo_pdf_surface_create_for_stream(append, &bytes, width_, height_));
  check(cairo_surface_status(surface.get()));
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
  recording_->play(surface.get());
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()));
  return bytes;
}

std::string Canvas::file_named(const std::string& path) const {
  const std::string suffix = suffix_of(path);
  return suffix == ".svg" ? svg() : suffix == ".pdf" ? pdf() : png();
}

}  // namespace tdpt::draw
